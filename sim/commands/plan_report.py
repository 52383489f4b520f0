"""What `stratawalk plan` reports: facts under the names of JSON, and lines of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from planner import Array, Plan
    from sim.problems.problem import Problem
    from sim.problems.scenario import ScenarioProblem

GAIT = (
    "A stratum is the set of configurations in which the same groups of",
    "legs stand on the ground; it is named after these groups. A gait is",
    "the closed sequence of strata that the robot visits again and again.",
)
STROKE = "a stroke is a swing of legs that stand on the ground and move the body"


@dataclass(frozen=True)
class Accuracy:
    """How fast plans converge; orders are None where plans are exact."""

    degree: int
    bracket_degree: int
    order: float | None
    faster: Mapping[str, float | None]

    @classmethod
    def of(cls, problem: Problem) -> Accuracy:
        """The order to expect, and that of what is faster."""
        from planner import convergence_order
        from planner.planning import faster

        if problem.is_exact:
            degree = problem.extended.steering.degree
            return cls(degree, degree, None, {})
        asked = problem.extended, problem.path, problem.coordinates
        expected, offers = convergence_order(*asked), faster(*asked)
        orders = {what: _finite(offer.order) for what, offer in offers.items()}
        degrees = expected.degree, expected.bracket_degree
        return cls(*degrees, _finite(expected.order), orders)

    def lines(self) -> Iterator[str]:
        """The order to expect and what raises it."""
        degree = f"degree {self.degree}"
        if self.order is None:
            yield f"{'accuracy':10}exact at {degree}: no brackets are left out"
            return
        yield (
            f"{'accuracy':10}with n segments the error falls as n^-{self.order:.3g} "
            f"({degree}, brackets of degree {self.bracket_degree})"
        )
        if self.faster:
            offers = (f"{_power(o)} with {what}" for what, o in self.faster.items())
            more = "more elements than needed make it smaller"
            yield f"{'faster':10}it falls as {', as '.join(offers)}; {more}"


@dataclass(frozen=True)
class Steps:
    """The first step of a path and the critical one; None if twice the first serves."""

    first: float
    critical: float | None

    @classmethod
    def of(cls, problem: Problem) -> Steps | None:
        """Steps of a problem; None where it has no way, or is met in any step."""
        from planner import critical_step
        from planner.planning import grid

        start, end = problem.path.at(grid(problem.path, problem.segments)[:2])
        length = float(problem.extended.system.length(end - start))
        if problem.is_exact or not length:
            return None
        critical = critical_step(
            problem.extended, start, end - start, within=2 * length
        )
        return cls(length, _finite(critical))

    def line(self, segments: int, exact: bool) -> str:
        """The number of segments beside the one that the critical step asks for."""
        first, critical = self.first, self.critical
        head = f"{'steps':10}{first:.3g} long"
        if exact and critical is None:
            return f"{head}; a plan halves the distance at least, however long they are"
        if critical == 0:
            return f"{head}; planning again converges for no length in this direction"
        if critical is None:
            return f"{head}; planning again converges, also for steps twice as long"
        upto = f"planning again converges up to {critical:.3g}, the critical step"
        if first <= critical:
            return f"{head}; {upto}"
        needed = math.ceil(segments * first / critical)
        return f"{head}, too long; {upto}, or {needed} segments"


def _finite(value: float) -> float | None:
    return None if math.isinf(value) else value


def _power(order: float | None) -> str:
    return "0 at once" if order is None else f"n^-{order:.3g}"


@dataclass(frozen=True)
class Prospect:
    """What the planner says beyond a plan itself; None where that takes too long."""

    helps: str
    fallback: str | None
    timing: Mapping[str, float]
    accuracy: Accuracy | None = None
    steps: Steps | None = None

    def lines(self, segments: int, loaded: str) -> Iterator[str]:
        """Lines below those of the plan itself."""
        if self.accuracy:
            yield from self.accuracy.lines()
            if self.steps:
                yield self.steps.line(segments, self.accuracy.order is None)
        yield (
            f"{'took':10}{1e3 * self.timing['plan']:.1f} ms to plan, after "
            f"{1e3 * self.timing['compile']:.0f} ms to {loaded}"
        )

    def remarks(self) -> dict[str, str]:
        """Why there is no optimised plan, and what would help, by their labels."""
        fell_back = self.fallback and f"on the stratified plan: {self.fallback}"
        texts = {"fell back": fell_back, "helps": self.helps}
        return {name: f"{name:10}{text}" for name, text in texts.items() if text}


@dataclass(frozen=True)
class WalkFacts:
    """Results of a robot's plan, under the names of summary.json."""

    scenario: str
    robot: str
    fields: str
    stance: str
    segments: int
    replan: bool
    goal: tuple[float, float, float]
    path_length: float
    pose: tuple[float, float, float]
    error: Mapping[str, float]
    contact_switches: int
    largest_swing: float
    swing_travel: float
    air_travel: float
    distance_walked: float
    time: float  # [s], without holds
    least_time: float | None
    gait: tuple[str, ...]
    ignores: str  # settings that no plan on the exact kinematics knows of

    @classmethod
    def of(cls, problem: ScenarioProblem, planned: Plan) -> WalkFacts:
        """Play the plan of a scenario."""
        from planner import play
        from sim.motion.poses import wrap
        from sim.optimisation.judging import Judge
        from sim.scenarios.predictions import IDEAL

        setup, scenario = problem.setup, problem.setup.scenario
        robot, equations = setup.robot, setup.equations
        states = play(planned.system, planned.flows, planned.start)
        (x, y, yaw), goal = states[-1, :3].tolist(), scenario.path.goal
        travel = {True: 0.0, False: 0.0}  # of loaded and of lifted groups
        for flow in planned.flows:
            swings = equations.swings[flow.field]
            for group, share in zip(robot.groups, swings, strict=True):
                travel[group in flow.stratum] += abs(share * flow.duration)
        walked = (equations.stride(f.field) * abs(f.duration) for f in planned.flows)
        return cls(
            scenario=scenario.name,
            robot=robot.name,
            fields=scenario.fields,
            stance=setup.stance,
            segments=scenario.segments,
            replan=scenario.replan,
            goal=goal,
            path_length=scenario.path.length,
            pose=(x, y, float(wrap(yaw))),
            error={
                "position": math.dist((x, y), goal[:2]),
                "yaw": abs(float(wrap(yaw - goal[2]))),
            },
            contact_switches=planned.contact_switches,
            largest_swing=float(abs(states[:, 3 : 3 + len(robot.groups)]).max()),
            swing_travel=travel[True],
            air_travel=travel[False],
            distance_walked=sum(walked, 0.0),
            time=Judge(setup).duration(planned.flows),
            least_time=problem.least_time,
            gait=tuple(scenario.gait or robot.card.gait),
            ignores=IDEAL.ignored(scenario),
        )

    def table(self, prospect: Prospect) -> dict[str, object]:
        """The facts for JSON."""
        return {k: v for k, v in vars(self).items() if k != "gait"} | asdict(prospect)

    def lines(self, prospect: Prospect) -> Iterator[str]:
        """The facts, with the paper's words explained."""
        x, y, yaw = self.pose
        remarks = prospect.remarks()
        yield (
            f"{self.scenario}: {self.robot}, {self.segments} segments, "
            f"{self.contact_switches} lift-offs and touchdowns"
        )
        yield from filter(None, [remarks.get("fell back")])
        yield f"{'gait':10}{' '.join(self.gait)}"
        yield from (f"{'':10}{line}" for line in GAIT)
        yield f"{'strokes':10}{self.swing_travel:.3f} rad in all; {STROKE}"
        yield (
            f"{'walks':10}{self.distance_walked:.3f} m for a path of "
            f"{self.path_length:.3f} m, legs swing to {self.largest_swing:.3f} rad"
        )
        if self.least_time is not None:
            least = (
                f"no plan that keeps as near takes less than {self.least_time:.2f} s"
            )
            yield f"{'walks for':10}{self.time:.2f} s; {least}"
        yield f"{'ends at':10}x {x:z.4f} m, y {y:z.4f} m, yaw {yaw:z.4f} rad"
        off, turned = self.error["position"], self.error["yaw"]
        yield f"{'off goal':10}{1e3 * off:.2f} mm, {turned:.4f} rad"
        ignored = self.ignores and f"{'ignored':10}{self.ignores}"
        yield from filter(None, [ignored, remarks.get("helps")])
        yield from prospect.lines(self.segments, "load and compile")


