"""`stratawalk plan`: the plan on the exact kinematics, without physics."""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sim.commands import system_plan
from sim.commands.convergence import (
    convergence,
    describe as convergence_lines,
    step_lengths,
)
from sim.commands.options import add_scenario_arguments, scenario_of
from sim.commands.trusted import robot_of

if TYPE_CHECKING:
    from planner import Flow, StratifiedSystem
    from sim.preparation.setup import Setup
    from sim.progress import Progress

GAIT = (
    "A stratum is the set of configurations in which the same groups of",
    "legs stand on the ground; it is named after these groups. A gait is",
    "the closed sequence of strata that the robot visits again and again.",
)
STROKE = ("A stroke is a swing of legs that stand on the ground and move the body.",)
HELP = "plan a scenario or a system and play it on the exact kinematics"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    add_scenario_arguments(parser, "SCENARIO|SYSTEM")
    system_plan.add_arguments(parser)
    parser.add_argument("--flows", action="store_true", help="print every flow as well")


def execute(options: argparse.Namespace) -> None:
    """Plan the scenario or the system and print the result."""
    if system_plan.is_for_systems(options):
        system_plan.execute(options)
        return
    scenario = scenario_of(options)

    # slow imports; a scenario that is refused does not wait for them
    from sim.planning.bounds import within_bounds
    from sim.planning.routes import routed
    from sim.preparation.effort import check_distance
    from sim.preparation.reach import explained, require_reach
    from sim.preparation.setup import prepare
    from sim.progress import at_most, bar, stage

    began = time.perf_counter()
    robot = robot_of(options, scenario.robot)
    with bar(quiet=options.json) as progress, stage(progress, "compiling"):
        setup = prepare(scenario, robot)
    compiled = time.perf_counter()
    with (
        bar(quiet=options.json) as progress,
        explained(setup.robot, setup.equations),
    ):
        with at_most(progress, "planning", scenario.plan_time):
            check_distance(setup)
            require_reach(setup.robot, setup.equations, setup.nominal())
            setup = within_bounds(routed(setup))
        system, flows, fallback = _planned(setup, progress)
        planning = time.perf_counter() - compiled
        with stage(progress, "measuring the accuracy"):
            outlook = _outlook(setup)
        facts = summarise(setup, system, flows) | outlook
        with stage(progress, "trying what would help"):
            facts["helps"] = _helps(setup, facts)
    facts["fallback"] = fallback
    facts["timing"] = {"compile": compiled - began, "plan": planning}
    if options.json:
        print(json.dumps(facts | ({"flows": flows} if options.flows else {})))
        return
    if options.flows:
        print(*flows, "", sep="\n")
    print(_describe(facts, scenario.gait or setup.robot.card.gait))


def _planned(
    setup: Setup, progress: Progress
) -> tuple[StratifiedSystem, Sequence[Flow], str | None]:
    """System and flows of the scenario's plan, and why it is not the shortest."""
    from planner import PlannerError, RangeError
    from sim.optimisation.planned import PlannedWalk
    from sim.planning.remedies import tried
    from sim.planning.replanned import replanned
    from sim.planning.soundness import require_sound
    from sim.planning.walk_remedies import offers
    from sim.progress import at_most

    seconds = setup.scenario.plan_time
    try:
        with at_most(progress, "planning", seconds):
            if setup.scenario.replan:
                return setup.equations.system, replanned(setup), None
            chosen = PlannedWalk(setup, progress).choose()
            require_sound(setup, chosen.plan)
            return chosen.plan.system, chosen.plan.flows, chosen.fallback
    except RangeError as error:
        if error.segments is not None:
            raise
        helps = tried(offers(setup), math.inf, seconds)
        raise PlannerError(f"{error}; tried: {helps}") from error


def _outlook(setup: Setup) -> dict[str, Any]:
    """What finer plans would bring; nothing where that takes too long to find out."""
    from planner import BudgetError
    from planner.support import limited

    extended, path = setup.extended, setup.nominal()
    try:
        with limited(setup.scenario.plan_time):
            accuracy = convergence(extended, path, setup.coordinates)
            steps = step_lengths(extended, path, setup.scenario.segments)
    except BudgetError:
        return {}
    return {"accuracy": accuracy, "steps": steps}


