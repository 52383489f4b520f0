"""The command line of all commands, and its refusals, which suggest what was meant."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from typing import NoReturn

from planner.support import did_you_mean
from sim.errors import UsageError

COMMANDS = (
    "run", "show", "film", "view", "compare", "sweep", "merge", "study", "design",
    "plan", "export", "drive", "check", "identify", "figures", "robots", "adopt",
    "systems", "scenarios", "bench", "doctor", "completion",
)  # fmt: skip
MODULES = {"film": "film_run"}  # `film` is a function of the front door
DESCRIPTION = "Plan how a legged robot walks from its equations, and walk it in MuJoCo."
EPILOG = (
    "stratawalk help COMMAND explains a command; docs/glossary.md defines the terms."
)
OPTIONS = ("-h", "--help", "--version")  # that need no command
PLACE = "the command line"


class Parser(argparse.ArgumentParser):
    """A parser whose refusals are like all others: one line, no usage block."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing and exiting."""
        raise UsageError(message, PLACE, f"see {self.prog} --help")

    def parse_known_args(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        namespace: argparse.Namespace | None = None,
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse, refuse unknown options, and leave other words to other parsers."""
        given, rest = super().parse_known_args(args, namespace)
        own = [name for action in self._actions for name in action.option_strings]
        for word in rest:
            if word.startswith("--"):
                _refuse_option(word, self.prog, [o for o in own if o[:2] == "--"])
        return given, rest

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Refuse what is none of a few words, and say which was meant."""
        if action.choices is not None and value not in action.choices:
            named = action.option_strings or [action.dest.upper()]
            near = did_you_mean(str(value), list(map(str, action.choices)))
            raise UsageError(f"{value!r} is not allowed", named[-1], near)


class Version(argparse.Action):
    """Print the version of the package that is installed, and end."""

    def __call__(self, parser: argparse.ArgumentParser, *rest: object) -> NoReturn:
        """Print it; the package's metadata are read no earlier than this."""
        from importlib.metadata import version

        print(f"{parser.prog} {version('stratawalk')}")
        parser.exit()


def parser() -> Parser:
    """The command line of every command."""
    stratawalk = Parser(
        "stratawalk", description=DESCRIPTION, epilog=EPILOG, allow_abbrev=False
    )
    stratawalk.add_argument(
        "--version", action=Version, nargs=0, help="print the version and end"
    )
    commands = stratawalk.add_subparsers(metavar="COMMAND", required=True)
    for name in COMMANDS:
        module = import_module(f"sim.commands.{MODULES.get(name, name)}")
        command = commands.add_parser(
            name, help=module.HELP, description=module.HELP, allow_abbrev=False
        )
        for add_option in module.OPTIONS:
            add_option(command)
        command.epilog = getattr(module, "EPILOG", None)
        command.add_argument("--json", action="store_true", help="print JSON alone")
        command.add_argument(
            "--debug", action="store_true", help="show the traceback of an error"
        )
        command.set_defaults(execute=module.execute)
    return stratawalk


def as_meant(words: Sequence[str]) -> list[str]:
    """A command line with its first guesses put right: nothing at all, and `help`."""
    if not words:
        return ["--help"]
    first, *rest = words
    if first == "help":
        return as_meant([*rest[:1], "--help"])
    if first.startswith("-") and first not in OPTIONS:
        _refuse_option(first, "stratawalk", OPTIONS[1:])
    if not first.startswith("-") and first not in COMMANDS:
        near = did_you_mean(first, [*COMMANDS, "help"])
        raise UsageError(f"unknown command {first!r}", PLACE, near)
    return [first, *rest]


def _refuse_option(word: str, where: str, known: Sequence[str]) -> NoReturn:
    option = word.partition("=")[0]
    raise UsageError(f"unknown option {option}", where, did_you_mean(option, known))
