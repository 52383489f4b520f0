"""`stratawalk calibrate`: find a robot's servos one at a time, and write its card."""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext, redirect_stdout, suppress
from dataclasses import replace
from math import degrees
from pathlib import Path
from typing import TypeVar

from models import JointServo, Kinematics, Robot, ServoKind, description, load
from planner.support import read_file, read_text, unfinished
from sim.commands import options as cli
from sim.commands.declared import real, whole as counted
from sim.endings import again, command, keeping, way_on
from sim.errors import RenderError, UsageError, printable
from sim.export import calibration
from sim.export.header import write_header
from sim.export.servo_table import BUS_NUMBERS, servo_table
from sim.export.source import write_table
from sim.folder import RunFolder, alone_in, ensure_folder, require_free, whole
from sim.templates import render

BOARD_CHANNELS = range(16)
MEGAHERTZ = 1e6  # [Hz]
MOST_MISTAKES = 100  # of a person at one question; a pipe may hold any number
T = TypeVar("T")
OUT = "calibration"  # the folder that files go to where none is named
SKETCH, SCRIPT, PAGE, SHEET = "jog.ino", "bus.py", "index.html", "feet.svg"


def calibrate(options: argparse.Namespace) -> None:
    """Ask for what is not known yet, and write the card; or write strokes to check."""
    robot = cli.robot_of(options, options.robot)
    folder = RunFolder(ensure_folder(out := Path(options.out)))
    there = {path.name for path in out.iterdir()}
    ours = any(names <= there for names in ({SKETCH}, {SCRIPT}, {PAGE, SHEET}))
    for name in [PAGE, SHEET] * (not ours and not options.check):
        require_free(out / name, "--out")
    robot = _owned(robot, folder, options)
    kind = _kind(robot)
    if options.check:
        facts = _check(robot, kind, folder)
    else:
        ask = _Asker(options.answers)
        _prepare(robot, kind, folder, options)
        with redirect_stdout(sys.stderr) if options.json else nullcontext():
            facts = _calibrated(robot, kind, folder, ask)
    cli.report(options, facts, *(f"{name:13}{value}" for name, value in facts.items()))


def _kind(robot: Robot) -> ServoKind:
    card = robot.card.servo
    if card is not None and card.made:
        return description.servo_of(card.made, card.data)
    cli.notice(f"{robot} names no make of servo; pulses of 500 to 2500 us are assumed")
    return description.KNOWN_SERVOS["pulse"]


def _prepare(
    robot: Robot, kind: ServoKind, folder: RunFolder, options: argparse.Namespace
) -> None:
    """Write what jogs the servos, and the page with the pictures of the joints."""
    tool = SKETCH if kind.signal == "pulse" else SCRIPT
    rate = description.board_rate(kind.command_rate)
    text = render(
        tool.replace(".py", ".txt"),
        CLOCK=f"{description.BOARD_CLOCK:.0f}",
        RATE=f"{rate:.6f}",
        DIVIDER=description.board_divider(kind.command_rate),
        MIDDLE=kind.at_rate(rate).center,
        JOG=20,  # counts
    )
    joints, hinge = robot.card.joints, Kinematics(robot).hinge
    rows = [(j, *map(degrees, calibration.marks(robot, j)), *hinge(j)) for j in joints]
    page = render("calibration.html", title=f"Calibration of {robot}", rows=rows)
    _write(folder, PAGE, page)
    _write(folder, SHEET, calibration.sheet(robot))
    try:
        _write(folder, tool, f"{text}\n")
    except UsageError:  # an owner has begun with it
        path = folder.path / tool
        there, frame = read_file(path).decode(errors="replace"), f"RATE = {rate:.6f};"
        if frame in text and frame not in there:
            raise UsageError.of("other_frames", path, frame=frame) from None
        cli.notice(f"{path} stays; remove it to have it written anew")
    if (folder.path / f"joint-{len(rows)}.png").exists():  # the last one
        return
    with cli.working(options, "drawing the joints"):
        try:
            calibration.draw(robot, folder.path, allow_external=options.allow_external)
        except RenderError as error:
            cli.notice(str(error), "warning")


def _write(folder: RunFolder, name: str, text: str, known: int | None = None) -> None:
    """Write a file, only over one of the same text, or as many `known` first lines."""
    path, same = folder.path / name, False
    with suppress(OSError):
        there = read_file(path).decode(errors="replace")
        same = there.split("\n")[:known] == text.split("\n")[:known]
    if not same:
        require_free(path, "--out")
    folder.write_text(name, text)


