"""The command line of all commands, and its refusals, which suggest what was meant."""

import argparse
import re
import shlex
from collections.abc import Sequence
from contextlib import suppress
from difflib import get_close_matches
from functools import partial
from itertools import dropwhile, takewhile
from typing import Any, NoReturn

from planner.support import did_you_mean
from sim.commands.declared import ABOUT, COMMANDS, GUESSES, declare
from sim.commands.options import command_for, report
from sim.endings import again, command
from sim.errors import UsageError, is_text
from sim.scenarios.declaration import read, words as words_of
from sim.scenarios.settings import SETTINGS

OPTIONS = ("-h", "--help", "--version")  # that need no command
ONE_VALUE = (argparse._StoreAction, argparse.BooleanOptionalAction)
PLACE = "stratawalk"
NAMES = re.compile("FILE|DIR|FOLDER|CARD|TABLE|RUN|ROBOT|SCENARIO")  # not to be empty
SWEPT = "for a sweep, list values in a file under [grid], as docs/sweeps.md shows"


class Parser(argparse.ArgumentParser):
    """A parser whose refusals are like all others: one line, no usage block."""

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing and exiting."""
        from sim.scenarios.file import shipped_scenarios

        lacking = message.removeprefix("the following arguments are required: ")
        if lacking != message:
            remedy, begun = str(self.epilog), again().removeprefix(self.prog)
            if lacking.removesuffix("|SYSTEM") == "SCENARIO" and begun:
                words, _, last = begun.rpartition(" ")  # perhaps an option took it
                known = last.endswith(".toml") or last in shipped_scenarios()
                line = f"{last}{words}" if known else f"line{begun}"
                remedy = f"for example: {self.prog} {line}"
            raise UsageError(f"{lacking} missing", self.prog, remedy)
        name, _, why = message.removeprefix("argument ").partition(": ")
        whole = r"\1 is not allowed; give a whole number"
        why = re.sub("invalid int value: (.*)", whole, why)
        why = re.sub("expected .*argument", "needs a value after it", why)
        why = why.replace("ignored explicit argument", "takes no value, but was given")
        raise UsageError.at(name, ValueError(why), self.epilog or f"see {self.prog} -h")

    def print_help(self, file: Any = None) -> None:
        """Print it; argparse's own way passes over a full disk."""
        print(self.format_help(), end="", file=file)

    def parse_known_args(  # type: ignore[override]
        self,
        args: Sequence[str] | None = None,
        namespace: argparse.Namespace | None = None,
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse, and refuse what no command line of this command has."""
        own = [name for action in self._actions for name in action.option_strings]
        words = list(args or ()) if self._subparsers is None else []
        options = list(takewhile("--".__ne__, words))
        for place, word in enumerate(options):  # before what is missing is asked for
            if word.startswith("--") and word.partition("=")[0] not in own:
                _refuse_option(word, words[place + 1 :], self.prog, own)
        names = [word.partition("=")[0] for word in options]
        for action in self._actions:  # the last of two values would count
            twice = sum(name in action.option_strings for name in names) > 1
            if twice and type(action) in ONE_VALUE:
                raise UsageError.of("twice", self.prog, key=action.option_strings[-1])
        given, rest = super().parse_known_args(args, namespace)
        for action in self._actions:
            value, word = vars(given).get(action.dest), str(action.metavar)
            empty = "" in value if isinstance(value, list) else value == ""
            if empty and NAMES.search(word):
                where = "".join(action.option_strings) or word
                raise UsageError("an empty name", where, "give a name")
        for begun in getattr(given, "set", ()):
            if begun.startswith("goal="):
                remedy = f"write --set {goal_setting([begun[5:], *rest])}"
                raise UsageError("the goal is that of the path", "--set", remedy)
            if "=" not in begun and rest:
                remedy = f"write --set {shlex.quote(f'{begun}={rest[0]}')}"
                raise UsageError(f"{begun} has no value", "--set", remedy)
            if "=[" in begun and "]" not in begun:
                raise UsageError.of("not_closed", "--set", begun=begun)
        for place, word in enumerate(rest):
            if word.startswith("-"):
                _refuse_option(word, rest[place + 1 :], self.prog, own)
            self._refuse_word(word, ["", *words][words.index(word)])
        return given, rest

    def _refuse_word(self, word: str, before: str) -> NoReturn:
        """Say which option a word is a choice of, or how the command is written."""
        from models import shipped_robots

        called = GUESSES["choices"].get(word, word)
        taken = {"robot": shipped_robots(), "set": [word] * ("=" in word)}
        for action in self._actions:
            if f"--{word}" in action.option_strings:
                raise UsageError(f"{word!r} stands alone", self.prog, f"write --{word}")
            choices = action.choices or taken.get(action.dest, ())
            if action.option_strings and called in map(str, choices):
                meant = f"write {action.option_strings[-1]} {called}"
                raise UsageError(f"{word!r} stands alone", self.prog, meant)
        if before in self._option_string_actions:
            what, remedy = f"{before} {word}", f"{before} stands alone"
            raise UsageError(f"{what} has a word too many", self.prog, remedy)
        remedy = self.epilog or f"see {self.prog} --help"
        raise UsageError(f"{word!r} is one word too many", self.prog, remedy)

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Refuse what is none of a few words, and say which was meant."""
        if action.choices is not None and value not in action.choices:
            named = action.option_strings or [action.dest.upper()]
            called = GUESSES["choices"].get(str(value), str(value))
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
    stratawalk = Parser("stratawalk", **ABOUT, allow_abbrev=False)
    about = "print the version and end"
    stratawalk.add_argument("--version", action=Version, nargs=0, help=about)
    commands = stratawalk.add_subparsers(metavar="COMMAND", required=True)
    for name, declared in COMMANDS.items():
        own = commands.add_parser(name, help=declared["help"], allow_abbrev=False)
        declare(own, name)
    return stratawalk


def as_meant(words: Sequence[str]) -> list[str]:
    """A command line with its first guesses put right: nothing at all, and `help`."""
    for word in words:
        if not is_text(word) or "\0" in word:  # as a name in another encoding
            raise UsageError(f"{word!r} is no text in UTF-8", PLACE, "rename it")
    if not (words := [*dropwhile(PLACE.__eq__, words)]):
        return ["--help"]
    first, *rest = words
    first = GUESSES["same"].get(first, first)
    if first == "help":
        return as_meant([*rest[:1], "--help"])
    if first.startswith("-") and first not in OPTIONS:
        if place := next((i for i, word in enumerate(words) if word in COMMANDS), 0):
            line = command(*words[place:], *words[:place])
            raise UsageError(f"{first} before its command", PLACE, f"try {line}")
        _refuse_option(first, rest, "stratawalk", OPTIONS[1:])
    if not first.startswith("-") and first not in COMMANDS:
        raise UsageError(f"unknown command {first!r}", PLACE, _instead_of(first, rest))
    return [first, *rest]


def _instead_of(first: str, rest: Sequence[str]) -> str:
    """What to type instead of a word that is no command, and of what follows it."""
    if meant := GUESSES["commands"].get(first) or command_for(first):
        return f"try {meant}"
    exact = [first] if first in SETTINGS and f"{first}s" not in COMMANDS else []
    near = [] if exact else get_close_matches(first, [*COMMANDS, "help"], n=1)
    if near:
        line = command(*near, *rest)
        return f"did you mean {line}? stratawalk help lists all commands"
    if keys := exact or _settings_named(first):
        value = next((word for word in rest[:1] if not word.startswith("-")), "VALUE")
        item, more = SETTINGS[keys[0]], ", ".join(keys[1:])
        words = f"{item.meaning}; likewise {more}" if more else item.meaning
        set_to = f"stratawalk run line --set {_given(keys[0], value)}"
        return f"try {set_to} ({item.allowed}): {words}"
    return "begin with stratawalk run line; stratawalk help lists all commands"


def _settings_named(text: str) -> list[str]:
    """Settings whose name has a word of a text, as floor_stiffness has floor."""
    said = {*text.lower().replace("?", "").split()}
    return [key for key in SETTINGS if said & {*key.split("_")}]


def _given(key: str, text: str) -> str:
    """A setting with a value, in a list where only that is taken, for a shell."""
    from sim.scenarios.file import parse_override, toml_value

    _, value = parse_override(f"{key}={text}")
    for given in (value, [value]):
        with suppress(ValueError):
            read(given, SETTINGS[key].kind)
            return shlex.quote(f"{key}={text if given == value else toml_value(given)}")
    return shlex.quote(f"{key}={text}")


def goal_setting(words: Sequence[str]) -> str:
    """A goal from words such as `0.1 0.2`, `0.1,0.2` or `y=0.2`, for a shell."""
    goal = {"x": "0", "y": "0", "yaw": "0"}
    text = " ".join(words).strip(" [").replace("theta", "yaw")
    for name, word in zip(goal, re.split(r"[\s,\[\]]+", text), strict=False):
        own, _, number = word.rpartition("=")
        if re.fullmatch(r"-?[\d.]+", number):
            goal[own if own in goal else name] = number
    return shlex.quote(f"path.goal=[{', '.join(goal.values())}]")


def _refuse_option(
    word: str, rest: Sequence[str], where: str, known: Sequence[str]
) -> NoReturn:
    """Refuse an option, and say what does it: another one, or a setting."""
    option, equals, value = word.partition("=")
    first, spaced, more = word.partition(" ")
    if spaced and first in known:
        remedy = f"write two words: {first} {shlex.quote(more)}"
        raise UsageError(f"{word!r} is one word", where, remedy)
    name = option.lstrip("-").replace("-", "_")
    settings = [f"--{key}" for key in SETTINGS if "--set" in known]
    given = value if equals else " ".join(rest[:1]) or "VALUE"
    plain = given if re.fullmatch(r"[\w.+-]+", given) else "VALUE"  # for a shell
    one, out = ("1", "NAME") if given == "VALUE" else (plain, shlex.quote(given))
    words = {"goal": goal_setting([value, *rest]), "value": one, "out": out}
    remedy = GUESSES["options"].get(name, "").format_map(words)
    if remedy.startswith("write --") and remedy.split()[1] not in known:
        remedy = ""
    for other, declared in COMMANDS.items():
        taken = option in " ".join(declared.get("options", ())).split()
        if taken and f"--{name}" not in settings:
            remedy = remedy or f"stratawalk {other} takes it"
    if not remedy and name in SETTINGS and not settings:
        one = _given(name, given.partition(",")[0])
        remedy = f"set it where it is walked, stratawalk run line --set {one}; {SWEPT}"
    named = [key for key in _settings_named(name) if settings]
    options = [key.lstrip("-") for key in (*known, *settings)]
    near = partial(get_close_matches, name.replace("_", "-"), options, n=1)
    begun = [key for key in options if name and key.startswith(name)]
    nearest = near(cutoff=0.8) or named or begun or near(cutoff=0.7)
    if nearest and f"--{nearest[0]}" not in known:
        key, *_ = nearest
        item = SETTINGS[key]
        about = "" if item.allowed == words_of(str) else f" ({item.allowed})"
        remedy = remedy or f"write --set {_given(key, given)}{about}"
    elif nearest:
        remedy = remedy or f"did you mean '--{nearest[0]}'?"
    listed = f"{where} --help lists all options"
    raise UsageError(f"unknown option {option}", where, remedy or listed)


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
