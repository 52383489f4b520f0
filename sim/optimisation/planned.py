"""The plan that a scenario walks: stratified, or the shortest found along its path."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from planner import (
    BoundError,
    BudgetError,
    Optimiser,
    Plan,
    PlannerError,
    unlimited,
)
from sim.optimisation.judging import Judge, least_clearance
from sim.optimisation.wishes import Coarse, Least, straying_of, tolerances, wish_of
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import Setup
from sim.progress import Progress, silent

NO_SHORTER = "no shorter plan was found"
ROUNDS = 3  # of asking for what the margin still lacks
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
        setup = self.setup.beside(aside)
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
        """The best plan found that keeps the scenario's least margin and clearance.

        The program looks at the ends of stages alone; what the motion in between lacks
        is asked for in addition.
        """
        judge = Judge(setup)
        wanted = asked = Least(setup.scenario.min_margin, least_clearance(setup))
        for _ in range(ROUNDS):
            found = self._optimiser(asked).plan(setup.nominal()(1.0))
            lacking = judge.margin_lack(found), judge.clearance_lack(found)
            if max(lacking) <= 0.0:
                judge.require_sound(found)
                return found
            asked = Least(
                _more(asked.margin, lacking[0]), _more(asked.clearance, lacking[1])
            )
        raise BoundError(
            f"no plan found keeps {_said(wanted)} between the ends of its strokes; "
            "ask for less"
        )

    def _optimiser(self, least: Least) -> Optimiser:
        if least not in self._optimisers:
            setup = self.setup
            path = setup.equations.configurations(setup.scenario.path.curve)
            self._optimisers[least] = Optimiser(
                wish_of(setup, self._within, least),
                setup.extended,
                path,
                setup.scenario.segments,
                coarse=Coarse(setup, path),
                report=lambda done: self.progress("optimising", done),
            )
        return self._optimisers[least]

    @cached_property
    def _optimisers(self) -> dict[Least, Optimiser]:
        return {}


def _more(asked: float | None, lacking: float) -> float | None:
    return None if asked is None else asked + lacking


def _said(least: Least) -> str:
    parts = {"min_margin": least.margin, "min_clearance": least.clearance}
    given = [
        f"{name} of {value} m" for name, value in parts.items() if value is not None
    ]
    return "a " + " and a ".join(given)
