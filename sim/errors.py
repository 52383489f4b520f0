"""Errors of the testbed, and the exit code with which each one ends the command.

Every error is one line, `what: where; what to do`. This module alone assigns exit
codes to the errors of `planner` and `models`.
"""

import errno
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar, Self

from models import MeasurementError, ModelError, ProblemError, UnknownRobotError
from planner import PlannerError
from planner.support import sentences
from sim.endings import ENDS, ExitCode as ExitCode, kept_work, way_on
from sim.interruption import HungUp, OutOfTime, Terminated

LONGEST_MESSAGE = 1000  # characters of a line; what is left out is in its middle
ROOT = Path(__file__).resolve().parent.parent
LAYERS = ("planner", "models", "sim")

message = sentences("sim", "refusals.toml")


class StratawalkError(Exception):
    """An error of one line; the root of this package's errors.

    Example:
        >>> from sim import RenderError, StratawalkError
        >>> issubclass(RenderError, StratawalkError)
        True
    """

    exit_code: ClassVar[ExitCode]

    def __init__(self, what: str, where: str, remedy: str) -> None:
        """Say what is wrong, with its value; the file, option or time; what to do."""
        self.what, self.where, self.remedy = what, where, remedy
        super().__init__(f"{what}: {where}; {remedy}".removesuffix("; "))

    @classmethod
    def at(cls, where: str, error: Exception, remedy: str = "") -> Self:
        """What a function says of its arguments, which come from a place.

        It says `what; what to do`, or without the latter the remedy is taken.
        """
        what, _, advice = str(getattr(error, "strerror", 0) or error).partition("; ")
        return cls(what, where, advice or remedy)

    @classmethod
    def of(cls, sentence: str, where: object, /, **facts: object) -> Self:
        """What `refusals.toml` says of a place, which is `what; what to do`."""
        what, _, remedy = message(sentence, **facts).rpartition("; ")
        return cls(what, str(where), remedy)

    def __reduce__(self) -> tuple[object, ...]:
        """Travel between processes, although an error is made from three texts."""
        return Exception.__new__, (type(self), *self.args), self.__dict__


class UsageError(StratawalkError, ValueError):
    """A command line, scenario or setting that asks for the impossible.

    Example:
        >>> from sim import load_scenario
        >>> load_scenario("line", {"friction": -1.0})
        Traceback (most recent call last):
        sim.errors.UsageError: friction = -1.0 is not allowed: ...
    """

    exit_code = ExitCode.USAGE


class SimulationError(StratawalkError):
    """Physics that diverged, or a plan that the robot cannot carry out.

    Example:
        >>> from sim import SimulationError
        >>> print(SimulationError("the physics diverged", "t = 1.2 s", "step less"))
        the physics diverged: t = 1.2 s; step less
    """

    exit_code = ExitCode.SIMULATION

    def __init__(self, what: str, where: str, remedy: str, setting: str = "") -> None:
        """As every error; and the setting KEY=VALUE that would do, if one is known."""
        self.setting = setting
        super().__init__(what, where, remedy)


class RenderError(StratawalkError):
    """No way to draw or to encode pictures on this machine.

    Example:
        >>> from sim import RenderError
        >>> print(RenderError("no driver", "MUJOCO_GL=egl", "install libegl1"))
        no driver: MUJOCO_GL=egl; install libegl1
    """

    exit_code = ExitCode.RENDER


class FilesError(StratawalkError):
    """A folder that cannot be written, or a disk that is full.

    Example:
        >>> from sim import FilesError
        >>> error = FilesError("the disk is full", "runs/line-001", "make room")
        >>> int(error.exit_code)
        6
    """

    exit_code = ExitCode.FILES


@contextmanager
def telling(
    what: str, where: object, remedy: str, kind: type[StratawalkError] = FilesError
) -> Iterator[None]:
    """Say what the system refuses, and why: `what, its reason: where; remedy`."""
    try:
        yield
    except OSError as error:
        raise kind(f"{what}, {error.strerror}", str(where), remedy) from error


