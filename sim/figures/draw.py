"""Drawing of all figures or one: the walks, then pictures and tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from types import ModuleType

from matplotlib import rc_context

from sim.figures import NAMES
from sim.figures.physics import Job, Walked, perform_all
from sim.figures.sheet import Sheet, page, save
from sim.figures.style import STYLE
from sim.folder import RunFolder
from sim.progress import Progress, silent


def draw(
    folder: RunFolder, only: str | None = None, *, progress: Progress = silent
) -> list[Sheet]:
    """Draw figures and write pictures, tables and a page of captions.

    Args:
        folder: Empty folder to write to.
        only: One of `NAMES`; None draws them all.
        progress: Called with each stage and the finished part of it.

    Raises:
        PlannerError: If a walk has no plan.
        SimulationError: If the physics diverges.
        FilesError: If the folder cannot be written.
    """
    names = (only,) if only else NAMES
    chosen = [import_module(f"sim.figures.{name}") for name in names]
    jobs: dict[str, Job] = {}
    for figure in chosen:
        jobs |= figure.WALKS
    walks = perform_all(jobs, progress)
    sheets = []
    with rc_context(STYLE):
        for sheet in _sheets(chosen, walks):
            save(sheet, folder.path)
            sheets.append(sheet)
            progress("drawing", len(sheets) / (2 * len(chosen)))
    folder.write_text("figures.md", page(sheets))
    return sheets


def _sheets(figures: list[ModuleType], walks: Mapping[str, Walked]) -> Iterator[Sheet]:
    for figure in figures:
        yield figure.paper()
        yield figure.metres(walks)