@dataclass(frozen=True)
class SystemFacts:
    """Results of a system's plan; coordinates by name."""

    system: str
    segments: int
    elements: tuple[str, ...]
    start: Mapping[str, float]
    goal: Mapping[str, float]
    end: Mapping[str, float]
    distance: float
    error: float
    flow_count: int
    flow_time: float
    contact_switches: int

    @classmethod
    def of(cls, name: str, planned: Plan) -> SystemFacts:
        """Play the plan of a system."""
        from planner import rollout

        end, names = rollout(planned)[-1], list(map(str, planned.system.state))

        def named(state: Array) -> dict[str, float]:
            return dict(zip(names, state.tolist(), strict=True))

        return cls(
            system=name,
            segments=len(planned.segment_ends),
            elements=planned.elements,
            start=named(planned.start),
            goal=named(planned.goal),
            end=named(end),
            distance=float(planned.system.length(planned.goal - planned.start)),
            error=float(planned.system.length(planned.goal - end)),
            flow_count=len(planned.flows),
            flow_time=sum(abs(flow.duration) for flow in planned.flows),
            contact_switches=planned.contact_switches,
        )

    def table(self, prospect: Prospect | None) -> dict[str, object]:
        """The facts for JSON; systems are seldom optimised."""
        table = vars(self) | (asdict(prospect) if prospect else {})
        if not table.get("fallback"):
            table.pop("fallback", None)
        return table

    def lines(self, prospect: Prospect | None) -> Iterator[str]:
        """The facts, with every coordinate at the end."""
        ends = ", ".join(f"{name} {value:z.4f}" for name, value in self.end.items())
        share = self.error / self.distance if self.distance else 0.0
        yield (
            f"{self.system}: {self.segments} segments, {self.flow_count} flows for a "
            f"time of {self.flow_time:.4g} in all, {self.contact_switches} contact "
            "switches"
        )
        yield f"{'steers by':10}{', '.join(self.elements)}"
        yield f"{'ends at':10}{ends}"
        yield f"{'off goal':10}{self.error:.3g}, {100 * share:.3g} % of the way"
        if prospect:
            yield from prospect.remarks().values()
            yield from prospect.lines(self.segments, "compile")
