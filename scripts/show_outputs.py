"""Write down what the commands shown in README and docs print today.

Every `$ stratawalk ...` in a console block that has output under it is run again, and
its output replaced; so is the table of settings. Look at the difference before you keep
it.

Example:
    python -m scripts.show_outputs docs/commands.md
"""

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import MISSING
from pathlib import Path
from tempfile import TemporaryDirectory

from planner.support import whole_file
from scripts.endings import ROOT
from scripts.pages import parser_of
from sim import Scenario

BLOCK = re.compile(r"(?<=^```console\n).*?(?=^```$)", re.DOTALL | re.MULTILINE)
SETTINGS_TABLE = re.compile(
    r"(?<=^<!-- settings -->\n).*?(?=^<!-- end of settings -->$)",
    re.DOTALL | re.MULTILINE,
)
COMMAND = re.compile(r"^\$ stratawalk (.*)\n((?:(?!\$ ).*\n)+)", re.MULTILINE)


def shown_again(command: re.Match[str]) -> str:
    """A command line with what it prints now in an empty folder; it must not fail."""
    line = command[1]
    print(line, flush=True)
    words = [sys.executable, "-m", "sim.cli", *shlex.split(line, comments=True)]
    env = os.environ | {"PYTHONPATH": str(ROOT)}
    with TemporaryDirectory() as folder:
        try:
            printed = subprocess.check_output(words, cwd=folder, env=env, text=True)
        except subprocess.CalledProcessError as error:
            raise SystemExit(f"ended with {error.returncode}: {line}") from None
    return f"$ stratawalk {line}\n" + printed.rstrip("\n") + "\n"


def settings_table() -> str:
    """Every setting of a scenario with its values, default, meaning and effects."""
    rows = ["setting | values | default | meaning | affects", " | ".join(["---"] * 5)]
    for name, item in Scenario.declarations().items():
        given = item.default is not None and item.default is not MISSING
        default = f"`{json.dumps(item.default)}`" if given else ""
        parts = ", ".join(sorted(item.affects)) + " *" * item.imperfection
        rows.append(f"`{name}` | {item.allowed} | {default} | {item.meaning} | {parts}")
    return "".join(f"| {row} |\n" for row in rows)


def main(arguments: Sequence[str] | None = None) -> None:
    """Rewrite the pages that are named."""
    parser = parser_of(__doc__)
    parser.add_argument("page", type=Path, nargs="+", help="a Markdown file")
    for page in parser.parse_args(arguments).page:
        text = page.read_text()
        again = BLOCK.sub(lambda block: COMMAND.sub(shown_again, block[0]), text)
        again = SETTINGS_TABLE.sub(lambda table: settings_table(), again)
        with whole_file(page) as part:
            part.write_text(again)


if __name__ == "__main__":
    main()
