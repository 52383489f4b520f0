"""`stratawalk run` and `play`: a scenario or a log is walked into a run folder.

Several draws of an imperfect robot walk one after another, with a table of them.
"""

import argparse
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from models import Robot
from planner import PlannerError
from sim.commands import options as cli
from sim.endings import again, command, keeping
from sim.errors import ExitCode, RenderError, StratawalkError, UsageError, one_line
from sim.evaluation import quantities
from sim.evaluation.summary import Summary, Weighed
from sim.evaluation.verdict import FAILURES
from sim.folder import RunFolder, claim, csv_text
from sim.logs.alignment import together
from sim.logs.log import Log, read_log
from sim.progress import Progress, bar
from sim.scenarios.predictions import PREDICTIONS, who_ignores
from sim.scenarios.scenario import Scenario, drawn

TABLE = "tries.csv"
RANDOM = ("imperfect", "zero_offset", "bumps", "dead_band_spread")
MEASURES = {  # columns of the table: quantities, and of which row of the comparison
    "goal": (quantities.POSITION, "goal"),
    "ideal": (quantities.POSITION, "ideal"),
    "quasi_static": (quantities.POSITION, "quasi_static"),
    "yaw": (quantities.YAW, "goal"),
    "margin": (quantities.MARGIN, "achieved"),
    "thought": (quantities.WRONG, ""),
    "claimed": (quantities.CLAIMED, ""),
}


def run(options: argparse.Namespace) -> ExitCode:
    """Walk the scenario and print how it went."""
    scenario = cli.scenario_of(options)

    from sim.logs.playing import within_reach  # the slow part comes after refusals
    from sim.world.changes import changes

    robot = cli.robot_of(options, scenario.robot)
    look = options.look if _can_film(options.video) else None
    if options.tries is not None:
        asked = scenario.predictions or ("ideal", "quasi_static")  # others cost walks
        hobby = scenario.imperfect if scenario.is_imperfect else "hobby"
        scenario = replace(scenario, predictions=asked, imperfect=hobby)
    as_drawn = drawn(scenario, robot)
    made = {"ideal", *(scenario.predictions or PREDICTIONS)}
    kinds = ((key, each) for key, each in PREDICTIONS.items() if key in made)
    words = who_ignores({key: each.ignored(as_drawn) for key, each in kinds})
    hints = [f"predictions ignore {words}"] if words else []
    if options.tries is not None:
        return tries_of(scenario, robot, options, hints)
    log = None
    if scenario.motion is not None:
        log = read_log(Path(scenario.motion), robot.card.joints, robot.legs)
        hints += (log := within_reach(log, robot)).done
    if robot.opened.files:
        hints += [f"{change}: {robot.path}" for change in changes(robot, as_drawn)]
    return _walk(scenario, robot, look, options, hints, log)


def _walk(
    scenario: Scenario,
    robot: Robot,
    look: str | None,
    options: argparse.Namespace,
    hints: Iterable[str],
    log: Log | None = None,
) -> ExitCode:
    """Walk a scenario or a log into a folder, tell hints and how it went, and judge."""
    from sim.run_folder import run

    folder = claim(options.out and Path(options.out), scenario.name)

    def kept() -> str:
        if (folder.path / "summary.json").exists():
            film = [command("film", folder.path, "--look", look)] if look else []
            drawn = film and (folder.path / "report.html").exists()
            show = [] if drawn else [command("show", folder.path)]
            return f"the walk is complete; go on: {' && '.join(show + film)}"
        return cli.kept_in(folder.path, options.out)

    with keeping(kept):
        for line in hints:
            cli.notice(line)
        try:
            with bar(quiet=options.json) as progress:
                walk = partial(run, scenario, folder, robot=robot, look=look, log=log)
                warn = partial(cli.notice, kind="warning")
                summary = walk(progress=progress, warn=warn)
        finally:
            folder.discard_if_empty()
        lines = [quantities.describe(summary), "", f"{'folder':13}{folder.path}"]
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
    from sim.logs.playing import scenario_of, within_reach

    robot = cli.robot_of(options, options.robot)
    cli.require_different(files := [Path(name) for name in options.files])
    scenario = scenario_of(robot, files[0], cli.settings_of(options))
    read = cli.reader_of(options, robot, scenario)
    logs = [read(file) for file in files]
    for pose in (log.pose for log in logs if log.pose is not None):
        cli.tell_radians("body.yaw", float(np.nan_to_num(np.abs(pose[:, 2])).max()))
    try:
        log = within_reach(together(logs), robot)
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
    where = f"{summary.scenario} on {summary.robot}"
    if summary.verdict in FAILURES:
        how = f"the walk {summary.verdict_text}"
        return cli.ended(ExitCode.SIMULATION, how, where, remedy)
    for name, weighed in {"the walk": summary.weighed, **(played or {})}.items():
        if weighed and (off := weighed.beyond(tolerance)):
            how = f"{name} was {off}, beyond --tolerance {tolerance:g}"
            return cli.ended(ExitCode.TOLERANCE, how, where, remedy)
    return ExitCode.OK


