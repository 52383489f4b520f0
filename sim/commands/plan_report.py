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

Report = tuple[dict[str, object], list[str]]
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
            f"{'accuracy':10}with n segments the error falls as n^-{self.order:.3g}: "
            f"words exact to {degree}, brackets to degree {self.bracket_degree} needed"
        )
        if self.faster:
            offers = (f"{_power(o)} with {what}" for what, o in self.faster.items())
            more = "further brackets among --elements make the error smaller"
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
            return f"{head}; any step, however long, leaves at most half of its way"
        if critical == 0:
            return f"{head}; planning again converges for no length in this direction"
        upto = "planning again from where a plan ended converges to the goal"
        if critical is None:
            return f"{head}; {upto}, also for steps twice as long"
        upto += f" for steps up to {critical:.3g} (the critical step)"
        if first <= critical:
            return f"{head}; {upto}"
        needed = math.ceil(segments * first / critical)
        return f"{head}, too long; {upto}: take {needed} segments"


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


def of_walk(problem: ScenarioProblem, planned: Plan, prospect: Prospect) -> Report:
    """A scenario's plan, played: facts as in summary.json, with words explained."""
    from planner import play
    from sim.motion.poses import wrap
    from sim.optimisation.judging import Judge
    from sim.scenarios.predictions import IDEAL

    setup, scenario = problem.setup, problem.setup.scenario
    robot, equations, count = setup.robot, setup.equations, scenario.segments
    states = play(planned.system, planned.flows, planned.start)
    (x, y, heading), goal = states[-1, :3].tolist(), scenario.path.goal
    yaw, turned = (float(wrap(angle)) for angle in (heading, heading - goal[2]))
    off = math.dist((x, y), goal[:2])
    travel = {True: 0.0, False: 0.0}  # of loaded and of lifted groups
    for flow in planned.flows:
        swings = equations.swings[flow.field]
        for group, share in zip(robot.groups, swings, strict=True):
            travel[group in flow.stratum] += abs(share * flow.duration)
    walked = (equations.stride(f.field) * abs(f.duration) for f in planned.flows)
    far, length = sum(walked, 0.0), scenario.path.length
    largest = float(abs(states[:, 3 : 3 + len(robot.groups)]).max())
    time, least = Judge(setup).duration(planned.flows), problem.least_time
    ignored, remarks = IDEAL.ignored(scenario), prospect.remarks()
    facts = {
        "scenario": scenario.name,
        "robot": robot.name,
        "fields": scenario.fields,
        "stance": setup.stance,
        "segments": count,
        "replan": scenario.replan,
        "goal": goal,
        "path_length": length,
        "pose": (x, y, yaw),
        "error": {"position": off, "yaw": abs(turned)},
        "contact_switches": planned.contact_switches,
        "largest_swing": largest,
        "swing_travel": travel[True],
        "air_travel": travel[False],
        "distance_walked": far,
        "time": time,  # [s], without holds
        "least_time": least,
        "ignores": ignored,  # settings that no plan on the exact kinematics knows of
    }
    switches = f"{planned.contact_switches} lift-offs and touchdowns"
    lines = [f"{scenario.name}: {robot.name}, {count} segments, {switches}"]
    lines += filter(None, [remarks.get("fell back")])
    lines.append(f"{'gait':10}{' '.join(scenario.gait or robot.card.gait)}")
    lines += (f"{'':10}{line}" for line in GAIT)
    lines.append(f"{'strokes':10}{travel[True]:.3f} rad in all; {STROKE}")
    legs = f"legs swing by up to {largest:.3f} rad"
    lines.append(f"{'walks':10}{far:.3f} m for a path of {length:.3f} m, {legs}")
    if least is not None:
        bound = f"no plan that keeps as near takes less than {least:.2f} s"
        lines.append(f"{'walks for':10}{time:.2f} s; {bound}")
    lines.append(f"{'ends at':10}x {x:z.4f} m, y {y:z.4f} m, yaw {yaw:z.4f} rad")
    lines.append(f"{'off goal':10}{1e3 * off:.2f} mm, {abs(turned):.4f} rad")
    lines += [f"{'ignored':10}{ignored}"] if ignored else []
    lines += filter(None, [remarks.get("helps")])
    lines += prospect.lines(count, "load and compile")
    return facts | asdict(prospect), lines


def of_system(name: str, planned: Plan, prospect: Prospect | None = None) -> Report:
    """A system's plan, played; coordinates by name."""
    from planner import rollout

    system, reached = planned.system, rollout(planned)[-1]
    count, switches = len(planned.segment_ends), planned.contact_switches
    way = float(system.length(planned.goal - planned.start))
    error = float(system.length(planned.goal - reached))
    time = sum(abs(flow.duration) for flow in planned.flows)

    def named(state: Array) -> dict[str, float]:
        return dict(zip(map(str, system.state), state.tolist(), strict=True))

    facts: dict[str, object] = {
        "system": name,
        "segments": count,
        "elements": planned.elements,
        "start": named(planned.start),
        "goal": named(planned.goal),
        "end": named(reached),
        "distance": way,
        "error": error,
        "flow_count": len(planned.flows),
        "flow_time": time,
        "contact_switches": switches,
    }
    ends = ", ".join(f"{name} {value:z.4f}" for name, value in named(reached).items())
    share = 100 * error / way if way else 0.0
    lines = [
        f"{name}: {count} segment{'s' * (count > 1)}, {len(planned.flows)} flows that "
        f"take a time of {time:.4g}, {switches} contact switches",
        f"{'steers by':10}{', '.join(planned.elements)}",
        f"{'ends at':10}{ends}",
        f"{'off goal':10}{error:.3g}, {share:.3g} % of the way",
    ]
    if prospect is None:
        return facts, lines
    more = {k: v for k, v in asdict(prospect).items() if k != "fallback" or v}
    return facts | more, [
        *lines,
        *prospect.remarks().values(),
        *prospect.lines(count, "compile"),
    ]
