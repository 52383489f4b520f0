"""`stratawalk cite`: the program, the paper and what a run has used, as BibTeX."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.options import option, report

if TYPE_CHECKING:
    from sim.runs.run import Run

HELP = "print what to cite: the program and the paper, or all that a run has used"
OPTIONS = (option("run", metavar="RUN", nargs="?", help="folder of a finished run"),)
ALWAYS = ("stratawalk", "goodwine2000")
OF_PREDICTIONS = {
    "quasi_static": ("murphey2006", "hatton2025"),
    "compliant": ("alart1991",),
}


def execute(options: argparse.Namespace) -> None:
    """Print BibTeX entries."""
    keys, made = list(ALWAYS), version("stratawalk")
    if options.run is not None:
        from sim.folder import blamed_on
        from sim.runs.run import read_run

        folder = Path(options.run)
        with blamed_on(folder):
            run = read_run(folder)
            keys += _used(run)
            said = str(run.summary.versions.get("stratawalk", made))
            made = re.sub(r"[^\w.+-]", "", said)  # which ends no entry
    text = (files("sim.commands") / "references.bib").read_text()
    parts = text.removeprefix("@").split("\n@")
    entries = {_key(part): f"@{part.strip()}" for part in parts}
    chosen = [entries[key].replace("{VERSION}", f"{{{made}}}") for key in keys]
    bibtex = "\n".join(chosen)
    report(options, {"keys": keys, "bibtex": bibtex}, bibtex)


def _key(entry: str) -> str:
    return entry.partition("{")[2].partition(",")[0]


def _used(run: Run) -> Iterator[str]:
    """Keys of what a run was planned, predicted and simulated with."""
    if run.summary.optimise == "none":
        yield "lafferriere1991"
    else:
        yield from ("andersson2019", "waechter2006")
    yield "todorov2012"
    for name, keys in OF_PREDICTIONS.items():
        yield from keys if run.summary.predicted.get(name) else ()
    if run.scenario.obstacles:
        yield "sucan2012"
