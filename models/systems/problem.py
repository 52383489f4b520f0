"""A planning problem: a system, a gait, a start and a goal."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
import sympy as sp

import planner
from models.errors import message
from planner import Array, Execution, Plan, StratifiedSystem, StratumError, planning
from planner.execution import Coordinates, StanceRule
from planner.support import require_known
from planner.systems import ShapeCoordinates, ShapeLimits

OVERFLOWING = 1e100  # of a coordinate; derivatives at larger ones overflow
State = Mapping[str, float]  # values of coordinates by name
Words = Literal["printed", "shortest", "symmetric"]
COORDINATES: Mapping[Words, Coordinates] = {
    "printed": "fewest",
    "shortest": "shortest",
    "symmetric": "symmetric",
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Problem:
    """A system to steer from a start to a goal along a straight line.

    Attributes:
        name: What the system is called.
        description: One line on what it is.
        system: The system.
        gait: Strata in the order in which they are visited (eq. 11), from the bottom
            one; a smooth system stays on its only one.
        elements: Fields and brackets of the extended system, by name.
        start: Coordinates at the start; those not named are zero.
        goal: Coordinates at the goal; those not named are as at the start.
        segments: Number of pieces that the line is cut into.
        limits: Lowest and highest value of shape coordinates by name.
        stance: As in `planner.execution.execution.Execution`.
        degree: Degree of the nilpotent approximation; the elements' own if None.
        words: Flows of a segment: `printed`, those of the paper, `shortest` or
            `symmetric`.
        in_gait: Whether plans visit the strata in the order of the gait.
        flat: Flat outputs, where the system has a chained form to be steered in.
        hitches: Angles between trailers and what tows them, as functions of the state.

    Raises:
        ValueError: A coordinate or the stance is unknown, a value is not finite, a
            limit bounds no shape coordinate, or there is nothing to do.
        StratumError: The gait is not a closed walk from the bottom stratum.

    Example:
        >>> from models import Problem, shipped_system
        >>> unicycle = shipped_system("unicycle")
        >>> isinstance(unicycle, Problem), unicycle.segments > 0
        (True, True)
    """

    name: str
    description: str
    system: StratifiedSystem
    gait: tuple[str, ...]
    elements: tuple[str, ...]
    goal: State
    start: State = field(default_factory=dict)
    segments: int = 1
    limits: ShapeLimits = field(default_factory=dict)
    stance: StanceRule = "paper"
    degree: int | None = None
    words: Words = "printed"
    in_gait: bool = False
    flat: planning.FlatOutputs | None = None
    hitches: tuple[sp.Expr, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "gait", planner.Gait(self.system, self.gait).strata)
        if self.gait[0] != self.system.bottom:
            facts = {"first": self.gait[0], "bottom": self.system.bottom}
            raise StratumError(message("gait_start", name=self.name, **facts))
        planning.require_segments(self.segments, self.path)
        ShapeCoordinates(self.system).require_limits(self.limits)
        _ = self.states, self.execution  # refuse unknown coordinates and stances

    @cached_property
    def states(self) -> tuple[Array, Array]:
        """Configurations at the start and at the goal, shape (n,) each."""
        start = configuration(self.system, "start", self.start)
        return start, configuration(self.system, "goal", self.goal, start)

    @property
    def path(self) -> planner.Path:
        """The straight line from start to goal."""
        return planner.line(*self.states)

    @cached_property
    def extended(self) -> planner.ExtendedSystem:
        """The extended system, its elements chosen along the path where none are named.

        ValueError for unknown elements, PlannerError for those that do not serve.
        """
        found = planning.extend_along(self.system, self.elements or None, self.path)
        return found if self.degree is None else found.to_degree(self.degree)

    def plan(self, aimed: bool = False) -> Plan:
        """The plan from start to goal; if aimed, segments end where they should.

        ValueError where the problem asks for the impossible, PlannerError for no plan.
        """
        if aimed:
            return planner.aim(self.extended, self.path, self.segments, self.execution)
        bottom = self.system.bottom
        if any(planning.stratum_at(self.system, x) != bottom for x in self.states):
            asked = self.extended, *self.states, self.segments, self.open_loop
            return planning.plan_between(*asked)
        return planner.plan(
            self.extended, self.path, self.segments, execution=self.open_loop
        )

    def largest_fold(self, way: Array) -> float:
        """The largest angle at a hitch on a way (states, n) [rad]; 0 without any."""
        bends = sp.lambdify(self.system.state, self.hitches, np)(*way.T)
        return max((float(np.abs(bend).max()) for bend in bends), default=0.0)

    @property
    def open_loop(self) -> Execution:
        """How plans are carried out that need not know where each segment ends."""
        require_known(f"words {self.words!r}", self.words, COORDINATES)
        return Execution(
            stance=self.stance,
            limits=self.limits,
            coordinates=COORDINATES[self.words],
            gait=self.gait if self.in_gait else (),
        )

    @property
    def execution(self) -> Execution:
        """How plans are carried out, with Hall coordinates that shots can follow."""
        if self.words == "printed":
            return replace(self.open_loop, coordinates="backward")
        return self.open_loop


def configuration(
    system: StratifiedSystem, what: str, given: State, otherwise: Array | None = None
) -> Array:
    """A configuration from some of its coordinates, shape (n,).

    The others are those of `otherwise`, or zero; `what` names it in messages.
    """
    names = [str(symbol) for symbol in system.state]
    state = np.zeros(len(names)) if otherwise is None else otherwise.copy()
    for name, value in given.items():
        require_known(f"{what} has {name}, which", name, names)
        if not abs(value) < OVERFLOWING:
            remedy = f"give one below {OVERFLOWING}"
            raise ValueError(f"{what} has {name} = {value}; {remedy}")
        state[names.index(name)] = value
    return state
