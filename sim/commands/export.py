"""`stratawalk export`: a walk as a file for servos, read back and played."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands import options as cli
from sim.commands.walks import judged
from sim.endings import again, keeping
from sim.errors import ExitCode, UsageError
from sim.progress import Progress, bar

if TYPE_CHECKING:
    from sim.evaluation.summary import Played
    from sim.export.servo_commands import ServoCommands
    from sim.export.source import Source

RATE = 50.0  # commands a second of a walk without a rate, as most hobby servos take
WORTH_TELLING = 0.005  # of the path, which an export costs
COARSE = (
    "this walk was planned for servos that take a command every physics step; plan it "
    "for yours with --set servo=NAME, or with --set command_rate={rate:g}"
)


def export(options: argparse.Namespace) -> ExitCode:
    """Export the walk and print where the export leads."""
    out = Path(options.out)
    _require_sense(options, out)

    from sim.folder import blamed_on

    folder = Path(options.scenario)
    blame = blamed_on(folder) if folder.is_dir() else nullcontext()

    def kept() -> str:
        if not out.exists():
            return f"nothing is written, start again: {again()}"
        on = again(*cli.elsewhere(str(out)))
        return f"{out} is written and not played, start again: {on}"

    with bar(quiet=options.json) as progress, blame, keeping(kept):
        source = _source(options, progress)
        commands, read, coarse = _written(options, source, out)
        played = _played(options, source, read, progress)
    summary = source.run.summary
    if not source.servo.rate:
        cli.notice(COARSE.format(rate=read.rate))
    if summary.verdict != "arrived":
        cli.notice(f"the walk that was exported {summary.verdict_text}", "warning")
    facts = {
        "file": options.out,
        "format": options.format,
        "commands": len(commands.angles),
        "rate": commands.rate,
        "joints": list(commands.joints),
        "exported": None,
        **{name: one.to_json() for name, one in played.items()},
    }
    cli.report(options, facts, _report(options, source, read, played, coarse))
    weighed = {f"the walk as {name}": one.weighed for name, one in played.items()}
    remedy = f"{options.out} is written; correct the walk before servos carry it out"
    return judged(summary, options.tolerance, remedy, weighed)


def _played(
    options: argparse.Namespace, source: Source, read: ServoCommands, progress: Progress
) -> dict[str, Played]:
    """What came of playing the export, by words for how it was played."""
    from sim.export.source import play

    ways = ["exported"] if options.play else []
    if options.play and options.format == "ros2":  # whose controller interpolates
        ways.append("interpolated")
    return {
        way: play(source, read, progress, interpolated=way == "interpolated")
        for way in ways
    }


def _require_sense(options: argparse.Namespace, out: Path) -> None:
    """Refuse files that exist, and options that exclude one another, in time."""
    if options.microseconds and options.format != "header":
        what = f"--microseconds with --format {options.format}"
        raise UsageError(what, "the command line", "only a header has pulses")
    if os.path.lexists(out):
        raise UsageError("already exists", str(out), "give --out another name")
    if not options.out or not out.parent.is_dir():
        where = options.out or "--out"
        raise UsageError("no such folder", where, "give --out a folder that exists")


def _source(options: argparse.Namespace, progress: Progress) -> Source:
    """The run that is named, or the scenario, walked now."""
    from sim.export.source import from_run, from_scenario

    folder = Path(options.scenario)
    if folder.is_dir():
        given = [*cli.given_settings(options).values()]
        if given := given + ["--set"] * bool(options.set):
            what = f"{', '.join(given)} for a run, which is exported as it was walked"
            remedy = "give the scenario instead, or leave these options out"
            raise UsageError(what, options.scenario, remedy)
        source = from_run(folder, allow_external=options.allow_external)
    else:
        scenario = cli.scenario_of(options)
        robot = cli.robot_of(options, scenario.robot)
        source = from_scenario(scenario, robot, progress)
    own = source.servo.rate
    if options.rate and own and options.rate != own:
        what = f"--rate {options.rate:g} for servos that took {own:g} a second"
        remedy = "leave --rate out, or plan with --set command_rate"
        raise UsageError(what, options.scenario, remedy)
    return source


def _written(
    options: argparse.Namespace, source: Source, out: Path
) -> tuple[ServoCommands, ServoCommands, float]:
    """The commands, written; what the file says, read back; and its counts [rad].

    Angles that are written as such have no counts, which is 0.
    """
    from sim.export.servo_table import read_ros_table
    from sim.export.source import read, servos, write

    given = read_ros_table(Path(options.servo_table)) if options.servo_table else None
    rate = options.rate or RATE
    kind, pulses = options.format, options.microseconds
    table = servos(source, kind, given, microseconds=pulses, rate=rate)
    commands = source.commands(rate)
    write(out, kind, source, commands, table)
    finest = max(channel.counts_per_radian for channel in table.channels)
    coarse = 1 / finest if kind in ("header", "dynamixel") else 0.0
    return commands, read(out, kind, table), coarse


def _report(
    options: argparse.Namespace,
    source: Source,
    commands: ServoCommands,
    played: Mapping[str, Played],
    coarse: float,
) -> str:
    from sim.evaluation.quantities import describe_export

    summary = source.run.summary
    lines = [
        f"{summary.scenario}: {summary.robot}, {len(commands.angles)} commands "
        f"of {len(commands.joints)} servos, {commands.rate:g} a second"
    ]
    for name, one in played.items():
        how = "held" if name == "exported" else name
        facts = [f"{one.bounces} bounces, each command {how}"]
        if one.changed > WORTH_TELLING:
            facts.append(_what_changed(one, commands.rate, coarse))
        lines += [f"{'played':13}{'; '.join(facts)}"]
        lines += ["", describe_export(summary, one, name), ""]
    return "\n".join([*lines, *([] if played else [""]), f"{'file':13}{options.out}"])


def _what_changed(played: Played, rate: float, coarse: float) -> str:
    """What reading and rounding cost, and how the walk is planned for it."""
    cost = f"it ends {100 * played.changed:.2g} % of its path from the walk itself"
    if coarse:
        return (
            f"{cost}, since angles are rounded to counts of {1e3 * coarse:.3g} mrad: "
            f"plan on whole ones with --set resolution={coarse:.6g}"
        )
    return f"{cost}: plan at this rate with --set command_rate={rate:g}"
