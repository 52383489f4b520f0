"""`stratawalk calibrate`: find a robot's servos one at a time, and write its card."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext, redirect_stdout
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from sim.commands.options import notice, option, robot_of, robot_options
from sim.endings import again, keeping, way_on
from sim.errors import RenderError, UsageError

if TYPE_CHECKING:
    from models import JointServo, Robot, ServoKind

HELP = "find the servos of a robot one at a time, and write them into its card"
BOARD_CHANNELS, BUS_NUMBERS = range(16), range(1, 254)
MEGAHERTZ = 1e6  # [Hz]
JOG = 20  # counts
NONE = "-"
T = TypeVar("T")
SKETCH, SCRIPT, PAGE, SHEET = "jog.ino", "bus.py", "index.html", "feet.svg"
OPTIONS = (
    *robot_options("the robot that is to be calibrated"),
    option(
        "--out",
        metavar="FOLDER",
        default="calibration",
        help="folder of sketch and pictures; calibration if left out",
    ),
    option("--answers", metavar="FILE", help="read answers, a line each, from a file"),
    option(
        "--check",
        action="store_true",
        help="write three strokes that show what is wrong, for servos that are found",
    ),
)


def execute(options: argparse.Namespace) -> None:
    """Ask for what is not known yet, and write the card; or write strokes to check."""
    from sim.folder import ensure_folder

    robot = robot_of(options, options.robot)
    kind = _kind(robot)
    folder = ensure_folder(Path(options.out))
    if options.check:
        told = _check(robot, kind, folder)
    else:
        robot = _owned(robot, folder, options)
        _prepare(robot, kind, folder, options)
        with redirect_stdout(sys.stderr) if options.json else nullcontext():
            told = _calibrated(robot, kind, folder, options)
    lines = (f"{name:13}{value}" for name, value in told.items())
    print(json.dumps(told) if options.json else "\n".join(lines))


def _kind(robot: Robot) -> ServoKind:
    from models.description import KNOWN_SERVOS

    card = robot.card.servo
    if card is not None and card.made:
        return KNOWN_SERVOS[card.made.lower()].with_numbers(card.data)
    notice(f"{robot} names no make of servo; pulses of 500 to 2500 us are assumed")
    return KNOWN_SERVOS["pulse"]


def _prepare(
    robot: Robot, kind: ServoKind, folder: Path, options: argparse.Namespace
) -> None:
    """Write what jogs the servos, and the page with the pictures of the joints."""
    from importlib.resources import files

    from models.description import BOARD_CLOCK, board_divider, board_rate
    from sim.export.calibration import marks
    from sim.export.joint_pictures import draw, sheet
    from sim.folder import RunFolder
    from sim.progress import bar, stage
    from sim.reports.templates import render

    tool = SKETCH if kind.signal == "pulse" else SCRIPT
    text = files("sim.export").joinpath(tool.replace(".py", ".txt")).read_text()
    rate = kind.command_rate
    numbers = {
        "@CLOCK@": f"{BOARD_CLOCK:.0f}",
        "@RATE@": f"{board_rate(rate):.6f}",
        "@DIVIDER@": str(board_divider(rate)),
        "@MIDDLE@": str(kind.at_rate(board_rate(rate)).center),
        "@JOG@": str(JOG),
    }
    for name, value in numbers.items():
        text = text.replace(name, value)
    out, joints = RunFolder(folder), robot.card.joints
    out.write_text(tool, text)
    if (folder / PAGE).exists():
        return
    with bar(quiet=options.json) as progress, stage(progress, "drawing the joints"):
        sheet(robot, folder / SHEET)
        try:
            draw(robot, folder, allow_external=options.allow_external)
        except RenderError as error:
            notice(str(error), "warning")
    rows = [(joint, *map(degrees, marks(robot, joint))) for joint in joints]
    page = render("calibration.html", title=f"Calibration of {robot}", rows=rows)
    out.write_text(PAGE, page)


def _owned(robot: Robot, folder: Path, options: argparse.Namespace) -> Robot:
    """The robot whose card is written: a copy in the folder of one that is shipped."""
    from models import load
    from models.description import FOLDER
    from sim.folder import RunFolder

    source = robot.path
    if robot.has_card_inside:
        remedy = f"move it to {source.with_suffix('.toml')}, and go on: {again()}"
        raise UsageError("the card is inside the robot's file", str(source), remedy)
    if source.parent != FOLDER:
        return robot
    own = folder / source.name
    if not own.exists():
        spec = robot.read()
        spec.compile()
        RunFolder(folder).write_text(own.with_suffix(".toml").name, robot.card_text)
        RunFolder(folder).write_text(own.name, spec.to_xml())
    return load(str(own), allow_external=options.allow_external)


def _calibrated(
    robot: Robot, kind: ServoKind, folder: Path, options: argparse.Namespace
) -> Mapping[str, str]:
    """Ask for every servo that the card does not have, and write it at once."""
    from sim.export.calibration import card_with
    from sim.folder import whole

    card, file = robot.card, robot.path.with_suffix(".toml")
    known, pulse = dict(card.joint_servos), kind.signal == "pulse"
    clock = card.board_clock if "[board]" in robot.card_text else None
    ask = _Asker(Path(options.answers) if options.answers else None)

    def kept() -> str:
        return (
            f"{file} keeps {len(known)} of {len(card.joints)} servos, go on: {again()}"
        )

    with keeping(kept):
        if len(known) < len(card.joints):
            tool = folder / (SKETCH if pulse else SCRIPT)
            print(f"start {tool} and open {folder / PAGE}; Ctrl-C keeps what is told")
        if pulse and not known and clock is None:
            clock = _clock(ask)
        for joint, servo in _found(robot, kind, known, clock, ask):
            known[joint] = servo
            with whole(file) as part:
                part.write_text(card_with(robot.card_text, known, clock))
    check = f"stratawalk calibrate {robot.path} --check"
    return {"card": f"{file}, {len(known)} servos", "next": check}


def _clock(ask: _Asker) -> float | None:
    """The board's clock [Hz]; None where it is not measured."""
    from models.description import CLOCKS

    def read(text: str) -> float | None:
        clock, (low, high) = MEGAHERTZ * float(text) if text else None, CLOCKS
        if clock and not low <= clock <= high:
            raise ValueError(f"a clock is from {low:g} to {high:g} Hz, not {clock:g}")
        return clock

    return ask("clock of the board, k in the sketch [MHz, or nothing]: ", read)


