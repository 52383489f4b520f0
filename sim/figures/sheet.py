"""Sheets of figures: a drawing with its numbers and its caption each.

`sheets.toml` says what a sheet shows, what its panels and its table look like, and
holds its caption; the module of its figure computes the numbers and draws them.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from planner.support import shipped_tables
from sim.figures import NAMES
from sim.figures.physics import Job, Walked, Walks, begun, time_left
from sim.figures.style import COLOURS, STYLE, sheet_of
from sim.folder import RunFolder, csv_text, whole
from sim.palette import Style
from sim.progress import Progress, silent
from sim.reports.tables import Table
from sim.templates import render

SHARED = {"biped": "strata", "quadruped": "strata"}  # modules, of two figures each
KINDS = ("paper", "metres")
Cell = str | int | float


@dataclass(frozen=True)
class Shown:
    """The numbers of a sheet: rows of its table, and words of caption and titles."""

    rows: Sequence[tuple[Cell, ...]]
    words: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Panel:
    """What `sheets.toml` says of a panel."""

    title: str
    map: str = ""  # unit of a plan view
    axes: Style = field(default_factory=dict)  # labels, limits and aspect
    fixed: Sequence[Sequence[Any]] = ()  # what never changes: method, arguments, look
    room: float = 0.0  # height for the key, in heights of the curves, from 0 on
    legend: Style | None = None  # of its own

    def finish(self, axes: Axes, title: str) -> None:
        """Add to a drawing what depends on no numbers; its colours are `COLOURS`."""
        for method, *given, look in self.fixed:
            named = {
                key: COLOURS.get(value, value) if key.endswith("color") else value
                for key, value in look.items()
            }
            getattr(axes, method)(*given, **named)
        if self.map:
            axes.set(xlabel=f"x [{self.map}]", ylabel=f"y [{self.map}]")
            axes.set_aspect("equal", adjustable="datalim")
        axes.set(**self.axes)
        if self.room:
            axes.set_ylim(0, self.room * axes.get_ylim()[1])
        if self.legend is not None:
            axes.legend(**self.legend)
        axes.set_title(title, loc="left")  # also in 3-D


@dataclass(frozen=True)
class Layout:
    """What `sheets.toml` says of a sheet."""

    name: str  # of its files, such as `fig6-line-paper`
    title: str  # its content in a few words
    caption: str  # what it shows, what the paper leaves open, what was chosen
    mosaic: str  # of the panels, as matplotlib's `subplot_mosaic` takes it
    height: float  # [in]
    panels: Mapping[str, Panel]  # by their letters
    columns: Sequence[str]  # name and unit of each column of the table
    options: Style = field(default_factory=dict)
    arguments: Style = field(default_factory=dict)  # of what draws it
    key: str = ""  # letter of the panel whose key stands below all of them
    key_columns: int = 0  # 0 for a single row
    cost: float = 1.2  # about how much CPU it takes [s], for estimates


@dataclass(frozen=True)
class Sheet:
    """One of the two drawings of a figure, numbers filled into its caption."""

    name: str
    title: str
    caption: str
    figure: Figure
    table: Table


def drawn(figure: str, kind: str, walks: Mapping[str, Walked] | None = None) -> Sheet:
    """Compute and draw a sheet: `paper`, or `metres` of the figure's `WALKS`."""
    layout, module = layouts()[figure][kind], _module(figure)
    data = () if kind == "paper" else (walks or {},)
    with rc_context(STYLE):
        canvas, axes = sheet_of(layout.mosaic, layout.height, layout.options)
        shown: Shown = getattr(module, kind)(axes, *data, **layout.arguments)
        for letter, panel in layout.panels.items():
            title = panel.title.format(**shown.words)
            panel.finish(axes[letter], f"({letter}) " * (len(axes) > 1) + title)
        canvas.suptitle(layout.title, x=0.01, ha="left", fontweight="bold")
        if layout.key:
            handles, labels = axes[layout.key].get_legend_handles_labels()
            columns = layout.key_columns or len(labels)
            canvas.legend(handles, labels, loc="outside lower center", ncols=columns)
        canvas.draw_without_rendering()
        canvas.set_layout_engine("none")  # which would move panels a little each time
    caption = " ".join(layout.caption.split()).format(**shown.words)
    table = Table(layout.columns, shown.rows)
    return Sheet(layout.name, layout.title, caption, canvas, table)


def rows_of(*columns: Iterable[Any]) -> list[tuple[Cell, ...]]:
    """Rows of a table from its columns, numpy's numbers as Python's."""
    plain = [getattr(column, "tolist", lambda c=column: c)() for column in columns]
    return list(zip(*plain, strict=True))


@cache
def layouts() -> Mapping[str, Mapping[str, Layout]]:
    """What `sheets.toml` says of all figures, by their names and kinds."""
    figures = shipped_tables("sim.figures", "sheets.toml")
    for layout in (layout for kinds in figures.values() for layout in kinds.values()):
        layout["panels"] = {k: Panel(**panel) for k, panel in layout["panels"].items()}
    return {
        figure: {kind: Layout(**layout) for kind, layout in kinds.items()}
        for figure, kinds in figures.items()
    }


def _module(figure: str) -> ModuleType:
    return import_module(f"sim.figures.{SHARED.get(figure, figure)}")


def save(sheet: Sheet, folder: Path) -> None:
    """Write the drawing under its title as PNG and SVG, and its numbers as CSV."""
    with rc_context(STYLE):
        for kind in ("png", "svg"):
            with whole(folder / f"{sheet.name}.{kind}") as part:
                undated = {"Date": None} if kind == "svg" else {"Software": None}
                sheet.figure.savefig(part, format=kind, metadata=undated)
    rows = [sheet.table.header, *sheet.table.rows]
    RunFolder(folder).write_text(f"{sheet.name}.csv", csv_text(rows))


def page(sheets: Sequence[Sheet]) -> str:
    """All sheets with captions and tables, rounded to four digits, as Markdown."""
    return render("figures.md", sheets=sheets) + "\n"


def draw(
    folder: RunFolder, only: str | None = None, *, progress: Progress = silent
) -> Iterator[Sheet]:
    """Draw one figure or all; yield each sheet once its files are complete.

    Sheets in the paper's units come first, while the walks of the others are computed.
    Those in metres follow as their walks are done, and in the end their common page.
    """
    names = (only,) if only else NAMES
    needed = {name: getattr(_module(name), "WALKS", {}) for name in names}
    jobs = {walk: job for walks in needed.values() for walk, job in walks.items()}
    costs = {(name, k): layouts()[name][k].cost for name in names for k in KINDS}
    walking, drawing = sum(job.cost for job in jobs.values()), sum(costs.values())
    whole = time_left(walking, drawing)
    done: dict[tuple[str, str], Sheet] = {}
    with begun(jobs) as (walks, walked):

        def report() -> None:
            undrawn = drawing - sum(costs[at] for at in done)
            progress("figures", 1 - time_left(walking - walked(), undrawn) / whole)

        report()
        for name, kind, sheet in _sheets(needed, walks, report):
            save(sheet, folder.path)
            done[name, kind] = sheet
            report()
            yield sheet
    folder.write_text("figures.md", page([done[at] for at in costs]))


def _sheets(
    needed: Mapping[str, Mapping[str, Job]], walks: Walks, report: Callable[[], object]
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
        wait([w for w in left if not w.done()], 1.0, FIRST_COMPLETED)  # [s]
        report()
