"""`stratawalk plan`: the plan on the exact kinematics, without physics."""

import argparse
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from planner import BudgetError, Plan, RangeError, load_plan, rollout, save_plan
from planner.support import limited
from sim.commands import options as cli, plan_report as told
from sim.commands.declared import GUESSES
from sim.commands.parsing import goal_setting
from sim.commands.systems import coordinates, find, is_system, refused
from sim.errors import UsageError
from sim.folder import new_file, require_free, whole
from sim.problems.problem import Problem
from sim.problems.system import PLAN_TIME, SystemProblem
from sim.progress import Progress, at_most, bar, stage
from sim.scenarios.file import shipped_scenarios
from sim.scenarios.scenario import Scenario

if TYPE_CHECKING:
    from models import Robot

ARROWS = 5  # states in pictures for which one arrow is drawn
HEADINGS = ("theta", "theta_0", "heading")  # names of coordinates that are headings
Outcome = tuple[Plan, told.Report]
BY_ELEMENTS = ("elements", "degree", "words", "replan")  # not in chained form


def plan(options: argparse.Namespace) -> None:
    """Plan the scenario or the system and print the result."""
    source = options.scenario
    if not _is_for_systems(options):
        if (scenario := cli.scenario_of(options)).motion is not None:
            raise UsageError.of("no_plan", f"scenario {scenario.name!r}")
        robot = cli.robot_of(options, scenario.robot)
        with bar(quiet=options.json) as progress:
            planned, shown = _walk(scenario, robot, progress)
    elif source.endswith(".json"):
        with refused(source):
            planned = load_plan(source)
        shown = told.of_system(Path(source).stem, planned)
    else:
        with bar(quiet=options.json) as progress, refused(source):
            planned, shown = _system(options, progress)
    facts, text = shown
    if options.flows:
        facts["flows"] = planned.flows
        text = "\n".join([*map(str, planned.flows), "", text])
    if options.out:
        _draw(Path(source).stem, planned, Path(options.out))
        text += f"\npicture   {options.out}"
    if options.save:
        with refused(options.save), whole(Path(options.save), new=True) as part:
            save_plan(planned, part)
    cli.report(options, facts, text)


def _draw(name: str, planned: Plan, path: Path) -> None:
    """Draw the way of a system in its first two coordinates, as y over x.

    Arrows show its headings and that of the goal; colours, the order of travel.
    """
    from matplotlib.figure import Figure

    way, figure = rollout(planned, told.SAMPLES), Figure(layout="constrained")
    states, order = np.vstack([way, planned.goal]), [*range(len(way)), len(way) - 1]
    names = list(map(str, planned.system.state))
    title = f"{name}, ends {np.linalg.norm(way[-1] - planned.goal):.2g} off its goal"
    axes = figure.add_subplot(aspect="equal", adjustable="datalim")
    axes.set_title(title, parse_math=False)
    axes.set(xlabel=names[0], ylabel=names[:2][-1])
    drawn = states.T[:2][[0, -1]]  # of a single coordinate, twice
    shown = axes.scatter(drawn[0], drawn[1], 3, order)
    for label, mark, place in ("start", "o", 0), ("goal", "s", -1), ("end", "x", -2):
        axes.plot(*drawn[:, place], f"k{mark}", fillstyle="none", ms=9, label=label)
    for heading in (states[:, names.index(h)] for h in HEADINGS if h in names[2:]):
        turned = np.array([*drawn, np.cos(heading), np.sin(heading), order])
        seen = turned[:, [*range(0, len(way), ARROWS), -1]]
        axes.quiver(*seen, scale=18, width=0.004)
    figure.colorbar(shown, label="order of travel, dark first", ticks=[])
    figure.legend(loc="outside lower center", ncols=3)
    with whole(path, new=True) as part:
        figure.savefig(part, dpi=120)


