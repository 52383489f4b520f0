"""`stratawalk completion`: what a shell needs to complete our command lines."""

from __future__ import annotations

import argparse

from sim.commands.options import option, report

HELP = "print a script that completes this command's words in a shell"
SHELLS = ("bash", "zsh", "tcsh")
EPILOG = (
    "To install it for good: stratawalk completion bash > "
    "~/.local/share/bash-completion/completions/stratawalk"
)
OPTIONS = (option("shell", choices=SHELLS, help="the shell it is for"),)


def execute(options: argparse.Namespace) -> None:
    """Print the script; `shtab` writes it from our parser."""
    import shtab

    from models import SYSTEMS, shipped_robots
    from sim.commands.parsing import parser
    from sim.scenarios.file import shipped_scenarios

    robots, shell = shipped_robots(), options.shell
    commands = parser()
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
            for command in action.choices.values():
                _name_what_is_shipped(command, known)
        kinds = str(action.metavar).partition("|")
        names = [name for kind in kinds for name in known.get(kind, ())]
        if names:
            action.choices = names  # of this parser alone, which reads no words
