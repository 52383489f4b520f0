"""The command line as `commands.toml` declares it: commands, options, their readers."""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from math import inf
from pkgutil import resolve_name
from typing import Any, Literal

from planner.support import installing, shipped_tables
from sim.errors import LAYERS, ExitCode, UsageError
from sim.scenarios.settings import SETTINGS

Declared = Mapping[str, Any]  # options by how they are used: help, a table, or `true`
SIZES = 1e-6, 1e9  # of numbers in options

COMMANDS = shipped_tables("sim.commands", "commands.toml")  # in help's order
GUESSES = shipped_tables("sim.commands", "guesses.toml")  # with what was meant
BESIDE = "about", "shared", "every", "settings"  # the tables that declare no command
ABOUT, SHARED, EVERY, OF_SCENARIOS = map(COMMANDS.pop, BESIDE)


@dataclass(frozen=True)
class Command:
    """A command, named as the function that executes it."""

    name: str
    module: str
    extra: str  # of pyproject.toml, which has packages that it needs; empty for none

    def __call__(self, options: argparse.Namespace) -> ExitCode | None:
        """Execute it; a package that is missing is said with the extra it is of."""
        try:
            module = import_module(f"sim.commands.{self.module}")
            return getattr(module, self.name)(options)
        except ModuleNotFoundError as error:
            if not self.extra or error.name in LAYERS:
                raise
            how, where = installing(self.extra), f"the extra {self.extra!r}"
            raise UsageError.of("lacks", where, name=error.name, how=how) from error


def declare(parser: argparse.ArgumentParser, name: str) -> None:
    """Give the parser of a command its options, and what executes it."""
    declared = COMMANDS[name]
    parser.description, example = declared["help"], declared.get("example")
    parser.formatter_class = argparse.RawDescriptionHelpFormatter  # examples in a line
    parser.epilog = example and f"for example: {example}"
    if "settings" in declared:
        _add_options(parser, OF_SCENARIOS)
    for title, options in declared.items():
        if isinstance(options, dict):
            own = title == "options"
            _add_options(parser if own else parser.add_argument_group(title), options)
    _add_options(parser, EVERY)
    execute = Command(name, declared["module"], declared.get("extra", ""))
    parser.set_defaults(execute=execute)


def _add_options(to: argparse._ActionsContainer, declared: Declared) -> None:
    for usage, given in declared.items():
        given = SHARED.get(usage, {}) if given is True else given
        table = {"help": given} if isinstance(given, str) else dict(given)
        name, _, value = usage.partition(" ")
        if "help" not in table:
            table = _of_setting(name) | table
        if isinstance(table.get("choices"), str):
            table["choices"] = resolve_name(table["choices"])
        if kind := table.get("type"):
            table["type"] = _reader(kind)
        if name == "--set":
            about = table["help"].replace("{settings}", ", ".join(SETTINGS))
            table |= {"action": "append", "default": []}
            table["help"] = f"{about}; may be repeated"
        if "[no-]" in name:
            table["action"] = argparse.BooleanOptionalAction
        elif value:
            optional, several = value.startswith("["), value.endswith("...")
            table["nargs"] = "?" if optional else "+" if several else None
            table["metavar"] = value.removesuffix("...").strip("[]")
        elif "choices" not in table:
            table["action"] = "store_true"
        to.add_argument(name.replace("[no-]", ""), **table)


def _of_setting(option: str) -> dict[str, Any]:
    """An option that is a setting is as that is declared."""
    setting = SETTINGS[option.removeprefix("--").replace("-", "_")]
    if setting.includes(bool):
        return {"help": setting.about, "default": None}
    choices = f" ({setting.allowed})" if setting.includes(Literal) else ""
    kind = "int" if setting.includes(int) else "str"
    return {"help": setting.about + choices, "type": kind}


def _reader(kind: str | list[Any]) -> Callable[[str], Any]:
    """One of `READERS`; what follows its name in a list are further arguments."""
    name, *more = [kind] if isinstance(kind, str) else kind
    read = READERS[name]
    return (lambda text: read(text, *more)) if more else read


def whole(text: str, least: int = 0, most: float = inf) -> int:
    """A whole number between two, or from one on."""
    try:
        value = int(text.replace("_", "?").encode("ascii"))
    except ValueError:
        value = least - 1
    if not least <= value <= most:
        wanted = f"{least} or more" if most == inf else f"{least} to {most}"
        refusal = f"{text} is not allowed; give a whole number, {wanted}"
        raise argparse.ArgumentTypeError(refusal)
    return value


def real(text: str, what: str, example: float, zero: bool = False) -> float:
    """A positive number of no odd size; a refusal says what it is, with an example."""
    try:
        value = float(text.replace("_", "?").encode("ascii"))
    except ValueError:
        value = -1.0
    if not (SIZES[0] <= value <= SIZES[1] or (zero and value == 0)):
        refusal = f"{text} is not {what}; give a number such as {example:g}"
        raise argparse.ArgumentTypeError(refusal)
    return value


def share(text: str) -> float:
    """A share of the path; any where it is `none`."""
    return inf if text == "none" else real(text, "a share of the path", 0.05, zero=True)


def shard(text: str) -> object:
    """A part of a sweep, I/N."""
    from sim.sweeps.folder import Shard

    number, _, count = text.partition("/")
    if not (number.isdecimal() and count.isdecimal()):
        raise argparse.ArgumentTypeError(f"{text} is not I/N; give 1/4, say")
    try:
        return Shard(int(number), int(count))
    except UsageError as error:  # which argparse would take for a ValueError of its own
        raise argparse.ArgumentTypeError(f"{error.what}; {error.remedy}") from error


READERS: Mapping[str, Callable[..., Any]] = {
    read.__name__: read for read in (str, int, whole, real, share, shard)
}
