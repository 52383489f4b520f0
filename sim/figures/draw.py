"""Drawing of all figures or one: each sheet is written as soon as it can be drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from importlib import import_module

from sim.figures import NAMES
from sim.figures.physics import Job, Walked, begun
from sim.figures.sheet import Sheet, drawn, page, save
from sim.folder import RunFolder
from sim.progress import Progress, silent

KINDS = ("paper", "metres")


def draw(
    folder: RunFolder, only: str | None = None, *, progress: Progress = silent
) -> Iterator[Sheet]:
    """Draw one figure or all; yield each sheet once its files are complete.

    Sheets in the paper's units come first, while the walks of the others are computed.
    Those in metres follow as their walks are done, and in the end their common page.
    """
    names = (only,) if only else NAMES
    needed: dict[str, Mapping[str, Job]] = {
        name: getattr(import_module(f"sim.figures.{name}"), "WALKS", {})
        for name in names
    }
    jobs = {walk: job for walks in needed.values() for walk, job in walks.items()}
    done: dict[tuple[str, str], Sheet] = {}
    with begun(jobs, progress) as walks:
        for name, kind, sheet in _sheets(needed, walks):
            save(sheet, folder.path)
            done[name, kind] = sheet
            progress("drawing", len(done) / (len(KINDS) * len(names)))
            yield sheet
    in_order = [done[name, kind] for name in names for kind in KINDS]
    folder.write_text("figures.md", page(in_order))


def _sheets(
    needed: Mapping[str, Mapping[str, Job]], walks: Mapping[str, Future[Walked]]
) -> Iterator[tuple[str, str, Sheet]]:
    """Name of the figure, kind and sheet, in the order in which they can be drawn."""
    for name in needed:
        yield name, "paper", drawn(name, "paper")
    waiting = dict(needed)
    while waiting:
        ready = [n for n, own in waiting.items() if all(walks[w].done() for w in own)]
        for name in ready:
            made = {walk: walks[walk].result() for walk in waiting.pop(name)}
            yield name, "metres", drawn(name, "metres", made)
        left = [walks[walk] for own in waiting.values() for walk in own]
        wait([w for w in left if not w.done()], return_when=FIRST_COMPLETED)
