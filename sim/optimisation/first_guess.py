"""What the shortest plans of robots and of systems without a body begin with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from planner import Execution, ExtendedSystem, Flow, Path, plan

CHEAP = 0.01  # cost of a recovery where strokes alone are to be short
FLOW_SAMPLES = 8  # of a flow of the stratified plan


@dataclass(frozen=True)
class Coarse:
    """Stratified plans of pieces of a path, in few segments."""

    extended: ExtendedSystem
    path: Path
    execution: Execution

    def __call__(self, begin: float, end: float, segments: int) -> Sequence[Flow]:
        """Flows from one place on the path to another."""
        piece = Path(lambda s: self.path.at(begin + (end - begin) * s))
        return plan(self.extended, piece, segments, execution=self.execution).flows
