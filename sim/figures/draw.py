"""Drawing of all figures or one: each sheet is written as soon as it can be drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from importlib import import_module
from types import ModuleType

from matplotlib import rc_context

from sim.figures import NAMES
from sim.figures.physics import Job, Walked, begun
from sim.figures.sheet import Sheet, page, save
from sim.figures.style import STYLE
from sim.folder import RunFolder
from sim.progress import Progress, silent

KINDS = ("paper", "metres")


def draw(
    folder: RunFolder, only: str | None = None, *, progress: Progress = silent
) -> Iterator[Sheet]:
    """Draw figures and write pictures and tables one by one, then their page.

    The sheets in the paper's units come first, while the walks of the others are
    computed; those in metres follow as their walks are done.

    Args:
        folder: Empty folder to write to.
        only: One of `NAMES`; None draws them all.
        progress: Called with each stage and the finished part of it.

    Yields:
        Each sheet when its files are complete.

    Raises:
        PlannerError: If a walk has no plan.
        SimulationError: If the physics diverges.
        FilesError: If the folder cannot be written.
    """
    names = (only,) if only else NAMES
    chosen = {name: import_module(f"sim.figures.{name}") for name in names}
    jobs: dict[str, Job] = {}
    for figure in chosen.values():
        jobs |= figure.WALKS
    drawn: dict[tuple[str, str], Sheet] = {}
    with begun(jobs, progress) as walks:
        for name, kind, sheet in _sheets(chosen, walks):
            with rc_context(STYLE):
                save(sheet, folder.path)
            drawn[name, kind] = sheet
            progress("drawing", len(drawn) / (len(KINDS) * len(chosen)))
            yield sheet
    in_order = [drawn[name, kind] for name in names for kind in KINDS]
    folder.write_text("figures.md", page(in_order))


def _sheets(
    figures: Mapping[str, ModuleType], walks: Mapping[str, Future[Walked]]
) -> Iterator[tuple[str, str, Sheet]]:
    """Name of the figure, kind and sheet, in the order in which they can be drawn."""
    for name, figure in figures.items():
        with rc_context(STYLE):
            sheet = figure.paper()
        yield name, "paper", sheet
    waiting = dict(figures)
    while waiting:
        ready = [n for n, f in waiting.items() if all(walks[w].done() for w in f.WALKS)]
        for name in ready:
            figure = waiting.pop(name)
            made = {walk: walks[walk].result() for walk in figure.WALKS}
            with rc_context(STYLE):
                sheet = figure.metres(made)
            yield name, "metres", sheet
        left = [walk for f in waiting.values() for walk in f.WALKS]
        wait(
            [w for n in left if not (w := walks[n]).done()], return_when=FIRST_COMPLETED
        )
