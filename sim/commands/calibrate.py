"""`stratawalk calibrate`: find a robot's servos one at a time, and write its card."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext, redirect_stdout
from dataclasses import replace
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from sim.commands.options import notice, option, robot_of, robot_options
from sim.endings import again, keeping, way_on
from sim.errors import RenderError, UsageError

if TYPE_CHECKING:
    from models import Robot, ServoKind
    from sim.export.calibration import Answer, Answers

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
        help="folder of sketch, pictures and answers; calibration if left out",
    ),
    option("--answers", metavar="FILE", help="where answers are kept, and read from"),
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
    told = _check(robot, kind, folder) if options.check else None
    if told is None:
        file = Path(options.answers) if options.answers else folder / "answers.toml"
        _prepare(robot, kind, folder, options)
        asking = redirect_stdout(sys.stderr) if options.json else nullcontext()
        with asking:
            answers = _asked(robot, kind, folder, file)
        told = _written(robot, kind, folder, answers)
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


def _asked(robot: Robot, kind: ServoKind, folder: Path, file: Path) -> Answers:
    """The answers of every joint: those that are kept, and those given now."""
    from planner.support import unknown
    from sim.export.calibration import Answers, read_answers
    from sim.folder import whole

    answers = Answers({})
    if file.exists():
        try:
            answers = read_answers(file.read_text())
        except (ValueError, OSError) as error:
            remedy = "correct it, or move it away"
            raise UsageError.at(str(file), error, remedy) from error
    for joint in answers.joints.keys() - {*robot.card.joints}:
        what = f"joint {joint!r} {unknown(joint, robot.card.joints)}"
        raise UsageError(what, str(file), "give the answers of this robot")

    def kept() -> str:
        known = f"{len(answers.joints)} of {len(robot.card.joints)} joints"
        return f"{file} keeps {known}, go on: {again()}"

    tool = folder / (SKETCH if kind.signal == "pulse" else SCRIPT)
    with keeping(kept):
        if len(answers.joints) < len(robot.card.joints):
            print(f"start {tool} and open {folder / PAGE}; Ctrl-C keeps what is told")
        if not answers.joints and answers.clock is None and kind.signal == "pulse":
            answers = replace(answers, clock=_clock())
        for joint, answer in _new(robot, kind, answers):
            answers = replace(answers, joints={**answers.joints, joint: answer})
            with whole(file) as part:
                part.write_text(str(answers))
    return answers


def _clock() -> float | None:
    """The board's clock [Hz]; None where it is not measured."""
    from models.description import CLOCKS

    low, high = CLOCKS

    def read(text: str) -> float | None:
        if text and not low <= MEGAHERTZ * float(text) <= high:
            raise ValueError(f"a clock is from {low:g} to {high:g} Hz, not {text} MHz")
        return MEGAHERTZ * float(text) if text else None

    return _ask("clock of the board, k in the sketch [MHz, or nothing]: ", read)


def _new(
    robot: Robot, kind: ServoKind, answers: Answers
) -> Iterator[tuple[str, Answer]]:
    """Joints and answers, channel after channel, until every joint has its servo."""
    taken = {answer.channel for answer in answers.joints.values()}
    left = [joint for joint in robot.card.joints if joint not in answers.joints]
    channels = BOARD_CHANNELS if kind.signal == "pulse" else BUS_NUMBERS
    for channel in channels:
        if channel in taken or not left:
            continue

        def which(text: str) -> str:
            if text not in (*left, NONE):
                raise ValueError(f"no joint {text!r}; left are {', '.join(left)}")
            return text

        joint = _ask(f"channel {channel}, j {channel}: which joint moved? ", which)
        if joint != NONE:
            left.remove(joint)
            yield joint, _ask_of(robot, kind, joint, channel)
    if left:
        raise UsageError(
            f"no servo was found for {', '.join(left)}",
            f"channels {channels[0]} to {channels[-1]}",
            f"connect {'them' if len(left) > 1 else 'it'}, and go on: {again()}",
        )


def _ask_of(robot: Robot, kind: ServoKind, joint: str, channel: int) -> Answer:
    from sim.export.calibration import Answer, marks, require_likely

    first, second = marks(robot, joint)
    while True:
        turned = _ask("  from mark 1 to mark 2 as counts grew (+), or back (-)? ", str)
        counts = [
            _ask(f"  count at mark {number}, {degrees(angle):.1f} degrees: ", int)
            for number, angle in ((1, first), (2, second))
        ]
        try:
            answer = Answer(channel, turned, (counts[0], counts[1]))
            require_likely(answer, second - first, kind)
        except ValueError as error:
            print(f"  {error}")
            continue
        return answer


def _ask(question: str, read: Callable[[str], T]) -> T:
    """What is answered, as `read` makes it of the text; asked again if it refuses."""
    while True:
        try:
            return read(input(question).strip())
        except EOFError:
            raise UsageError("answers end", "standard input", way_on()) from None
        except ValueError as error:
            print(f"  {error}")


def _written(
    robot: Robot, kind: ServoKind, folder: Path, answers: Answers
) -> Mapping[str, str]:
    """Write the card; that of a shipped robot, and its file, into the folder."""
    from models.description import FOLDER, parse_card
    from sim.export.calibration import card_with
    from sim.folder import whole

    source = robot.path
    if robot.has_card_inside:
        raise UsageError(
            f"the card is inside {source}",
            str(source),
            f"move it to {source.with_suffix('.toml')}, and go on: {again()}",
        )
    if source.parent == FOLDER:
        source, spec = folder / source.name, robot.read()
        spec.compile()
        with whole(source) as part:
            part.write_text(spec.to_xml())
    card = source.with_suffix(".toml")
    text = card_with(robot.card_text, robot, answers, kind)
    parse_card(text, str(card))
    with whole(card) as part:
        part.write_text(text)
    return {
        "card": f"{card}, {len(answers.joints)} servos",
        "next": f"stratawalk calibrate {source} --check",
    }


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
