"""The interface through which a system tells `plan` how it is best steered."""

from __future__ import annotations

from typing import Protocol

from planner.execution.execution import Execution
from planner.planning.paths import Path
from planner.systems.strata import StratifiedSystem


class Steerable(Protocol):
    """A system with its best way of steering, such as the equations of a robot."""

    @property
    def system(self) -> StratifiedSystem:
        """The stratified system."""
        ...

    @property
    def elements(self) -> tuple[str, ...]:
        """Elements of the extended system to steer with."""
        ...

    @property
    def execution(self) -> Execution:
        """How plans are carried out: order of flows, joint ranges, static stability."""
        ...

    def configurations(self, path: Path) -> Path:
        """The path as one of configurations, if it consists of poses of the body."""
        ...