class SweepError(StratawalkError):
    """A sweep whose points could not all be walked."""

    exit_code = ExitCode.SWEEP


_EXIT_CODES: dict[type[BaseException], ExitCode] = {
    UnknownRobotError: ExitCode.USAGE,
    ProblemError: ExitCode.USAGE,
    ModelError: ExitCode.MODEL,
    PlannerError: ExitCode.SIMULATION,
    MeasurementError: ExitCode.SIMULATION,
    Terminated: ExitCode.TERMINATED,  # before what they are kinds of
    HungUp: ExitCode.HUNG_UP,
    OutOfTime: ExitCode.OUT_OF_TIME,
    KeyboardInterrupt: ExitCode.INTERRUPTED,
    OSError: ExitCode.FILES,
    MemoryError: ExitCode.SIMULATION,
}

_SIGNALS = dict(ENDS.values())  # what ended the command, by its exit code
FULL = (errno.ENOSPC, errno.EDQUOT)  # of a disk
_GO_ON = (ExitCode.FILES, ExitCode.SWEEP)  # after which kept work goes on


def exit_code(error: BaseException) -> ExitCode:
    """The exit code an error ends the command with; the unforeseen is a bug."""
    if isinstance(error, StratawalkError):
        return error.exit_code
    codes = (code for kind, code in _EXIT_CODES.items() if isinstance(error, kind))
    return next(codes, ExitCode.BUG)


def last_words(error: BaseException) -> str:
    """What the command says as it ends with an error, and how to go on where it can."""
    code = exit_code(error)
    ended = code in _SIGNALS or (isinstance(error, OSError) and not error.filename)
    ended |= getattr(error.__cause__, "errno", 0) in FULL
    further = way_on() if ended else kept_work() if code in _GO_ON else ""
    return "; ".join(filter(None, (one_line(error), further)))


def is_text(value: object) -> bool:
    """Whether a value is a text without halves of characters, which no file takes."""
    return isinstance(value, str) and value.encode(errors="replace").decode() == value


def printable(text: str) -> str:
    """A text with control characters, which a terminal might obey, written out."""
    plain = {c for c in text if c.isprintable() or c in "\n\t"}
    return "".join(c if c in plain else ascii(c)[1:-1] for c in text)


def one_line(error: BaseException) -> str:
    """The error as `what: where; what to do`, on one line."""
    lines = map(str.strip, _describe(error).split("\n"))
    line = printable(" ".join(filter(None, lines)))
    if len(line) <= LONGEST_MESSAGE:
        return line
    half = LONGEST_MESSAGE // 2
    return f"{line[:half].rstrip()} ... {line[-half:].lstrip()}"


def _describe(error: BaseException) -> str:
    code = exit_code(error)
    if code is ExitCode.BUG:
        what = f"a bug of ours, {type(error).__name__}: {error}: {_place(error)}"
        return f"{what}; please report it with the output of --debug"
    if code in _SIGNALS:
        notes = "".join(f", {note}" for note in getattr(error, "__notes__", ()))
        return f"{_SIGNALS[code]}{notes}"
    if isinstance(error, OSError):
        gone = {errno.ENOENT: "the working folder", errno.ENOSPC: "standard output"}
        place = error.filename or gone.get(error.errno or 0, "no file named")
        remedy = "free some space" if error.errno == errno.ENOSPC else "check the path"
        return f"{error.strerror or error}: {place}; {remedy}"
    if isinstance(error, MemoryError):
        return "out of memory: this machine; ask for less at once"
    return f"no plan: {error}" if isinstance(error, PlannerError) else str(error)


def _place(error: BaseException) -> str:
    """The last line of our own that was running."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [f for f in frames if Path(f.filename).is_relative_to(ROOT)]
    ours = [f for f in ours if Path(f.filename).relative_to(ROOT).parts[0] in LAYERS]
    return f"{ours[-1].filename}:{ours[-1].lineno}" if ours else "outside our code"
