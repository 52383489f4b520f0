"""The part of `stratawalk plan` for systems and for saved plans of systems."""

from __future__ import annotations

import argparse
import json
import math
import os
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.commands.convergence import (
    convergence,
    describe as convergence_lines,
    step_lengths,
)
from sim.errors import UsageError

if TYPE_CHECKING:
    from models import Problem
    from planner import Array, ExtendedSystem, Plan
    from planner.optimisation import Objective

OBJECTIVES: tuple[Objective, ...] = ("time", "strokes", "switches")
PLAN_TIME = 300.0  # [s] that planning a system may take
FOR_ROBOTS = dict.fromkeys(("robot", "fields", "steer"), "leave it out")
FOR_SYSTEMS = {
    "start": "leave it out, scenarios start at the origin",
    "goal": "set a scenario's path.goal",
    "elements": "set a scenario's fields",
    "save": "leave it out, run keeps what it walks",
}
BY_ELEMENTS = ("elements", "degree", "words", "replan")  # not in chained form
SETTLED = dict.fromkeys(
    (
        *(
            "start",
            "goal",
            "elements",
            "segments",
            "replan",
            "set",
            "degree",
            "words",
            "gait",
        ),
        "optimise",
    ),
    "leave it out",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that apply to systems only."""
    group = parser.add_argument_group("for systems")
    for option in ("start", "goal"):
        group.add_argument(
            f"--{option}",
            metavar="NAME=VALUE",
            nargs="+",
            help=f"coordinates at the {option}",
        )
    group.add_argument(
        "--elements",
        metavar="ELEMENT",
        nargs="+",
        help="fields and brackets to steer with, as in g1 g2 [g1,g2]",
    )
    group.add_argument("--save", metavar="FILE.json", help="keep the plan")


def is_for_systems(options: argparse.Namespace) -> bool:
    """Whether a system, or a plan saved of one, is to be planned and not a scenario.

    Raises:
        UsageError: There is no such thing, or an option is for the other kind.
    """
    from sim.commands.problems import is_system
    from sim.scenarios.file import shipped_scenarios

    source = options.scenario
    if source.endswith(".json"):
        _refuse(options, SETTLED, "cannot change a saved plan")
    elif not is_system(source, shipped_scenarios()):
        _refuse(options, FOR_SYSTEMS, "is for systems")
        return False
    _refuse(options, FOR_ROBOTS, "is for robots")
    if options.save == "":
        raise UsageError("an empty name", "--save", "name a file, or leave it out")
    if options.save and os.path.lexists(options.save):
        raise UsageError("already exists", options.save, "give --save another name")
    return True


def _refuse(options: argparse.Namespace, names: Mapping[str, str], why: str) -> None:
    for name, remedy in names.items():
        if getattr(options, name) not in (None, []):
            raise UsageError(f"--{name} {why}", options.scenario, remedy)


def execute(options: argparse.Namespace) -> None:
    """Plan the system, or read a saved plan, and print the result."""
    from planner import load_plan, save_plan
    from sim.commands.problems import refused
    from sim.commands.system_remedies import helps
    from sim.progress import at_most, bar, stage

    source = options.scenario
    with bar(quiet=options.json) as progress:
        with refused(source), at_most(progress, "planning", PLAN_TIME):
            saved = source.endswith(".json")
            planned, more = (load_plan(source), {}) if saved else _plan(options)
        with stage(progress, "following the plan"):
            facts = summarise(Path(source).stem, planned) | more
        if not saved and options.optimise in (None, "none"):
            with stage(progress, "trying what would help"):
                facts["helps"] = helps(_problem(options), facts, PLAN_TIME)
    if options.save:
        with refused(options.save):
            save_plan(planned, options.save)
    if options.json:
        print(json.dumps(facts | ({"flows": planned.flows} if options.flows else {})))
        return
    if options.flows:
        print(*planned.flows, "", sep="\n")
    print(describe(facts))


def _chained(problem: Problem, segments: int) -> tuple[Plan, dict[str, Any]]:
    """A plan in chained form, which is exact in a single segment."""
    from planner.planning import chained_form
    from sim.commands.problems import refused

    with refused(problem.name):
        began = time.perf_counter()
        form = chained_form(problem.system, problem.flat)
        ready = time.perf_counter()
        planned = form.plan(*problem.states, segments)
        done = time.perf_counter()
    degree = form.model.steering.degree
    return planned, {
        "accuracy": {"degree": degree, "order": None, "faster": {}},
        "timing": {"compile": ready - began, "plan": done - ready},
    }


def _problem(options: argparse.Namespace) -> Problem:
    """The problem of the command line."""
    from sim.commands.problems import changed, coordinates, find

    changes = {
        "start": options.start and coordinates(options.start, "--start"),
        "goal": options.goal and coordinates(options.goal, "--goal"),
        "segments": options.segments,
        "elements": options.elements,
        "degree": options.degree,
        "words": options.words,
        "gait": options.gait and tuple(options.gait),
        "in_gait": bool(options.gait) or None,
    }
    return changed(find(options.scenario, options.set), changes)


def _plan(options: argparse.Namespace) -> tuple[Plan, dict[str, Any]]:
    from planner import line
    from planner.planning import set_down
    from sim.commands.problems import extended, solve

    problem = _problem(options)
    if problem.flat and all(getattr(options, o) in (None, []) for o in BY_ELEMENTS):
        return _chained(problem, options.segments or 1)
    began = time.perf_counter()
    compiled = extended(problem)
    ready = time.perf_counter()
    planned = solve(problem, compiled, aimed=bool(options.replan))
    if options.optimise not in (None, "none"):
        planned = _shortest(problem, compiled, planned, options.optimise)
    timing = {"compile": ready - began, "plan": time.perf_counter() - ready}
    path = line(*(set_down(problem.system, x) for x in problem.states))
    accuracy = convergence(compiled, path, problem.open_loop.coordinates)
    steps = step_lengths(compiled, path, problem.segments)
    return planned, {"accuracy": accuracy, "steps": steps, "timing": timing}


def _shortest(
    problem: Problem, compiled: ExtendedSystem, stratified: Plan, objective: str
) -> Plan:
    from sim.optimisation.systems import shortest

    for known in OBJECTIVES:
        if objective == known:
            return shortest(problem, compiled, stratified, known)
    wanted = f"give {', '.join(OBJECTIVES)} or none"
    raise UsageError(f"unknown objective {objective!r}", "--optimise", wanted)


def summarise(name: str, planned: Plan) -> dict[str, Any]:
    """Results of a plan on the exact kinematics.

    Args:
        name: What the system is called.
        planned: Plan to play.
    """
    from planner import rollout

    end = rollout(planned)[-1]
    return {
        "system": name,
        "segments": len(planned.segment_ends),
        "elements": planned.elements,
        "start": _named(planned, planned.start),
        "goal": _named(planned, planned.goal),
        "end": _named(planned, end),
        "distance": math.dist(planned.start, planned.goal),
        "error": math.dist(end, planned.goal),
        "flow_count": len(planned.flows),
        "flow_time": sum(abs(flow.duration) for flow in planned.flows),
        "contact_switches": planned.contact_switches,
    }


def _named(planned: Plan, state: Array) -> dict[str, float]:
    names = map(str, planned.system.state)
    return dict(zip(names, state.tolist(), strict=True))


def describe(facts: Mapping[str, Any]) -> str:
    """The facts in a few lines, with every coordinate at the end."""
    ends = ", ".join(f"{name} {value:z.4f}" for name, value in facts["end"].items())
    share = facts["error"] / facts["distance"] if facts["distance"] else 0.0
    lines = [
        f"{facts['system']}: {facts['segments']} segments, {facts['flow_count']} "
        f"flows for a time of {facts['flow_time']:.4g} in all, "
        f"{facts['contact_switches']} contact switches",
        f"{'steers by':10}{', '.join(facts['elements'])}",
        f"{'ends at':10}{ends}",
        f"{'off goal':10}{facts['error']:.3g}, {100 * share:.3g} % of the way",
        *([f"{'helps':10}{facts['helps']}"] if facts.get("helps") else []),
    ]
    lines += convergence_lines(facts)
    if timing := facts.get("timing"):
        lines.append(
            f"{'took':10}{1e3 * timing['plan']:.1f} ms to plan, after "
            f"{1e3 * timing['compile']:.0f} ms to compile"
        )
    return "\n".join(lines)
