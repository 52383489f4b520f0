"""A sheet: one drawing with its numbers and its caption."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sim.figures.style import STYLE
from sim.folder import RunFolder, whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg")
Cell = str | int | float


@dataclass(frozen=True)
class Table:
    """Numbers that a drawing shows, unrounded.

    Attributes:
        header: Name and unit of each column.
        rows: Cells, one for each column.

    Raises:
        ValueError: A row has not one cell a column.
    """

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
class Sheet:
    """One of the two drawings of a figure.

    Attributes:
        name: Of its files, such as `fig6-line-paper`.
        title: Its content in a few words.
        caption: What it shows, what the paper leaves open, and what was chosen.
        figure: The drawing.
        table: Its numbers.
    """

    name: str
    title: str
    caption: str
    figure: Figure
    table: Table


def words(text: str, **values: object) -> str:
    """A caption written over several lines as one, with values filled in."""
    return " ".join(text.split()).format(**values)


def save(sheet: Sheet, folder: Path) -> None:
    """Write the drawing under its title as PNG and SVG, and its numbers as CSV."""
    from matplotlib import rc_context

    sheet.figure.suptitle(sheet.title, x=0.01, ha="left", fontweight="bold")
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
