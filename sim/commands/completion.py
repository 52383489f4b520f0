"""`stratawalk completion`: what a shell needs to complete our command lines."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping

HELP = "print a script that completes this command's words in a shell"
SHELLS = ("bash", "zsh", "tcsh")
HOW = {
    "bash": "stratawalk completion bash > ~/.local/share/bash-completion/completions/"
    "stratawalk",
    "zsh": "stratawalk completion zsh > a folder of $fpath, as _stratawalk",
    "tcsh": "stratawalk completion tcsh > /etc/profile.d/stratawalk.completion.csh",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("shell", choices=SHELLS, help="the shell it is for")
    parser.epilog = f"To install it for good: {HOW['bash']}"


def execute(options: argparse.Namespace) -> None:
    """Print the script; `shtab` writes it from our parser."""
    import shtab

    from sim.commands.parsing import parser

    commands = parser()
    _name_what_is_shipped(commands)
    script = shtab.complete(commands, options.shell)
    print(
        json.dumps({"shell": options.shell, "script": script})
        if options.json
        else script
    )


def _name_what_is_shipped(parser: argparse.ArgumentParser) -> None:
    """Names and files where robots, scenarios and systems are asked for."""
    known = _shipped()
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _name_what_is_shipped(command)
        kinds = str(action.metavar).partition("|")
        names = [name for kind in kinds for name in known.get(kind, ())]
        if names:
            action.choices = names  # of this parser alone, which reads no words


def _shipped() -> Mapping[str, tuple[str, ...]]:
    from models import SYSTEMS, shipped_robots
    from sim.scenarios.file import shipped_scenarios

    return {
        "SCENARIO": shipped_scenarios(),
        "ROBOT": shipped_robots(),
        "NAME": shipped_robots(),  # of --robot
        "SYSTEM": tuple(SYSTEMS),
    }
