"""The command line of all commands, and its refusals, which suggest what was meant."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import NoReturn

from planner.support import did_you_mean
from sim.commands.declared import COMMANDS, declare
from sim.commands.options import report
from sim.errors import UsageError

DESCRIPTION = "Plan how a legged robot walks from its equations, and walk it in MuJoCo."
EPILOG = (
    "stratawalk help COMMAND explains a command; docs/glossary.md defines the terms."
)
OPTIONS = ("-h", "--help", "--version")  # that need no command
SAME = {"version": "--version", "-V": "--version"}
HINTS = {  # first guesses that are no command, and what does it
    "list": "stratawalk robots, stratawalk systems or stratawalk scenarios",
    "robot": "stratawalk robots",
    "init": "stratawalk adopt ROBOT.urdf",
    "import": "stratawalk adopt ROBOT.urdf",
    **dict.fromkeys(("walk", "simulate", "start", "demo"), "stratawalk run line"),
    **dict.fromkeys(("video", "render", "record"), "stratawalk film"),
    **dict.fromkeys(("report", "open", "results"), "stratawalk show"),
    **dict.fromkeys(("install", "info", "status"), "stratawalk doctor"),
    **dict.fromkeys(("plot", "draw"), "stratawalk show, or stratawalk figures"),
    **dict.fromkeys(("explain", "man"), "stratawalk help run"),
    **dict.fromkeys(("servo", "servos"), "stratawalk run line --set servo=mg996r"),
    **dict.fromkeys(
        ("bracket", "brackets", "teach", "notebook"),
        "stratawalk plan unicycle, or stratawalk figures --only panels",
    ),
}
CALLED = {"bracket": "panels"}  # other words for a choice
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
        for begun in getattr(given, "set", ()):
            if "=[" in begun and "]" not in begun:
                remedy = "put quotes around a list: --set 'path.goal=[0, 0.05, 0]'"
                raise UsageError(f"{begun} is not closed", "--set", remedy)
        own = [name for action in self._actions for name in action.option_strings]
        for place, word in enumerate(rest):
            if word.startswith("--"):
                if "--set" in own:
                    _name_setting(word, rest[place + 1 :], self.prog)
                _refuse_option(word, self.prog, [o for o in own if o[:2] == "--"])
        return given, rest

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Refuse what is none of a few words, and say which was meant."""
        if action.choices is not None and value not in action.choices:
            named = action.option_strings or [action.dest.upper()]
            called = CALLED.get(str(value), str(value))
            near = did_you_mean(called, list(map(str, action.choices)))
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
    for name, declared in COMMANDS.items():
        declare(
            commands.add_parser(name, help=declared["help"], allow_abbrev=False), name
        )
    return stratawalk


def as_meant(words: Sequence[str]) -> list[str]:
    """A command line with its first guesses put right: nothing at all, and `help`."""
    if not words:
        return ["--help"]
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError:  # a name from a file system, of another encoding
            raise UsageError(f"{word!r} is not UTF-8", PLACE, "rename it") from None
    first, *rest = words
    first = SAME.get(first, first)
    if first in HINTS:
        raise UsageError(f"unknown command {first!r}", PLACE, f"try {HINTS[first]}")
    if first == "help":
        return as_meant([*rest[:1], "--help"])
    if first.startswith("-") and first not in OPTIONS:
        _refuse_option(first, "stratawalk", OPTIONS[1:])
    if not first.startswith("-") and first not in COMMANDS:
        near = did_you_mean(first, [*COMMANDS, "help"])
        raise UsageError(f"unknown command {first!r}", PLACE, near)
    return [first, *rest]


def _name_setting(word: str, rest: Sequence[str], where: str) -> None:
    """Refuse an option that is a setting, and say how it is set."""
    from sim.scenarios.settings import SETTINGS

    option, equals, value = word.partition("=")
    name = option.removeprefix("--").replace("-", "_")
    if name in SETTINGS or name == "goal":
        given = value if equals else " ".join(rest[:1]) or "VALUE"
        key = f"{name}={given}" if name in SETTINGS else "'path.goal=[0.1, 0, 0]'"
        raise UsageError(f"unknown option {option}", where, f"write --set {key}")


def _refuse_option(word: str, where: str, known: Sequence[str]) -> NoReturn:
    option = word.partition("=")[0]
    raise UsageError(f"unknown option {option}", where, did_you_mean(option, known))


def completion(options: argparse.Namespace) -> None:
    """Print the script; `shtab` writes it from our parser."""
    import shtab

    from models import SYSTEMS, shipped_robots
    from sim.scenarios.file import shipped_scenarios

    robots, shell, commands = shipped_robots(), options.shell, parser()
    shipped = {"SCENARIO": shipped_scenarios(), "SYSTEM": tuple(SYSTEMS)}
    _name_what_is_shipped(commands, shipped | {"ROBOT": robots, "NAME": robots})
    script = shtab.complete(commands, shell)
    report(options, {"shell": shell, "script": script}, script)


def _name_what_is_shipped(
    parser: argparse.ArgumentParser, known: dict[str, tuple[str, ...]]
) -> None:
    """Names and files where robots, scenarios and systems are asked for."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for own in action.choices.values():
                _name_what_is_shipped(own, known)
        kinds = str(action.metavar).partition("|")
        names = [name for kind in kinds for name in known.get(kind, ())]
        if names:
            action.choices = names  # of this parser alone, which reads no words
