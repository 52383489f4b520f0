"""How the command ends: its exit codes, the signals that end it, and what goes on.

Every ending before the end says what is done and kept, and the command that goes on.
Work of which something is kept says so while it lasts; this module remembers it.
"""

import shlex
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from enum import IntEnum
from pathlib import Path


class ExitCode(IntEnum):
    """How the command ended."""

    OK = 0
    USAGE = 2  # bad usage or configuration
    MODEL = 3  # a robot that cannot be used
    SIMULATION = 4  # planning or simulation failed
    RENDER = 5  # pictures cannot be drawn
    FILES = 6  # disk, permissions
    TOLERANCE = 7  # a comparison came out larger than allowed
    SWEEP = 8  # a sweep ended with failed points
    BUG = 70  # ours
    HUNG_UP = 129  # SIGHUP
    INTERRUPTED = 130  # SIGINT
    TERMINATED = 143  # SIGTERM
    OUT_OF_TIME = 152  # SIGXCPU


ENDS = {  # what a message says of each signal
    signal.SIGINT: (ExitCode.INTERRUPTED, "interrupted: Ctrl-C"),
    signal.SIGTERM: (ExitCode.TERMINATED, "terminated: SIGTERM"),
    signal.SIGHUP: (ExitCode.HUNG_UP, "hung up: SIGHUP"),
    signal.SIGXCPU: (ExitCode.OUT_OF_TIME, "out of processor time: SIGXCPU"),
}
_words: list[str] = []  # of the command line
_kept: list[Callable[[], str]] = []  # what is told of unfinished work, innermost last


def heeded() -> list[signal.Signals]:
    """The signals that end the command; after `nohup` a dropped connection does not."""
    nohup = signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    return [number for number in ENDS if number != signal.SIGHUP or not nohup]


def begin(words: Sequence[str]) -> None:
    """Remember the words of a command line that is begun, and of none before it."""
    _words[:] = words
    _kept.clear()


@contextmanager
def keeping(tell: Callable[[], str]) -> Iterator[None]:
    """Work of which something is kept if it ends early: `tell` says what, and how on.

    An error leaves it in force, since its message is yet to be written.
    """
    _kept.append(tell)
    yield
    _kept.remove(tell)


def again(*more: str) -> str:
    """The command line with further words, in which an option replaces the former."""
    words, given = list[str](), iter(_words)
    options = [word for word in more if word.startswith("--")]
    for word in given:
        name, valued, _ = word.partition("=")
        takes = not valued and name in ("--set", *options)
        pair = [word, next(given, "")] if takes else [word]
        setting = pair[-1].removeprefix("--set=").partition("=")[0]
        own = f"--{setting}" if name == "--set" else name
        words += pair * (own not in options)
    end = words.index("--") if "--" in words else len(words)  # of the options
    return command(*words[:end], *more, *words[end:])


def command(*words: object) -> str:
    """A command line for a shell; paths that begin with a dash are no options in it."""
    texts = ["./" * (isinstance(w, Path) and str(w)[0] == "-") + str(w) for w in words]
    line = shlex.join(["stratawalk", *texts])  # what a terminal might obey, in quotes
    return "".join(c if c.isprintable() else rf"'$'\U{ord(c):08x}''" for c in line)


def way_on() -> str:
    """What is kept of unfinished work, and the command that goes on."""
    return kept_work() or f"written files are complete; start again: {again()}"


def kept_work() -> str:
    """As `way_on`; empty where no work has said that something is kept."""
    return _kept[-1]() if _kept else ""