def _owned(robot: Robot, folder: RunFolder, options: argparse.Namespace) -> Robot:
    """The robot whose card is written: a copy in the folder of one that is shipped."""
    source, card = robot.path, robot.path.with_suffix(".toml").resolve()
    if robot.has_card_inside and not options.check:
        remedy = f"move it to {source.with_suffix('.toml')}; then go on: {again()}"
        raise UsageError("the card is inside the robot's file", str(source), remedy)
    if (card.parent.parent / "summary.json").exists() and not options.check:
        raise UsageError.of("of_a_run", source, name=source.name)
    if not card.parent.samefile(description.FOLDER):
        return robot
    own = folder.path / source.name
    if not own.exists():
        require_free(own.with_suffix(".toml"), "--out")
        spec = robot.read()
        spec.compile()
        folder.write_text(own.with_suffix(".toml").name, robot.card_text)
        with unfinished(own.with_suffix(".toml")):
            folder.write_text(own.name, spec.to_xml())
    return load(str(own), allow_external=options.allow_external)


def _calibrated(
    robot: Robot, kind: ServoKind, folder: RunFolder, ask: "_Asker"
) -> Mapping[str, str]:
    """Ask for every servo that the card does not have, and write it at once."""
    card, number = robot.card, len(robot.card.joints)
    file = robot.path.with_suffix(".toml")
    known, pulse = dict(card.mounted), kind.signal == "pulse"
    board = description.parse_toml(robot.card_text).get("board", {})
    clock = card.board_clock if "clock" in board else None
    calibration.require_room(robot, pulse)
    free = {*BOARD_CHANNELS} - {servo.channel for servo in known.values()}
    if pulse and number - len(known) > len(free):
        raise UsageError.of("channels", file, left=number - len(known), free=len(free))

    def kept() -> str:
        used = "" if ask.is_asked else "leave out the answers that it has; "
        return f"{file} keeps {len(known)} of {number} servos; {used}go on: {again()}"

    with keeping(kept):
        if len(known) < number:
            tool, page = (folder.path / n for n in (SKETCH if pulse else SCRIPT, PAGE))
            start = "load" if pulse else "start"
            how = f"{start} {tool} and open {page}; Ctrl-C keeps all answers"
            print(printable(how))
        if pulse and not known and clock is None:
            clock = _clock(ask)
        rate, assumed = kind.command_rate, clock or description.BOARD_CLOCK
        divider = card.board_divider or pulse * description.board_divider(rate, assumed)
        for joint, servo in _found(robot, kind, known, divider, ask):
            known = _mounted(file, joint, servo, clock, divider)
    out = [] if folder.path == Path(OUT) else ["--out", folder.path]
    check = command("calibrate", robot.path, "--check", *out)
    return {"card": f"{file}, {len(known)} servos", "next": check}


def _mounted(
    file: Path, joint: str, servo: JointServo, clock: float | None, divider: int
) -> dict[str, JointServo]:
    """Add a servo to a card, which others may have changed; all that it has then."""
    with alone_in(file.resolve().parent):  # the card may be a link
        text = description.card_text(file)
        there = description.parse_card(text, str(file))
        taken = {one.channel for one in there.mounted.values()}
        if servo.channel in taken or joint in there.mounted:
            raise UsageError.of("other_channel", file, joint=joint, on=again())
        limits = there.joint_servos.get(joint, JointServo()).limits
        servos = {**there.joint_servos, joint: replace(servo, limits=limits)}
        if "clock" in description.parse_toml(text).get("board", {}):
            clock = there.board_clock
        with whole(file.resolve()) as part:
            text = calibration.card_with(text, servos, clock, divider)
            part.write_text(text, "utf-8")
    return {**there.mounted, joint: servo}


def _clock(ask: "_Asker") -> float | None:
    """The board's clock [Hz]; None where it is not measured."""

    def read(text: str) -> float | None:
        low, high = (clock / MEGAHERTZ for clock in description.CLOCKS)
        if text and not low <= real(text, "a clock", 25) <= high:
            raise ValueError(f"a clock is from {low:g} to {high:g} MHz, not {text}")
        return MEGAHERTZ * float(text) if text else None

    return ask("clock of the board, as k prints it [MHz; empty: unknown]: ", read)


