"""`stratawalk drive`: commands for a robot elsewhere, planned from poses it sends."""

import argparse
import json
import os
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from itertools import count, islice
from math import hypot, isfinite, nan
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import IO, TYPE_CHECKING

import numpy as np

from sim.commands import options as cli
from sim.endings import again, keeping
from sim.errors import FilesError, UsageError, message, telling
from sim.folder import require_free

if TYPE_CHECKING:
    from sim.export.served import Row, ServedWalk

LONGEST_LINE, MOST_WAITING = 10_000, 10_000  # characters of a line, waiting poses
ASTRAY = 1.0  # [m], more than the path is long, that no robot can be off its plan
AHEAD = 0.5  # [s], by which the clock of poses may be ahead of that of commands
REPLY = 0.02  # [s], for an answer to a command that is written out of real time


def drive(options: argparse.Namespace) -> None:
    """Drive the robot to the end of the scenario's path."""
    scenario = cli.scenario_of(options, stops=True)

    from sim.evaluation.causes import say
    from sim.export.served import served

    def kept() -> str:
        if not os.path.isfile(name := options.commands):
            return f"start again: {again()}"
        on = again(*cli.elsewhere(name, "--commands"))
        return f"{name} holds the commands that were sent; start again: {on}"

    with ExitStack() as files:
        poses = _opened(files, options.poses, "r", sys.stdin)
        commands = _opened(files, options.commands, "w", sys.stdout)
        files.enter_context(keeping(kept))
        link = Link(Poses(poses), commands, options.pace, options.patience)
        walk = served(scenario, cli.robot_of(options, scenario.robot))
        if not walk.setup.servo.rate:
            cli.notice(message("every_step", rate=walk.rate))
        link.send(walk, walk.stand())
        for segment in range(walk.setup.scenario.segments):
            link.send(walk, walk.walk(segment))
            stop, scenario = walk.seen(segment, link.reading(walk)), walk.setup.scenario
            x, y, yaw = stop.thought
            far = hypot(x - stop.expected[0], y - stop.expected[1])
            if far > ASTRAY + scenario.path.length:
                raise UsageError.of("astray", f"segment {segment + 1}", far=far)
            done = f"segment {segment + 1} of {scenario.segments}"
            place = f"{x:z.4f} m, {y:z.4f} m, {yaw:z.3f} rad"
            cli.notice(f"{done}: estimated at {place}", "driven")
        link.send(walk, walk.stand())
    if short := walk.scaled_down:
        facts = {"segments": scenario.segments, "twice": 2 * scenario.segments}
        cli.notice(say("scaled_down", count=short, **facts), "warning")
    if options.json and options.commands != "-":
        end = walk.stops[-1]
        print(json.dumps({"thought": end.thought, "claimed": end.claimed}))


def _opened(files: ExitStack, name: str, mode: str, standard: IO[str]) -> IO[str]:
    if name == "-":
        return standard
    if mode == "w" and (os.path.isfile(name) or not os.path.exists(name)):
        mode = "x"  # what exists must be a pipe or a device
    if Path(name).is_fifo():  # opening it waits as long as it takes to start the robot
        cli.notice(f"waiting for a program at the other end of {name}")
    with telling("cannot be opened", name, "name a file, a pipe, or -"):
        try:
            file = open(name, mode, encoding="utf-8")  # noqa: SIM115 (closed below)
        except FileExistsError:
            require_free(name, "--commands")
            raise
    files.callback(_close, file)
    return file


def _close(file: IO[str]) -> None:
    with suppress(OSError):  # that of a line which was sent has been told
        file.close()


class Poses:
    """Lines of poses, read in a thread of their own as they come."""

    def __init__(self, file: IO[str]) -> None:
        self._queue: Queue[tuple[float, list[float]] | UsageError | None] = Queue()
        self.ended = False
        Thread(target=self._listen, args=(file,), daemon=True).start()

    def _listen(self, file: IO[str]) -> None:
        for number in count(1):
            try:
                if not (line := file.readline(LONGEST_LINE)):
                    self._queue.put(None)
                    return
                pose = _pose(line) if line.strip() else None
            except Exception as error:  # whatever is sent, the command must know of it
                what = f"not a pose, {error if type(error) is ValueError else 'broken'}"
                remedy = 'write {"time": 1.0, "x": 0.0, "y": 0.0, "yaw": 0.0}'
                self._queue.put(UsageError(what, f"line {number} of --poses", remedy))
                return
            if self._queue.qsize() >= MOST_WAITING:  # nobody asks for the oldest ones
                with suppress(Empty):
                    self._queue.get_nowait()
            if pose:
                self._queue.put(pose)

    def next(self, seconds: float) -> tuple[float, list[float]] | None:
        """Time and pose of the next line within some seconds; None without one."""
        if self.ended:
            return None
        try:
            found = self._queue.get(timeout=seconds) if seconds else None
        except Empty:
            return None
        if isinstance(found, UsageError):
            raise found
        if found is None:
            self.ended = True
            cli.notice("the poses have ended; none that follows is seen", "warning")
        return found


