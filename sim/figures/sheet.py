"""A sheet: one drawing with its numbers and its caption.

`sheets.toml` says what a sheet shows, names its panels and the columns of its table,
and holds its caption; the module of its figure computes the numbers and draws them.
"""

from __future__ import annotations

import csv
import io
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.figures.physics import Walked
from sim.figures.style import STYLE, sheet_of
from sim.folder import RunFolder, whole
from sim.palette import Style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg")
LAYOUTS = Path(__file__).with_name("sheets.toml")
Cell = str | int | float


@dataclass(frozen=True)
class Shown:
    """The numbers of a sheet: rows of its table, and words of caption and titles."""

    rows: Sequence[tuple[Cell, ...]]
    words: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True)
class Table:
    """Numbers that a drawing shows, unrounded; the header has names and units."""

    header: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        for i, row in enumerate(self.rows):
            if len(row) != len(self.header):
                raise ValueError(
                    f"row {i} has {len(row)} cells for {len(self.header)} columns"
                )

    def csv(self) -> str:
        """The table as CSV, every digit kept."""
        lines = io.StringIO()
        csv.writer(lines, lineterminator="\n").writerows([self.header, *self.rows])
        return lines.getvalue()

    def markdown(self) -> str:
        """The table for people, rounded to four digits."""
        lines = [self.header, ["---:"] * len(self.header)]
        lines += [[_rounded(cell) for cell in row] for row in self.rows]
        return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _rounded(cell: Cell) -> str:
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)


@dataclass(frozen=True)
class Layout:
    """What `sheets.toml` says of a sheet."""

    name: str  # of its files, such as `fig6-line-paper`
    title: str  # its content in a few words
    caption: str  # what it shows, what the paper leaves open, what was chosen
    mosaic: str  # of the panels, as matplotlib's `subplot_mosaic` takes it
    height: float  # [in]
    panels: Sequence[str]  # titles in the order of the panels' letters
    columns: Sequence[str]  # name and unit of each column of the table
    options: Style = field(default_factory=dict)
    key: str = ""  # letter of the panel whose key stands below all of them
    key_columns: int = 0  # 0 for a single row


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
    from matplotlib import rc_context

    layout, module = _layouts()[figure][kind], import_module(f"sim.figures.{figure}")
    with rc_context(STYLE):
        canvas, axes = sheet_of(layout.mosaic, layout.height, layout.options)
        if kind == "paper":
            shown: Shown = module.paper(axes)
        else:
            shown = module.metres(axes, walks or {})
        for (letter, panel), title in zip(axes.items(), layout.panels, strict=True):
            words = title.format(**shown.words)
            panel.set_title(f"({letter}) {words}", loc="left")  # also in 3-D
        canvas.suptitle(layout.title, x=0.01, ha="left", fontweight="bold")
        if layout.key:
            handles, labels = axes[layout.key].get_legend_handles_labels()
            columns = layout.key_columns or len(labels)
            canvas.legend(handles, labels, loc="outside lower center", ncols=columns)
        canvas.draw_without_rendering()
        canvas.set_layout_engine("none")  # which would move panels a little each time
    return Sheet(
        name=layout.name,
        title=layout.title,
        caption=" ".join(layout.caption.split()).format(**shown.words),
        figure=canvas,
        table=Table(tuple(layout.columns), tuple(shown.rows)),
    )


def rows_of(*columns: Iterable[Any]) -> list[tuple[Cell, ...]]:
    """Rows of a table from its columns, numpy's numbers as Python's."""
    plain = [getattr(column, "tolist", lambda c=column: c)() for column in columns]
    return list(zip(*plain, strict=True))


@cache
def _layouts() -> Mapping[str, Mapping[str, Layout]]:
    figures = tomllib.loads(LAYOUTS.read_text(encoding="utf-8"))
    return {
        figure: {kind: Layout(**layout) for kind, layout in kinds.items()}
        for figure, kinds in figures.items()
    }


def save(sheet: Sheet, folder: Path) -> None:
    """Write the drawing under its title as PNG and SVG, and its numbers as CSV."""
    from matplotlib import rc_context

    with rc_context(STYLE):
        for kind in FORMATS:
            with whole(folder / f"{sheet.name}.{kind}") as part:
                undated = {"Date": None} if kind == "svg" else {"Software": None}
                sheet.figure.savefig(part, format=kind, metadata=undated)
    RunFolder(folder).write_text(f"{sheet.name}.csv", sheet.table.csv())


def page(sheets: Sequence[Sheet]) -> str:
    """All sheets with captions and tables, as Markdown."""
    parts = ["# The paper's figures, drawn again\n"]
    for sheet in sheets:
        parts += [
            f"## {sheet.title}\n",
            f"![{sheet.title}]({sheet.name}.png)\n",
            f"{sheet.caption}\n",
            f"Numbers: [{sheet.name}.csv]({sheet.name}.csv)\n",
            sheet.table.markdown(),
        ]
    return "\n".join(parts)
