"""`stratawalk fit`: what a robot did not come with, estimated from its logs."""

import argparse
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from math import floor, log10, sqrt
from pathlib import Path

import numpy as np

from models import Robot, shipped_robots
from planner import Array
from sim.commands import options as cli
from sim.endings import command
from sim.errors import UsageError
from sim.fitting import fitting
from sim.fitting.estimate import LEAST_NOISE, Estimates
from sim.fitting.poses import Walked, fit_poses, log_of, walked_of_log, walked_of_run
from sim.folder import blamed_on
from sim.logs.alignment import ordered
from sim.logs.log import Log
from sim.logs.playing import scenario_of
from sim.preparation.setup import Setup, prepare
from sim.progress import bar, stage
from sim.runs.run import Run, read_run
from sim.scenarios.scenario import FITTED, fitted_to
from sim.scenarios.settings import SETTINGS
from sim.templates import render
from sim.world.servos import servo_settings

BUILT = ("body_mass", "body_inertia", "body_pos", "body_quat", "body_ipos",
         "body_iquat", "jnt_pos", "jnt_axis", "jnt_stiffness", "dof_damping",
         "dof_armature", "dof_frictionloss")  # fmt: skip
SHAPES = "geom_pos", "geom_quat", "geom_size"  # of what touches
ROUNDED = 1e-5  # of the largest number of a kind; files have some seven digits
OTHERS = ("servo_data", "command_rate", "resolution", "dead_band_law",
          "dead_band_spread", "floor_stiffness", "foot_friction", "bumps")  # fmt: skip
"""Settings of servos and the floor that are the same in runs fitted together."""
MILLI, MILLI_UNITS = 1e3, {"rad": "mrad", "s": "ms"}  # in tables


def fit(options: argparse.Namespace) -> None:
    """Fit servos and what moves the body, print both, and write a card if asked for."""
    if options.out is not None:
        fitting.check_free(Path(options.out))
    runs = [path for path in map(Path, options.sources) if path.is_dir()]
    with blamed_on(runs[0]) if runs else nullcontext():
        setup, logs, walked = _sources(options)
    for line in dict.fromkeys(line for log in logs for line in log.done):
        cli.notice(line)
    card, make = setup.robot.card, setup.servo.name
    known = fitted_to(card, make)
    walking = walked is not None if options.walking is None else options.walking
    fitted: dict[str, tuple[fitting.Value, fitting.Value]] = {}
    facts: dict[str, object] = {}
    parts: dict[str, object] = dict.fromkeys(("body", "servos", "written"))
    with bar(quiet=options.json) as progress:
        if angles := [log for log in logs if log.measured is not None]:
            with stage(progress, "fitting servos"):
                fit = fitting.fit_joints(setup, angles, walking)
            fitted |= fit.settings(card.joints, known)
            both = zip(fit.joints, fit.before.tolist(), fit.after.tolist(), strict=True)
            kept = {joint: {"before": b, "after": a} for joint, b, a in both if b == b}
            facts["servos"] = {"unseen": fit.make.unseen(), "held_out": kept}
            parts["servos"] = _of_servos(fit) | {"noise": _noise(angles)}
        if walked is not None:
            told = {} if walked.in_force else fitted
            delay, _ = told.get("command_delay", (0.0, 0.0))
            with stage(progress, "fitting what moves the body"):
                body = fit_poses(replace(walked, times=walked.times - delay))
            fitted = {**body.settings, **fitted}
            missed = {"before": body.before, "after": body.after}
            found = {"unseen": body.found.unseen(), "held_out": missed}
            cells = zip(body.found.parameters, _cells(body.found, 0), strict=True)
            rows = [(p.name, c, MILLI_UNITS.get(p.unit, p.unit)) for p, c in cells]
            facts["body"], parts["body"] = found, found | {"rows": rows}
    if options.out is not None:
        if make != card.make:
            cli.notice(f"what was fitted of servos is of {make} alone")
        text = fitting.card_text(setup.robot, fitted, options.sources, make)
        parts["written"] = fitting.write_card(setup.robot, Path(options.out), text)
        earlier = (known.keys() - fitted.keys()) & SETTINGS.keys()
        if lost := ", ".join(sorted(earlier)):
            cli.notice(f"{lost} of an earlier fit: copy to {options.out} what holds")
    settings = {key: {"value": v, "error": e} for key, (v, e) in fitted.items()}
    cli.report(options, {"settings": settings} | facts, render("fit.txt", **parts))


