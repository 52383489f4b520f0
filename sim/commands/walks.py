"""`stratawalk run` and `play`: a scenario or a log is walked into a run folder."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands import options as cli
from sim.endings import keeping
from sim.errors import ExitCode, RenderError, UsageError, one_line
from sim.evaluation.quantities import describe
from sim.evaluation.summary import Summary, Weighed
from sim.folder import claim
from sim.logs.alignment import together
from sim.logs.log import Log
from sim.progress import bar
from sim.scenarios.predictions import PREDICTIONS, who_ignores
from sim.scenarios.scenario import Scenario, drawn

if TYPE_CHECKING:
    from models import Robot


def run(options: argparse.Namespace) -> ExitCode:
    """Walk the scenario and print how it went."""
    scenario = cli.scenario_of(options)

    from sim.world.changes import changes  # the slow part comes after refusals

    robot = cli.robot_of(options, scenario.robot)
    look = options.look if _can_film(options.video) else None
    if options.tries is not None and scenario.imperfect is None:
        scenario = replace(scenario, imperfect="hobby")
    as_drawn = drawn(scenario, robot)
    ignored = {key: each.ignored(as_drawn) for key, each in PREDICTIONS.items()}
    words = who_ignores(ignored)
    said = [f"predictions ignore {words}"] if words else []
    if options.tries is not None:
        from sim.commands.tries import tries_of

        return tries_of(scenario, robot, options, said)
    if robot.opened.files:
        said += [f"{change}: {robot.path}" for change in changes(robot, as_drawn)]
    return _walk(scenario, robot, look, options, said)


def _walk(
    scenario: Scenario,
    robot: Robot,
    look: str | None,
    options: argparse.Namespace,
    said: Iterable[str],
    log: Log | None = None,
) -> ExitCode:
    """Walk a scenario or a log into a folder, print how it went, and judge it.

    What is `said` beforehand is noticed once there is a folder.
    """
    from sim.run_folder import run

    folder = claim(cli.folder_of(options), scenario.name)

    def kept() -> str:
        if (folder.path / "summary.json").exists():
            on = "show" if look is None else "film"
            return f"the walk is complete; go on: stratawalk {on} {folder.path}"
        return cli.kept_in(folder.path, options.out)

    with keeping(kept):
        for line in said:
            cli.notice(line)
        try:
            with bar(quiet=options.json) as progress:
                summary = run(
                    scenario,
                    folder,
                    robot=robot,
                    look=look,
                    progress=progress,
                    warn=partial(cli.notice, kind="warning"),
                    log=log,
                )
        finally:
            folder.discard_if_empty()
        lines = [describe(summary), "", f"{'folder':13}{folder.path}"]
        for what, name in (("report", "report.html"), ("film", "video.mp4")):
            if (folder.path / name).exists():
                lines.append(f"{what:13}{folder.path / name}")
        cli.report(options, summary.to_json(), *lines)
    return judged(summary, options.tolerance, f"see {folder.path}")


def _can_film(wanted: bool | None) -> bool:
    """Whether to film; it is an error if a requested film cannot be drawn."""
    if wanted is False:
        return False
    from sim.pictures.run_film import check

    try:
        check()
    except RenderError as error:
        if wanted:
            raise
        cli.notice(f"no film: {one_line(error)}", "warning")
        return False
    return True


def play(options: argparse.Namespace) -> ExitCode:
    """Play the motion and print how it went."""
    from sim.logs.playing import scenario_of

    robot = cli.robot_of(options, options.robot)
    files = [Path(name) for name in options.files]
    scenario = scenario_of(robot, files[0], cli.settings_of(options))
    read = cli.reader_of(options, robot, scenario)
    logs = [read(file) for file in files]
    try:
        log = together(logs)
        log = log.repeated(options.repeat) if options.repeat > 1 else log
    except ValueError as error:
        raise UsageError.at(str(files[0]), error) from error
    look = options.look if _can_film(options.video) else None
    return _walk(scenario, robot, look, options, log.done, log)


def judged(
    summary: Summary,
    tolerance: float,
    remedy: str,
    played: Mapping[str, Weighed] | None = None,
) -> ExitCode:
    """The exit code of a walk, and of what was played of it, by names in words."""
    from sim.evaluation.verdict import FAILURES

    where = f"{summary.scenario} on {summary.robot}"
    if summary.verdict in FAILURES:
        how = f"the walk {summary.verdict_text}"
        return cli.ended(ExitCode.SIMULATION, how, where, remedy)
    for name, weighed in {"the walk": summary.weighed, **(played or {})}.items():
        if weighed and (off := weighed.beyond(tolerance)):
            how = f"{name} was {off}, beyond --tolerance {tolerance:g}"
            return cli.ended(ExitCode.TOLERANCE, how, where, remedy)
    return ExitCode.OK