def _pose(line: str) -> tuple[float, list[float]]:
    """Time and pose of a line; what it does not tell is NaN."""
    known = dict.fromkeys(("time", "x", "y", "yaw"), nan)
    given = json.loads(line, parse_int=float)
    if odd := given.keys() - known:
        raise ValueError(f"unknown key {min(odd)[:40]!r}")
    when, *pose = values = [nan if v is None else v for v in (known | given).values()]
    if {type(value) for value in values} != {float}:
        raise ValueError("not a number")
    if line.count(":") > len(given):
        raise ValueError("a key twice")
    if not isfinite(when) or any(abs(value) > 1e6 for value in pose):
        raise ValueError("no time, or a number not finite or beyond 1e6")
    return when, pose


@dataclass
class Link:
    """Writes commands at their times, and waits for poses."""

    poses: Poses
    commands: IO[str]
    pace: float
    patience: float
    began: float | None = None
    seen: list[tuple[float, list[float]]] = field(default_factory=list)  # of a stop

    def send(self, walk: "ServedWalk", rows: "Iterable[Row]") -> None:
        """Write commands, each when its time has come; those that are late come later.

        Otherwise a robot would leap after each pause, as of planning or a stop.
        """
        for when, angles in rows:
            if self.pace:
                now = time.monotonic()
                self.began = now if self.began is None else self.began
                late = (now - self.began) * self.pace - when
                if (missed := int(late * walk.rate)) > 0:
                    walk.skip(missed)
                    when = round(when * walk.rate + missed) / walk.rate
                time.sleep(min(max(0.0, self.began + when / self.pace - now), 1e9))
            ctrl = dict(zip(walk.joints, angles.tolist(), strict=True))
            try:
                print(json.dumps({"time": when, "ctrl": ctrl}), file=self.commands)
                self.commands.flush()
            except OSError as error:
                what, remedy = "the robot stopped listening", "start it and drive again"
                if not isinstance(error, BrokenPipeError):
                    what = f"commands cannot be sent, {error.strerror}"
                    remedy = "give --commands another name"
                raise FilesError(what, f"t = {when:.2f} s", remedy) from error

    def reading(self, walk: "ServedWalk") -> list[float]:
        """The mean of the poses of a stop, while the robot stands; NaN without any."""
        sensing, stopped = walk.feedback.sensing, walk.time
        found, self.seen = list[list[float]](), []
        due = (len(walk.stops) + 1) % sensing.every == 0
        if due and (sensing.until is None or len(walk.stops) < sensing.until):
            while len(found) < sensing.readings and not self.poses.ended:
                if walk.time > stopped + self.patience:
                    came = f"{len(found)} of {sensing.readings} poses"
                    came = f"t = {walk.time:.2f} s: {came if found else 'no pose'} came"
                    cli.notice(came, "warning")
                    break
                self.send(walk, [walk.wait()])
                since = self._since(stopped, walk.time)
                found += islice(since, sensing.readings - len(found))
        known = (column[np.isfinite(column)] for column in np.array(found).T)
        x, y, yaw = known if found else np.empty((3, 0))
        return [c.mean().item() if len(c) else nan for c in (x, y, np.unwrap(yaw))]

    def _since(self, moment: float, now: float) -> Iterator[list[float]]:
        """Poses that have come and are not older than a moment [s], each once."""
        wait, until = 1e-3 if self.pace else REPLY, time.monotonic() + 10 * REPLY
        while time.monotonic() < until and (reading := self.poses.next(wait)):
            when, pose = reading
            if when > now + AHEAD:
                raise UsageError.of("ahead", "--poses", when=when, now=now)
            if when >= moment and reading not in self.seen:
                self.seen.append(reading)
                yield pose