def _found(
    robot: Robot,
    kind: ServoKind,
    known: Mapping[str, JointServo],
    clock: float | None,
    ask: _Asker,
) -> Iterator[tuple[str, JointServo]]:
    """Servos of joints, channel after channel, until every joint has one."""
    from models.description import BOARD_CLOCK
    from sim.export.calibration import joint_servo, marks

    taken = {servo.channel for servo in known.values()}
    left = [joint for joint in robot.card.joints if joint not in known]
    channels = BOARD_CHANNELS if kind.signal == "pulse" else BUS_NUMBERS

    def which(text: str) -> str:
        if text not in (*left, NONE):
            raise ValueError(f"no joint {text!r}; left are {', '.join(left)}")
        return text

    def servo(joint: str, channel: int) -> JointServo:
        angles = marks(robot, joint)
        turned = ask("  from mark 1 to mark 2 as counts grew (+), or back (-)? ", str)
        first, second = (
            ask(f"  count at mark {number}, {degrees(angle):.1f} degrees: ", int)
            for number, angle in enumerate(angles, start=1)
        )
        try:
            return joint_servo(
                kind, clock or BOARD_CLOCK, channel, turned, (first, second), angles
            )
        except ValueError as error:
            print(f"  {error}")
            return servo(joint, channel)

    for channel in channels:
        if channel in taken or not left:
            continue
        joint = ask(f"channel {channel}, j {channel}: which joint moved? ", which)
        if joint != NONE:
            yield joint, servo(joint, channel)
            left.remove(joint)
    if left:
        raise UsageError(
            f"no servo was found for {', '.join(left)}",
            f"channels {channels[0]} to {channels[-1]}",
            f"connect {'them' if len(left) > 1 else 'it'}, and go on: {again()}",
        )


class _Asker:
    """Asks on the terminal, or reads the lines of a file in place of answers."""

    def __init__(self, file: Path | None) -> None:
        self._place = "standard input" if file is None else str(file)
        try:
            self._lines = None if file is None else iter(file.read_text().splitlines())
        except (OSError, UnicodeDecodeError) as error:
            remedy = "give a file of answers, a line each"
            raise UsageError.at(self._place, error, remedy) from error

    def __call__(self, question: str, read: Callable[[str], T]) -> T:
        """What is answered, as `read` has it, which may refuse: asked once more."""
        while True:
            try:
                told = input(question) if self._lines is None else next(self._lines)
                return read(told.strip())
            except (EOFError, StopIteration):
                raise UsageError("answers end", self._place, way_on()) from None
            except ValueError as error:
                print(f"  {error}")


def _check(robot: Robot, kind: ServoKind, folder: Path) -> Mapping[str, str]:
    """Write three strokes for the servos that the card has."""
    from sim.export.calibration import strokes
    from sim.export.files import write_ticks
    from sim.export.header import write_header
    from sim.export.servo_table import servo_table
    from sim.folder import RunFolder

    card = robot.card
    if missing := [joint for joint in card.joints if joint not in card.joint_servos]:
        raise UsageError(
            f"no servo for joint {missing[0]!r}",
            "the robot's card",
            f"find them first: stratawalk calibrate {robot.path}",
        )
    pulse = kind.signal == "pulse"
    commands, told = strokes(robot, kind.command_rate)
    table = servo_table(card, card.joints, kind, pulse, rate=kind.command_rate)
    name, text = "check.csv", ""
    if pulse:
        name, title = "check.h", "Strokes to check"
        text = write_header(commands, table, title=title, name="check", file=name)
    text = text or write_ticks(commands, table)
    RunFolder(folder).write_text(name, text)
    numbers = ",".join(str(servo.channel) for servo in table.channels)
    how = f"play it with python {SCRIPT} MAKE PORT {name} {numbers}"
    how = "its comment has the player" if pulse else how
    return {"file": f"{folder / name}; {how}"} | told
