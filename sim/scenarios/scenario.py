"""A scenario: which robot walks which nominal path, with which settings.

The settings are declared in `scenarios.settings`. Reading and writing files is done by
`scenarios.file`, running a scenario by `sim.simulate`.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Self

from sim.scenarios.body_path import NominalPath
from sim.scenarios.declaration import Effect, Setting
from sim.scenarios.obstacles import Obstacle
from sim.scenarios.predictions import prediction_key
from sim.scenarios.settings import IMPERFECTIONS, SETTINGS, Settings


@dataclass(frozen=True, kw_only=True)
class Scenario(Settings):
    """Everything that determines a run, immutable.

    Raises:
        UsageError: If a value is outside its limits, naming key, value and limits.

    Example:
        >>> from sim import Scenario, load_scenario
        >>> path = load_scenario("line").path
        >>> scenario = Scenario(name="mine", path=path, segments=20)
        >>> scenario.robot, scenario.swing_speed
        ('hexapod', 0.5)
    """

    obstacles: tuple[Obstacle, ...] = field(
        default=(), metadata={"affects": frozenset({"plan", "world"})}
    )
    path: NominalPath = field(metadata={"affects": frozenset({"plan"})})

    @property
    def steered_on(self) -> str:
        """Key of the prediction that is to reach the goal."""
        return prediction_key(self.steer)

    @property
    def is_imperfect(self) -> bool:
        """Whether it has any imperfection that no prediction knows of."""
        return any(getattr(self, n) != SETTINGS[n].default for n in IMPERFECTIONS)

    @property
    def as_planned(self) -> Self:
        """The same without imperfections: the robot and its floor as they should be."""
        none: dict[str, Any] = {n: SETTINGS[n].default for n in IMPERFECTIONS}
        return replace(self, **none)

    @staticmethod
    def declarations() -> Mapping[str, Setting]:
        """What is declared about every setting, by its name."""
        return SETTINGS

    def key(self, *effects: Effect) -> Hashable:
        """All in it that has some effects; `world`, say, for what changes the physics.

        Scenarios that share it have equal keys.
        """
        own = (
            item.name for item in fields(self) if item.metadata["affects"] & {*effects}
        )
        return tuple((name, repr(getattr(self, name))) for name in own)