def _found(
    robot: Robot,
    kind: ServoKind,
    known: Mapping[str, JointServo],
    divider: int,
    ask: "_Asker",
) -> Iterator[tuple[str, JointServo]]:
    """Servos of joints, channel after channel, until every joint has one."""
    taken = {servo.channel for servo in known.values()}
    left = [joint for joint in robot.card.joints if joint not in known]
    channels = BOARD_CHANNELS if kind.signal == "pulse" else BUS_NUMBERS

    def which(text: str) -> str:
        if text not in (*left, "-"):
            raise ValueError(f"no joint {text!r}; left are {', '.join(left)}")
        return text

    def servo(joint: str, channel: int) -> JointServo:
        angles = calibration.marks(robot, joint)
        while True:
            turned = ask("  as counts grew, did it turn to mark 2 (+) or 1 (-)? ", str)
            one, two = (
                ask(f"  count at mark {mark}, {degrees(angle):.1f} degrees: ", counted)
                for mark, angle in enumerate(angles, start=1)
            )
            try:
                return calibration.joint_servo(
                    kind, divider, channel, turned, (one, two), angles
                )
            except ValueError as error:
                ask.refuse(error)

    for channel in channels:
        if channel in taken or not left:
            continue
        jog = f"j {channel}" if kind.signal == "pulse" else f"j {channel} {kind.center}"
        joint = ask(f"channel {channel}: joint moved by {jog} (-: none)? ", which)
        if joint != "-":
            yield joint, servo(joint, channel)
            left.remove(joint)
    if left:
        where = f"channels {channels[0]} to {channels[-1]}"
        remedy = f"connect {'them' if len(left) > 1 else 'it'}; then go on: {again()}"
        raise UsageError(f"no servo was found for {', '.join(left)}", where, remedy)


class _Asker:
    """Asks on the terminal, or reads the lines of a file in place of answers."""

    def __init__(self, file: str | None) -> None:
        self._place = file or "standard input"  # which may have no end
        self._lines = iter(lambda: sys.stdin.readline(200), "")  # letters
        self.is_asked = not file and sys.stdin.isatty()  # a person, even again
        if file:
            try:
                self._lines = iter(read_text(file).splitlines())
            except (OSError, ValueError) as error:
                raise UsageError.at(file, error, "give answers, a line each") from error

    def __call__(self, question: str, read: Callable[[str], T]) -> T:
        """What is answered, as `read` has it; whom it refuses is asked again."""
        for _ in range(MOST_MISTAKES):
            try:
                answer = input(question) if self.is_asked else next(self._lines)
                return read(answer.strip())
            except (EOFError, StopIteration):
                raise UsageError("answers end", self._place, way_on()) from None
            except (ValueError, argparse.ArgumentTypeError) as error:
                self.refuse(error)
        what = f"{MOST_MISTAKES} answers to one question cannot be used"
        raise UsageError(what, self._place, way_on())

    def refuse(self, error: Exception) -> None:
        """Say why an answer cannot be used, with which those of a file end."""
        if self.is_asked:
            print(printable(f"  {error}"))
            return
        what = f"an answer that cannot be used, {error}"
        raise UsageError(what, self._place, way_on())


def _check(robot: Robot, kind: ServoKind, folder: RunFolder) -> Mapping[str, str]:
    """Write three strokes for the servos that the card has."""
    card = robot.card
    if missing := [joint for joint in card.joints if joint not in card.mounted]:
        facts = {"joint": missing[0], "find": command("calibrate", robot.path)}
        raise UsageError.of("no_servo", "the robot's card", **facts)
    if (folder.path / SHEET).exists():  # which has the rings of this robot's feet
        _write(folder, SHEET, calibration.sheet(robot))
    pulse = kind.signal == "pulse"
    commands, facts = calibration.strokes(robot, kind.command_rate)
    table = servo_table(card, card.joints, kind, pulse, rate=kind.command_rate)
    if pulse:
        name, title, how = "check.h", "Strokes to check", "a sketch inside plays it"
        text = write_header(commands, table, title=title, name="check", file=name)
    else:
        name, text = "check.csv", write_table(commands, table)
        numbers = ",".join(str(servo.channel) for servo in table.channels)
        how = f"play it with python {SCRIPT} MAKE PORT {name} {numbers}"
    _write(folder, name, text, known=1)
    return {"file": f"{folder.path / name}; {how}"} | facts
