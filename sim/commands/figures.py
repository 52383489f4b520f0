"""`stratawalk figures`: the paper's Figs. 1 to 9, on its kinematics and in physics."""

from __future__ import annotations

import argparse
from functools import partial

from sim.commands.options import folder_of, kept_in, option, report
from sim.endings import keeping
from sim.figures import NAMES

HELP = "draw the paper's Figs. 1 to 9 again, on its kinematics and beside physics"
OPTIONS = (
    option("--out", metavar="DIR", help="folder to make; otherwise runs/figures-NNN"),
    option("--only", choices=NAMES, help="draw this one alone"),
)


def execute(options: argparse.Namespace) -> None:
    """Draw the figures, name each when it is written, and print their folder."""
    from sim.figures.sheet import draw
    from sim.folder import claim
    from sim.progress import bar

    folder = claim(folder_of(options), "figures")
    kept = partial(kept_in, folder.path, options.out)
    try:
        with bar(quiet=options.json) as progress, keeping(kept):
            facts = {}
            for sheet in draw(folder, options.only, progress=progress):
                facts[sheet.name] = sheet.caption
                if not options.json:
                    print(f"{sheet.name:26}{sheet.title}", flush=True)
    finally:
        folder.discard_if_empty()
    where = f"\n{'folder':26}{folder.path}\n{'captions and tables':26}figures.md in it"
    report(options, {"folder": str(folder.path), "figures": facts}, where)
