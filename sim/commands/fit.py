"""`stratawalk fit`: what a robot did not come with, estimated from its logs."""

from __future__ import annotations

import argparse
from dataclasses import replace
from math import degrees, floor, log10, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands import options as cli
from sim.errors import UsageError
from sim.progress import bar, stage

if TYPE_CHECKING:
    from sim.fitting.estimate import Estimates, Parameter
    from sim.fitting.fitting import JointFit, Value
    from sim.fitting.poses import PoseFit, Walked
    from sim.logs.log import Log
    from sim.preparation.setup import Setup

MILLI, MILLI_UNITS = 1e3, {"rad": "mrad", "s": "ms"}  # in tables


def fit(options: argparse.Namespace) -> None:
    """Fit servos and what moves the body, print both, and write a card if asked for."""
    from sim.fitting.fitting import card_text, check_free, fit_joints, write_card
    from sim.fitting.poses import fit_poses

    if options.out is not None:
        check_free(Path(options.out))
    setup, logs, walked = _sources(options)
    walking = walked is not None if options.walking is None else options.walking
    told: dict[str, tuple[Value, Value]] = {}
    facts: dict[str, object] = {}
    lines: list[str] = []
    with bar(quiet=options.json) as progress:
        if all(log.measured is not None for log in logs):
            with stage(progress, "fitting servos"):
                fit = fit_joints(setup, logs, walking)
            told |= fit.settings(setup.robot.card.joints)
            both = zip(fit.joints, fit.before.tolist(), fit.after.tolist(), strict=True)
            kept = {joint: {"before": b, "after": a} for joint, b, a in both}
            facts["servos"] = {"unseen": fit.make.unseen(), "held_out": kept}
            lines += _servo_lines(fit)
        if walked is not None:
            delay, _ = told.get("command_delay", (0.0, 0.0))
            late = replace(walked, times=walked.times - delay)
            with stage(progress, "fitting what moves the body"):
                body = fit_poses(late)
            told = {**body.settings, **told}
            missed = {"before": body.before, "after": body.after}
            facts["body"] = {"unseen": body.found.unseen(), "held_out": missed}
            lines = [*_body_lines(body), *lines]
    if options.out is not None:
        text = card_text(setup.robot, told, options.sources)
        lines.append(f"written: {write_card(setup.robot, Path(options.out), text)}")
    settings = {key: {"value": v, "error": e} for key, (v, e) in told.items()}
    cli.report(options, {"settings": settings} | facts, *lines)


def _sources(options: argparse.Namespace) -> tuple[Setup, list[Log], Walked | None]:
    """The robot as it is known, logs of the same joints, and the first one's poses."""
    from models import shipped_robots
    from sim.fitting.poses import log_of, walked_of_log, walked_of_run
    from sim.logs.log import read_log
    from sim.logs.playing import scenario_of
    from sim.preparation.setup import prepare
    from sim.runs.run import read_run

    first, *rest = options.sources
    named = first.endswith(".xml") or first in shipped_robots()
    paths = [Path(name) for name in (rest if named else options.sources)]
    if not paths:
        raise UsageError("nothing to fit", first, "name a LOG, or a RUN")
    runs = {path: read_run(path) for path in paths if path.is_dir()}
    if not named and paths[0] not in runs:
        what = f"{first!r} is no robot, and a log does not name its own"
        raise UsageError(what, "the command line", f"stratawalk fit hexapod {first}")
    run = runs.get(paths[0])
    robot = cli.robot_of(options, run.scenario.robot if run and not named else first)
    logs = [
        log_of(runs[path])
        if path in runs
        else read_log(path, robot.card.joints, robot.legs, options.units)
        for path in paths
    ]
    for path, log in zip(paths, logs, strict=True):
        if log.measured is None and log.pose is None:
            remedy = "give columns measured.JOINT, or body.x, body.y and body.yaw"
            raise UsageError("nothing was measured", str(path), remedy)
        if log.joints != logs[0].joints:
            what = f"other joints than in {paths[0]}"
            remedy = "give the same columns, or fit each alone"
            raise UsageError(what, str(path), remedy)
    if run is not None:
        return prepare(run.scenario, robot), logs, walked_of_run(run)
    scenario = scenario_of(robot, paths[0], cli.settings_of(options))
    setup = prepare(scenario, robot, log=logs[0])
    try:
        walked = None if logs[0].pose is None else walked_of_log(setup, logs[0])
    except ValueError as error:
        raise UsageError.at(str(paths[0]), error) from error
    return setup, logs, walked


def _body_lines(fit: PoseFit) -> list[str]:
    """What moves the body, what does not show, and what the kept rows say."""
    cells = zip(fit.found.parameters, _cells(fit.found, 0), strict=True)
    return [
        *(f"{p.name:24}{cell:>20} {_unit(p)}".rstrip() for p, cell in cells),
        *fit.found.unseen(),
        "zeros are not fitted to where the body went, only to measured joints",
        f"the walk's last quarter is missed by {1e3 * fit.before:.2f} mm as the robot "
        f"was described, and by {1e3 * fit.after:.2f} as it was fitted to the rest",
        "",
    ]


def _servo_lines(fit: JointFit) -> list[str]:
    """Every joint, all of them, what does not show, and what the kept rows say."""
    servo = fit.each.parameters
    shared = dict(zip(fit.make.parameters, _cells(fit.make, 0), strict=True))
    rows = [
        ("", [p.name for p in servo]),
        ("", [f"[{_unit(p)}]" for p in servo]),
        *((joint, _cells(fit.each, row)) for row, joint in enumerate(fit.joints)),
        ("all joints", [shared.get(p, "") for p in servo]),
    ]
    unseen: dict[str, list[str]] = {}
    for row, joint in enumerate(fit.joints):
        for words in fit.each.unseen(row):
            unseen.setdefault(words, []).append(joint)
    for words in fit.make.unseen():
        unseen.setdefault(words, []).append("all joints together")
    before, after = (degrees(sqrt((r**2).mean())) for r in (fit.before, fit.after))
    return [
        *(f"{name:12}{''.join(f'{c:>20}' for c in row)}" for name, row in rows),
        "",
        *(f"{words}: {', '.join(joints)}" for words, joints in unseen.items()),
        f"the last quarter is missed by {before:.3f} degrees as the robot was "
        f"described, and by {after:.3f} as it was fitted to the rest",
    ]


def _unit(parameter: Parameter) -> str:
    return MILLI_UNITS.get(parameter.unit, parameter.unit)


def _cells(estimates: Estimates, problem: int) -> list[str]:
    """Values and standard errors that were seen, in thousandths of rad and s."""
    cells = []
    for k, parameter in enumerate(estimates.parameters):
        scale = MILLI if parameter.unit in MILLI_UNITS else 1.0
        value, error = (scale * number for number in estimates.told(k, problem))
        places = min(max(1 - floor(log10(max(error, 1e-9))), 0), 6)
        text = f"{value:.{places}f} +- {error:.{places}f}"
        cells.append(text if estimates.seen[problem, k] else "-")
    return cells
