"""The plan that a scenario walks: stratified, or the shortest found along its path."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from planner import BoundError, BudgetError, Plan, PlannerError
from planner.optimisation import Optimiser
from planner.support import unlimited
from sim.optimisation.formulation import (
    Coarse,
    criterion_of,
    straying_of,
    task_of,
    tolerances,
)
from sim.optimisation.judging import Judge
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import Setup
from sim.progress import Progress, silent

NO_SHORTER = "no shorter plan was found"
SAME = 1.0 + 1e-9


@dataclass(frozen=True)
class Chosen:
    """The plan of a walk, and why it is not the optimised one that was asked for.

    Attributes:
        plan: What is walked.
        fallback: Why the stratified plan stands instead of an optimised one; None where
            nothing else was asked for.
    """

    plan: Plan
    fallback: str | None = None


@dataclass(frozen=True)
class PlannedWalk:
    """Plans of one walk, as short as its scenario asks for.

    The stratified plan is the first guess of an optimised one, and stands where nothing
    shorter is found.

    Attributes:
        setup: What to walk, its path divided for its bounds.
        progress: Told the stage and how much of it is done.
    """

    setup: Setup
    progress: Progress = silent

    def choose(self, aside: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Chosen:
        """One plan for the whole path, and whether it is the one that was asked for.

        Args:
            aside: Step from the goal to where the plan ends instead, x, y [m] and yaw.

        Raises:
            PlannerError: If there is none.
            BoundError: If no plan keeps the tolerances; it says which would be kept.
            BudgetError: If the time is over before there is one.
        """
        setup = self.setup.aimed(aside)
        if setup.scenario.optimise == "none":
            return Chosen(plan_open_loop(setup))
        if self._stratified is None or not self._stratified_keeps:
            return Chosen(self._shortest(setup))
        with unlimited():
            other = plan_open_loop(setup) if any(aside) else self._stratified
        try:
            found = self._shortest(setup)
        except (BoundError, BudgetError) as error:
            return Chosen(other, str(error))
        worth = Judge(setup).worth
        if worth(found) < worth(other):
            return Chosen(found)
        return Chosen(other, NO_SHORTER)

    def plan(self, aside: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Plan:
        """The plan that `choose` chooses."""
        return self.choose(aside).plan

    @cached_property
    def _stratified(self) -> Plan | None:
        try:
            return plan_open_loop(self.setup)
        except PlannerError:
            return None

    @cached_property
    def _within(self) -> tuple[float, float]:
        return tolerances(self.setup, self._stratified)

    @cached_property
    def _stratified_keeps(self) -> bool:
        """Whether the stratified plan's own motion stays within the tolerances."""
        if self._stratified is None:
            return False
        found, within = straying_of(self.setup, self._stratified), self._within
        return (
            found["position"] <= within[0] * SAME and found["yaw"] <= within[1] * SAME
        )

    def _shortest(self, setup: Setup) -> Plan:
        """The best plan found that is sound."""
        found = self._optimiser.plan(setup.nominal()(1.0))
        Judge(setup).require_sound(found)
        return found

    @cached_property
    def _optimiser(self) -> Optimiser:
        setup = self.setup
        path = setup.equations.configurations(setup.scenario.path.undivided)
        return Optimiser(
            task_of(setup, self._within),
            criterion_of(setup),
            setup.extended,
            path,
            setup.scenario.segments,
            coarse=Coarse(setup, path),
            report=lambda done: self.progress("optimising", done),
        )