def _sources(options: argparse.Namespace) -> tuple[Setup, list[Log], Walked | None]:
    """The robot as it is known, logs of the same joints, and the first one's poses."""
    first, *rest = options.sources
    named = first.endswith(".xml") or first in shipped_robots()
    paths = [Path(name) for name in (rest if named else options.sources)]
    if not paths:
        raise UsageError.of("no_log", first, fit=command("fit", first, "LOG.csv"))
    cli.require_different(paths)
    runs = {path: read_run(path) for path in paths if path.is_dir()}
    if not named and paths[0] not in runs:
        what = f"{first!r} is neither a robot nor a run, and a log names no robot"
        raise UsageError(what, "fit", f"name it: {command('fit', 'hexapod', first)}")
    run = runs.get(paths[0])
    robots = {
        path: cli.robot_of(options, one.scenario.robot, one.scenario.geometry)
        for path, one in runs.items()
    }
    robot = cli.robot_of(options, first) if named else robots[paths[0]]
    _require_alike(runs, robots, robot, first)
    settings = cli.settings_of(options)
    if run and settings:
        raise UsageError.of("knows_settings", paths[0])
    scenario = run.scenario if run else scenario_of(robot, paths[0], settings)
    for path, one in runs.items():
        if one.summary.servo.get("name") != servo_settings(scenario, robot.card).name:
            raise UsageError.of("other_world", path, name="servo", first=robot.path)
    read = cli.reader_of(options, robot, scenario)
    logs = [log_of(runs[path]) if path in runs else read(path) for path in paths]
    held = options.walking is False
    _check_logs(paths, logs, held)
    logs = [ordered(log, logs[0].joints) for log in logs]
    fitting.check_told(paths[0], logs)
    setup = prepare(scenario, robot, log=None if run else logs[0])
    posed = not held and (run is not None or logs[0].pose is not None)
    if posed or options.walking:
        fitting.check_steps(paths[0], logs, setup.limits.timestep)
    if run is not None:
        return setup, logs, walked_of_run(run, robots[paths[0]]) if posed else None
    try:
        walked = walked_of_log(setup, logs[0]) if posed else None
    except ValueError as error:
        raise UsageError.at(str(paths[0]), error) from error
    return setup, logs, walked


def _require_alike(
    runs: Mapping[Path, Run], robots: Mapping[Path, Robot], robot: Robot, first: str
) -> None:
    """Refuse runs of other robots than the one that is fitted, or of other worlds."""
    scenarios = [run.scenario for run in runs.values()]
    for path, own in zip(runs, scenarios, strict=True):
        if not _is_alike(robots[path], robot):
            raise UsageError.of("other_robot", path, first=first)
        for name in (*FITTED, *OTHERS, *["draw"] * own.is_imperfect):
            if getattr(own, name) != getattr(scenarios[0], name):
                raise UsageError.of("other_world", path, name=name, first=[*runs][0])


def _is_alike(robot: Robot, other: Robot) -> bool:
    """Whether robots have, but for rounding, all that motion depends on but servos."""
    both = zip(_made(robot), _made(other), strict=True)
    return robot.card.legs == other.card.legs and all(
        a.shape == b.shape and np.allclose(a, b, 0, ROUNDED * abs(a).max(initial=0))
        for a, b in both
    )


def _made(robot: Robot) -> list[Array]:
    model = robot.model
    touches = (model.geom_contype | model.geom_conaffinity) > 0
    touches &= model.body_weldid[model.geom_bodyid] > 0  # not those of the floor
    shapes = [getattr(model, name)[touches] for name in SHAPES]
    return [getattr(model, name) for name in BUILT] + shapes


def _check_logs(paths: Sequence[Path], logs: Sequence[Log], held: bool) -> None:
    """Refuse logs that tell nothing of servos or walks, too much, or other joints."""
    seconds = sum(log.duration * len(log.joints) for log in logs)
    count = sum(log.measured.size for log in logs if log.measured is not None)
    if (part := fitting.MOST_ANGLES / (count + fitting.A_SECOND * seconds)) < 1:
        raise UsageError("too long to fit", str(paths[0]), f"give {part:.0%} of it")
    for path, log in zip(paths, logs, strict=True):
        if log.measured is None and log.pose is None:
            raise UsageError.of("unmeasured", path)
        if log.measured is None and (held or log is not logs[0]):
            raise UsageError.of("poses_alone", path)
        fitting.check_measured(path, log)
        if {*log.joints} != {*logs[0].joints}:
            raise UsageError.of("other_joints", path, first=paths[0])


def _of_servos(fit: fitting.JointFit) -> dict[str, object]:
    """Every joint, all of them, what does not show, and what the kept rows say."""
    servo = fit.each.parameters
    shared = dict(zip(fit.make.parameters, _cells(fit.make, 0), strict=True))
    rows = [
        ("", [p.name for p in servo]),
        ("", [f"[{MILLI_UNITS.get(p.unit, p.unit)}]" for p in servo]),
        *((joint, _cells(fit.each, row)) for row, joint in enumerate(fit.joints)),
        ("all joints", [shared.get(p, "") for p in servo]),
    ]
    unseen: dict[str, list[str]] = {}
    for row, joint in enumerate(fit.joints):
        for words in fit.each.unseen(row):
            unseen.setdefault(words, []).append(joint)
    for words in fit.make.unseen():
        unseen.setdefault(words, []).append("all joints together")
    before, after = (sqrt((m[m == m] ** 2).mean()) for m in (fit.before, fit.after))
    return {"rows": rows, "unseen": unseen, "before": before, "after": after}


def _noise(logs: Sequence[Log]) -> float:
    """Of measured angles [rad], from third differences, which smooth motion has not."""
    seen = (log.measured for log in logs if log.measured is not None)
    rough = [np.diff(angles, 3, axis=0).ravel() for angles in seen]
    return max(float(np.nanstd(np.concatenate(rough)) / sqrt(20)), LEAST_NOISE)


def _cells(estimates: Estimates, problem: int) -> list[str]:
    """Values and standard errors that were seen, in thousandths of rad and s."""
    cells = []
    for k, parameter in enumerate(estimates.parameters):
        scale = MILLI if parameter.unit in MILLI_UNITS else 1.0
        value, error = (scale * number for number in estimates.of(k, problem))
        places = min(max(1 - floor(log10(max(error, 1e-9))), 0), 6)
        text = f"{value:z.{places}f} +- {error:.{places}f}"
        cells.append(text if estimates.seen[problem, k] else "-")
    return cells