def _helps(setup: Setup, facts: Mapping[str, Any]) -> str:
    """What would help a plan that ends far off its goal; empty for others."""
    import numpy as np

    from models import mobility_of
    from sim.planning.remedies import FAR, tried
    from sim.planning.walk_remedies import miss_of, offers
    from sim.preparation.reach import immobile

    scenario, robot = setup.scenario, setup.robot
    miss = miss_of(setup, np.array(facts["pose"]), np.array(scenario.path.goal))
    if miss <= FAR:
        return ""
    lacking = "; ".join(immobile(robot, mobility_of(robot, setup.equations)))
    return lacking or str(tried(offers(setup), miss, scenario.plan_time))


def summarise(
    setup: Setup, system: StratifiedSystem, flows: Sequence[Flow]
) -> dict[str, Any]:
    """Results of flows on the exact kinematics, under the names of summary.json.

    Args:
        setup: What is to be walked.
        system: Fields that the flows follow.
        flows: The plan.
    """
    from planner import play
    from sim.motion.poses import wrap

    scenario = setup.scenario
    states = play(system, flows, setup.nominal()(0.0))
    pose, goal = states[-1, :3], scenario.path.goal
    return {
        "scenario": scenario.name,
        "robot": setup.robot.name,
        "fields": scenario.fields,
        "stance": setup.stance,
        "segments": scenario.segments,
        "replan": scenario.replan,
        "goal": goal,
        "path_length": scenario.path.length,
        "pose": [*pose[:2].tolist(), float(wrap(pose[2]))],
        "error": {
            "position": math.dist(pose[:2], goal[:2]),
            "yaw": abs(float(wrap(pose[2] - goal[2]))),
        },
        "contact_switches": _switches(setup, system, flows),
        "largest_swing": float(abs(states[:, 3 : 3 + len(setup.robot.groups)]).max()),
        **_travel(setup, flows),
    }


def _switches(setup: Setup, system: StratifiedSystem, flows: Sequence[Flow]) -> int:
    """Lift-offs and touchdowns, also on strata that a gait visits without a flow."""
    from planner import contact_switches
    from planner.systems import gait_walk, walk_switches

    gait = setup.scenario.gait
    if not gait:
        return contact_switches(system, flows)
    ends = system.bottom, system.bottom
    return walk_switches(system, gait_walk(system, flows, gait, ends))


def _travel(setup: Setup, flows: Sequence[Flow]) -> dict[str, float]:
    """Swing travel of loaded and of lifted groups, and distance walked."""
    groups, equations = setup.robot.groups, setup.equations
    travel = {"swing_travel": 0.0, "air_travel": 0.0, "distance_walked": 0.0}
    for flow in flows:
        for group, share in zip(groups, equations.swings[flow.field], strict=True):
            loaded = group in flow.stratum
            way = abs(share * flow.duration)
            travel["swing_travel" if loaded else "air_travel"] += way
        travel["distance_walked"] += equations.stride(flow.field) * abs(flow.duration)
    return travel


def _describe(facts: Mapping[str, Any], gait: Sequence[str]) -> str:
    """The facts in lines for a terminal, with the paper's words explained."""
    x, y, yaw = facts["pose"]
    error, timing = facts["error"], facts["timing"]
    why = facts["fallback"]
    fell_back = [f"{'fell back':10}on the stratified plan: {why}"] if why else []
    return "\n".join(
        [
            f"{facts['scenario']}: {facts['robot']}, {facts['fields']} fields, "
            f"{facts['stance']} stance, {facts['segments']} segments, "
            f"{facts['contact_switches']} contact switches",
            *fell_back,
            f"{'gait':10}{' '.join(gait)}",
            *(f"{'':10}{line}" for line in GAIT),
            f"{'strokes':10}{facts['swing_travel']:.3f} rad in all",
            *(f"{'':10}{line}" for line in STROKE),
            f"{'walks':10}{facts['distance_walked']:.3f} m for a path of "
            f"{facts['path_length']:.3f} m, legs to {facts['largest_swing']:.3f} rad",
            f"{'ends at':10}x {x:z.4f} m, y {y:z.4f} m, yaw {yaw:z.4f} rad",
            f"{'off goal':10}{1e3 * error['position']:.2f} mm, {error['yaw']:.4f} rad",
            *([f"{'helps':10}{facts['helps']}"] if facts["helps"] else []),
            *convergence_lines(facts),
            f"{'took':10}{1e3 * timing['plan']:.1f} ms to plan, after "
            f"{1e3 * timing['compile']:.0f} ms to load and compile",
        ]
    )