def _is_for_systems(options: argparse.Namespace) -> bool:
    """Whether no scenario is to be planned; options for the other kind are refused."""
    source = options.scenario
    if source.endswith(".json"):
        _refuse(options, GUESSES["saved"], "cannot change a saved plan")
    elif not is_system(source, shipped_scenarios()):
        _refuse(options, GUESSES["scenarios"], "is for systems")
        return False
    _refuse(options, GUESSES["systems"], "is for robots")
    if options.out is not None:
        new_file(Path(options.out), "picture", ".png", ".svg", ".pdf")
    if options.save:
        require_free(options.save, "--save")
    return True


def _refuse(options: argparse.Namespace, names: Mapping[str, str], why: str) -> None:
    for name, remedy in names.items():
        if getattr(options, name) not in (None, []):
            way = remedy.format(goal=goal_setting(options.goal or ()))
            raise UsageError(f"--{name} {why}", options.scenario, way)


def _walk(scenario: Scenario, robot: "Robot", progress: Progress) -> Outcome:
    from sim.preparation.setup import prepare  # these load MuJoCo
    from sim.problems.scenario import ScenarioProblem

    began = time.perf_counter()
    with stage(progress, "compiling"):
        setup = prepare(scenario, robot)
    compiled = time.perf_counter()
    with at_most(progress, "planning", scenario.plan_time):
        problem = ScenarioProblem.ready(setup, progress)
    return _outcome(problem, partial(told.of_walk, problem), began, compiled, progress)


def _system(options: argparse.Namespace, progress: Progress) -> Outcome:
    began = time.perf_counter()
    with stage(progress, "compiling"):
        wanted = find(options.scenario, cli.settings_of(options))
        by_elements = any(getattr(options, o) not in (None, []) for o in BY_ELEMENTS)
        chained = wanted.flat is not None and not by_elements
        changes = {k: getattr(options, k) for k in ("elements", "degree", "words")}
        changes |= {
            "start": options.start and coordinates(options.start, "--start"),
            "goal": options.goal and coordinates(options.goal, "--goal"),
            "segments": 1 if chained and options.segments is None else options.segments,
            "gait": options.gait and tuple(options.gait),
            "in_gait": bool(options.gait) or None,
        }
        for name in set(HEADINGS) & set(changes["goal"] or {}):
            cli.tell_radians(name, changes["goal"][name])
        wanted = replace(wanted, **{k: v for k, v in changes.items() if v is not None})
        objective = options.optimise or "none"
        if options.free and objective == "none":
            raise UsageError.of("nothing_free", "--free")
        with limited(PLAN_TIME):
            problem = SystemProblem(
                wanted,
                replan=bool(options.replan),
                objective=objective,
                chained=chained,
                free=options.free or (),
            )
    played = partial(
        told.of_system, Path(options.scenario).stem, folded=wanted.largest_fold
    )
    return _outcome(problem, played, began, time.perf_counter(), progress)


def _outcome(
    problem: Problem,
    played: Callable[[Plan, told.Prospect], told.Report],
    began: float,
    compiled: float,
    progress: Progress,
) -> Outcome:
    """Plan; where no number of segments makes a plan fit, what was tried is said."""
    try:
        with at_most(progress, "planning", problem.plan_time):
            solution = problem.solve()
    except RangeError as error:
        if error.segments is not None:
            raise
        raise problem.refusal(error) from error
    timing = {"compile": compiled - began, "plan": time.perf_counter() - compiled}
    accuracy = steps = None
    with stage(progress, "trying what would help"):
        helps = problem.helps(solution.plan)
    searched = problem.objective != "none" and not solution.fallback
    if helps or not (problem.replan or searched):  # else nothing is left to say
        with stage(progress, "measuring the accuracy"), suppress(BudgetError):
            with limited(problem.plan_time):
                both = told.Accuracy.of(problem, solution.plan), told.Steps.of(problem)
            accuracy, steps = both
    found = helps, solution.fallback, timing, accuracy, steps, problem.is_exact
    return solution.plan, played(solution.plan, told.Prospect(*found))
