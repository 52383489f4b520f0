"""`stratawalk export`: a walk as a file for servos, read back and played."""

from __future__ import annotations

import argparse
import os
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.commands import options as cli
from sim.commands.walks import judged
from sim.endings import again, command, keeping
from sim.errors import ExitCode, UsageError, message
from sim.evaluation.quantities import describe_export
from sim.folder import blamed_on, require_free, require_writable
from sim.progress import Progress, bar
from sim.scenarios.scenario import drawn
from sim.templates import render

if TYPE_CHECKING:
    from sim.evaluation.summary import Played
    from sim.export.servo_commands import ServoCommands
    from sim.export.source import Source

RATE = 50.0  # commands a second of a walk without a rate, as most hobby servos take
IN_COMMANDS = "zero_offset", "command_delay"  # imperfections of servos that are


def export(options: argparse.Namespace) -> ExitCode:
    """Export the walk and print where the export leads."""
    out = Path(options.out)
    _require_sense(options, out)

    folder = Path(options.scenario)
    blame = blamed_on(folder) if folder.is_dir() else nullcontext()

    def kept() -> str:
        if not os.path.exists(out):  # which no name is too long for
            return f"nothing is written; start again: {again()}"
        on = again(*cli.elsewhere(str(out)))
        return f"{out} is written and not played; start again: {on}"

    with bar(quiet=options.json) as progress, blame, keeping(kept):
        source = _source(options, progress)
        commands, read, coarse = _written(options, source, out)
        try:
            played = _played(options, source, read, progress)
        except Exception:
            out.unlink(missing_ok=True)  # what nobody can play, no servo should
            raise
    summary = source.run.summary
    if not source.servo.rate:
        cli.notice(message("every_step", rate=read.rate))
    own = drawn(source.run.scenario, source.robot)
    if late := [n for n in IN_COMMANDS if np.any(getattr(own, n))]:
        cli.notice(message("in_commands", names=" and ".join(late)), "warning")
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
    shown = [(n, one, describe_export(summary, one, n)) for n, one in played.items()]
    found = {"commands": read, "played": shown, "coarse": coarse, "file": options.out}
    cli.report(options, facts, render("export.txt", **found, **summary))
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
        raise UsageError.of("pulses", "the command line", format=options.format)
    require_free(out, "--out")
    if not out.parent.is_dir():
        raise UsageError.of("no_folder", out)
    require_writable(out.parent)


def _source(options: argparse.Namespace, progress: Progress) -> Source:
    """The run that is named, or the scenario, walked now."""
    from sim.export.source import from_run, from_scenario

    folder = Path(options.scenario)
    if folder.is_dir():
        given = [*cli.given_settings(options).values()]
        if given := given + ["--set"] * bool(options.set):
            raise UsageError.of("walked", options.scenario, given=", ".join(given))
        source = from_run(folder, allow_external=options.allow_external)
    else:
        scenario = cli.scenario_of(options)
        robot = cli.robot_of(options, scenario.robot)
        source = from_scenario(scenario, robot, progress)
    own = source.servo.rate
    if options.rate and own and options.rate != own:
        raise UsageError.of("other_rate", options.scenario, rate=options.rate, own=own)
    return source


def _written(
    options: argparse.Namespace, source: Source, out: Path
) -> tuple[ServoCommands, ServoCommands, float]:
    """The commands, written; what the file says, read back; and its counts [rad].

    Angles that are written as such have no counts, which is 0.
    """
    from sim.export.ros_table import read_ros_table
    from sim.export.source import read, servos, write

    given = read_ros_table(Path(options.servo_table)) if options.servo_table else None
    if given and (others := ", ".join(sorted(given.keys() - {*source.joints}))):
        cli.notice(f"left out of the servo table, as no joint moves so: {others}")
    rate = options.rate or RATE
    kind, pulses = options.format, options.microseconds
    table = servos(source, kind, given, microseconds=pulses, rate=rate)
    if given and kind == "header":
        frames = f"{table.frame_rate:.4g} frames a second"
        cli.notice(f"counts of {options.servo_table} are taken as of {frames}")
    if given and any(servo.sign < 0 for servo in given.values()):
        cli.notice(message("mirrored"))
    commands = source.commands(rate)
    write(out, kind, source, commands, table)
    if kind in ("header", "dynamixel") and table.assumed:
        named = source.run.scenario.robot
        own = Path(named).name if Path(options.scenario).is_dir() else named  # no copy
        cli.notice(message("assumed", on=command("calibrate", own)))
    made = source.servo.kind
    if kind == "dynamixel" and made and made.signal == "pulse" and given is None:
        cli.notice(message("on_pulses"))
    finest = max(channel.counts_per_radian for channel in table.channels)
    coarse = 1 / finest if kind in ("header", "dynamixel") else 0.0
    return commands, read(out, kind, table), coarse
