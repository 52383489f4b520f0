"""The command `stratawalk`: parses, dispatches, and ends with one line and a code.

What a command does is in `sim.commands`.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import traceback
from collections.abc import Sequence
from importlib import import_module
from typing import Any, NoReturn

from sim.errors import ExitCode, Terminated, UsageError, exit_code, one_line
from sim.pictures import gl

COMMANDS = (
    "run",
    "plan",
    "check",
    "identify",
    "figures",
    "robots",
    "systems",
    "scenarios",
    "bench",
)
DESCRIPTION = "Plan how a legged robot walks from its equations, and walk it in MuJoCo."


class Parser(argparse.ArgumentParser):
    """A parser whose refusals are like all others: one line, no usage block."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing and exiting.

        Raises:
            UsageError: Always.
        """
        raise UsageError(message, "the command line", f"see {self.prog} --help")


class Version(argparse.Action):
    """Print the version of the package that is installed, and end."""

    def __call__(self, parser: argparse.ArgumentParser, *rest: Any) -> NoReturn:
        """Print it; the package's metadata are read no earlier than this."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('stratawalk')}")
        parser.exit()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        arguments: Words of the command line; None takes those of the process.

    Returns:
        Exit code, `errors.ExitCode`.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    signal.signal(signal.SIGTERM, _terminate)
    # Shells start background jobs deaf to SIGINT; whoever sends it to us means it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    gl.choose()
    try:
        code = _execute(words)
        print(end="", flush=True)  # a reader that left must be noticed here
    except (Exception, KeyboardInterrupt, Terminated) as error:
        return _fail(error, words)
    return code


def _execute(words: Sequence[str]) -> int:
    try:
        options = parser().parse_args(words)
    except SystemExit as finished:  # --help
        return int(finished.code or ExitCode.OK)
    return int(options.execute(options) or ExitCode.OK)


def parser() -> Parser:
    """The command line of every command."""
    stratawalk = Parser("stratawalk", description=DESCRIPTION, allow_abbrev=False)
    stratawalk.add_argument(
        "--version", action=Version, nargs=0, help="print the version and end"
    )
    commands = stratawalk.add_subparsers(metavar="COMMAND", required=True)
    for name in COMMANDS:
        module = import_module(f"sim.commands.{name}")
        command = commands.add_parser(
            name, help=module.HELP, description=module.HELP, allow_abbrev=False
        )
        module.add_arguments(command)
        command.add_argument("--json", action="store_true", help="print JSON alone")
        command.add_argument(
            "--debug", action="store_true", help="show the traceback of an error"
        )
        command.set_defaults(execute=module.execute)
    return stratawalk


def _terminate(number: int, frame: object) -> NoReturn:
    raise Terminated


def _fail(error: BaseException, words: Sequence[str]) -> int:
    """Report an error as the command line asked for; its exit code."""
    code = exit_code(error)
    if code is ExitCode.BROKEN_PIPE:
        _silence_output()
        return code
    if "--debug" in words:
        traceback.print_exception(error)
    print(f"stratawalk: error: {one_line(error)}", file=sys.stderr)
    if "--json" in words:
        print(json.dumps({"error": _facts(code, error)}))
    return code


def _facts(code: ExitCode, error: BaseException) -> dict[str, object]:
    kind = code.name.lower()
    return {"exit_code": int(code), "kind": kind, "message": one_line(error)}


def _silence_output() -> None:
    """Keep Python from complaining again when it flushes standard output at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
