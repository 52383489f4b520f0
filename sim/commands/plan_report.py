"""What `stratawalk plan` reports: facts under the names of JSON, and a text of them."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import TYPE_CHECKING

from planner import Array, Plan, convergence_order, critical_step, play, rollout
from planner.planning import faster, grid
from planner.systems import merged
from sim.motion.poses import wrap
from sim.problems.problem import Problem, tried
from sim.scenarios.predictions import IDEAL
from sim.templates import render

if TYPE_CHECKING:
    from sim.problems.scenario import ScenarioProblem

Report = tuple[dict[str, object], str]
SAMPLES = 20  # states of each flow, in pictures as well
LEFT_OUT = ("fallback", "chained", "largest_fold")  # of a system's facts, where empty


@dataclass(frozen=True)
class Accuracy:
    """How fast plans converge; orders are None where plans are exact."""

    degree: int
    bracket_degree: int
    order: float | None
    faster: Mapping[str, float | None]

    @classmethod
    def of(cls, problem: Problem, plan: Plan) -> "Accuracy":
        """The order to expect, and that of what is faster and helps a plan already.

        In few segments a plan that converges faster may well miss more.
        """
        if problem.is_exact:
            degree = problem.extended.steering.degree
            return cls(degree, degree, None, {})
        asked, words = (problem.extended, problem.path), problem.coordinates
        expected = convergence_order(*asked, words)
        offers = faster(*asked, expected, words)

        def attempt(what: str) -> float:
            mirrored = offers[what].degree == expected.degree
            options = {"words": "symmetric"} if mirrored else {}
            return problem.changed(offers[what].degree, **options).attempt()

        trials = ((what, partial(attempt, what)) for what in offers)
        helpful = tried(trials, problem.miss(plan), problem.plan_time).helpful
        orders = {what: _finite(offers[what].order) for what in helpful}
        degrees = expected.degree, expected.bracket_degree
        return cls(*degrees, _finite(expected.order), orders)


@dataclass(frozen=True)
class Steps:
    """The first step of a path and the critical one; None if twice the first serves."""

    first: float
    critical: float | None

    @classmethod
    def of(cls, problem: Problem) -> "Steps | None":
        """Steps of a problem; None where it has no way, or is met in any step."""
        start, end = problem.path.at(grid(problem.path, problem.segments)[:2])
        length = float(problem.extended.system.length(end - start))
        if problem.is_exact or not length:
            return None
        asked = problem.extended, start, end - start
        return cls(length, _finite(critical_step(*asked, within=2 * length)))


def _finite(value: float) -> float | None:
    return None if math.isinf(value) else value


@dataclass(frozen=True)
class Prospect:
    """What the planner says beyond a plan itself; None where that takes too long."""

    helps: str
    fallback: str | None  # why there is no optimised plan
    timing: Mapping[str, float]
    accuracy: Accuracy | None = None
    steps: Steps | None = None
    chained: bool = False  # whether it is steered in chained form, which is exact


def of_walk(problem: "ScenarioProblem", planned: Plan, prospect: Prospect) -> Report:
    """A scenario's plan, played: facts as in summary.json, with words explained."""
    from sim.evaluation.phases import swing_travel  # these load MuJoCo
    from sim.optimisation.judging import Judge
    from sim.walking.finished import way_of

    setup, scenario = problem.setup, problem.setup.scenario
    robot, goal = setup.robot, scenario.path.goal
    states = play(planned.system, merged(planned.flows), planned.start)
    x, y, heading = states[-1, :3].tolist()
    schedule = Judge(setup).schedule([*planned.segments()])
    swings = [phase for phase in schedule.phases if phase.kind == "swing"]
    facts = {
        "scenario": scenario.name,
        "robot": robot.name,
        "fields": scenario.fields,
        "stance": setup.stance,
        "segments": scenario.segments,
        "replan": scenario.replan,
        "goal": goal,
        "path_length": scenario.path.length,
        "pose": (x, y, float(wrap(heading))),
        "error": {
            "position": math.dist((x, y), goal[:2]),
            "yaw": abs(float(wrap(heading - goal[2]))),
        },
        "contact_switches": planned.contact_switches,
        "largest_swing": float(abs(states[:, 3 : 3 + len(robot.groups)]).max()),
        "swing_travel": swing_travel(swings, robot.groups, loaded=True),
        "air_travel": swing_travel(swings, robot.groups, loaded=False),
        "distance_walked": way_of(setup, swings),
        "time": schedule.stop * setup.limits.timestep,  # [s], without holds
        "least_time": problem.least_time,
        "ignores": IDEAL.ignored(scenario),
        **asdict(prospect),
    }
    gait = scenario.gait or robot.card.gait
    return facts, render("walk_plan.txt", gait=gait, **facts)


def of_system(
    name: str,
    planned: Plan,
    prospect: Prospect | None = None,
    folded: Callable[[Array], float] | None = None,
) -> Report:
    """A system's plan, played; coordinates by name."""
    system, reached = planned.system, rollout(planned)[-1]

    def named(state: Array) -> dict[str, float]:
        return dict(zip(map(str, system.state), state.tolist(), strict=True))

    way = rollout(planned, SAMPLES)
    largest = named(abs(way).max(axis=0))
    fold = {"largest": largest, "largest_fold": folded and folded(way)}
    further = fold | (asdict(prospect) if prospect else {})
    facts = {
        "system": name,
        "segments": len(planned.segment_ends),
        "elements": planned.elements,
        "start": named(planned.start),
        "goal": named(planned.goal),
        "end": named(reached),
        "distance": float(system.length(planned.goal - planned.start)),
        "error": float(system.length(planned.goal - reached)),
        "flow_count": len(planned.flows),
        "flow_time": sum(abs(flow.duration) for flow in planned.flows),
        "contact_switches": planned.contact_switches,
        **{k: v for k, v in further.items() if v or k not in LEFT_OUT},
    }
    return facts, render("system_plan.txt", **facts)