class Try(NamedTuple):
    """One draw: how far its walk ended off [m], or why there is none."""

    draw: int
    verdict: str
    goal: float | None = None
    ideal: float | None = None
    quasi_static: float | None = None
    yaw: float | None = None  # off the goal's [rad]
    margin: float | None = None  # least, achieved [m]
    thought: float | None = None  # off where it was, with feedback from sensors [m]
    claimed: float | None = None  # error that feedback claims for that [m]
    off: float | None = None  # farthest off goal or prediction, as a share of the path


def tries_of(
    scenario: Scenario, robot: Robot, options: argparse.Namespace, hints: Iterable[str]
) -> ExitCode:
    """Walk draws into a folder, print hints, the worst and the median, and judge."""
    given = (getattr(scenario, name) for name in RANDOM)
    feels = scenario.replan and scenario.sense != "exact"
    if not feels and not any(one and isinstance(one, str | float) for one in given):
        raise UsageError.of("not_drawn", "--tries")
    draws = range(scenario.draw, scenario.draw + options.tries)
    replace(scenario, draw=draws[-1])  # refused before anything is written
    folder = claim(options.out and Path(options.out), scenario.name)

    def kept() -> str:
        table = folder.path / TABLE
        if not table.is_file():
            return f"no draw is done; start again: {again(*cli.elsewhere(options.out))}"
        done = table.read_bytes().count(b"\n") - 1
        rest = "--draw", f"{draws.start + done}", "--tries", f"{len(draws) - done}"
        on = again(*rest, *cli.elsewhere(options.out))
        return f"{done} of {len(draws)} draws are kept in {table}; go on: {on}"

    with keeping(kept):
        for line in hints:
            cli.notice(line)
        try:
            with bar(quiet=options.json) as progress:
                tries = walk_tries(scenario, robot, folder, draws, progress)
        finally:
            folder.discard_if_empty()
    lines = [*describe(tries, scenario.path.length), "", f"{'folder':13}{folder.path}"]
    cli.report(options, [one._asdict() for one in tries], *lines)
    return judged_tries(tries, options.tolerance, f"see {folder.path}")


def walk_tries(
    scenario: Scenario,
    robot: Robot,
    folder: RunFolder,
    draws: Sequence[int],
    progress: Progress,
) -> list[Try]:
    """Walk every draw into a run folder `draw-N`, and write `tries.csv` beside them."""
    tries: list[Try] = []
    for done, draw in enumerate(draws):
        progress("walking draws", done / len(draws))
        inner, at_draw = folder.inner(f"draw-{draw:03d}"), replace(scenario, draw=draw)
        tries.append(_try(at_draw, robot, inner, first=not done))
        folder.write_text(TABLE, csv_text([Try._fields, *tries]))
    return tries


def _try(scenario: Scenario, robot: Robot, folder: RunFolder, *, first: bool) -> Try:
    from sim.run_folder import run

    try:
        summary = run(scenario, folder, robot=robot)
    except (StratawalkError, PlannerError) as error:
        code = getattr(error, "exit_code", None)
        if code is ExitCode.FILES or (first and code is ExitCode.USAGE):
            raise  # which the next draw would meet, too
        return Try(scenario.draw, one_line(error))
    found = {name: q.value(summary, row) for name, (q, row) in MEASURES.items()}
    weighed = summary.weighed
    off = max(weighed.goal or 0.0, weighed.farthest) if weighed else None
    return Try(scenario.draw, summary.verdict, **found, off=off)


def describe(tries: Sequence[Try], path_length: float) -> Iterator[str]:
    """Median and worst of all draws, in lines for a terminal; of a path [m]."""
    walked = [one for one in tries if (one.goal, one.off) != (None, None)]
    yield f"{len(walked)} of {len(tries)} draws walked to their end"
    for one in tries:
        if one not in walked:
            yield f"draw {one.draw}: {one.verdict}"
    if not walked:
        return
    yield f"{'distance from':22}{'median':>22}{'worst':>22}"
    for name, (quantity, row) in MEASURES.items():
        values = [v for one in walked if (v := getattr(one, name)) is not None]
        if not values or quantity is quantities.YAW:
            continue
        worst = min if quantity is quantities.MARGIN else max
        ends, named = (median(values), worst(values)), quantity is quantities.POSITION
        words = [quantity.words(end) for end in ends]
        if named and path_length:
            shares = [f" {end / path_length:7.2%}" for end in ends]
            words = [w + share for w, share in zip(words, shares, strict=True)]
        label = quantities.ROWS[row] if named else quantity.label
        yield f"{label:22}" + "".join(f"{text:>22}" for text in words)


def judged_tries(tries: Sequence[Try], tolerance: float, remedy: str) -> ExitCode:
    """The exit code of several draws: that of the worst."""
    where = f"{len(tries)} draws"
    broken = [one for one in tries if one.off is None or one.verdict in FAILURES]
    if broken:
        how = f"{len(broken)} failed, draw {broken[0].draw} first ({broken[0].verdict})"
        return cli.ended(ExitCode.SIMULATION, how, where, remedy)
    worst = max(one.off or 0.0 for one in tries)
    if worst <= tolerance:
        return ExitCode.OK
    count = sum((one.off or 0.0) > tolerance for one in tries)
    off = f"{count} ended farther off goal or prediction than --tolerance {tolerance:g}"
    how = f"{off}, at worst {100 * worst:.3g} % of the path, yaw included"
    return cli.ended(ExitCode.TOLERANCE, how, where, remedy)
