"""The table of quantities: how the numbers of a summary are named and shown.

Terminal, report, comparison of runs and tries read it; a test holds docs/numbers.md
against it. Sweeps have every number of the summary by its key.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import degrees

from planner.support import shipped_tables
from sim.evaluation.summary import Played, Summary
from sim.scenarios.predictions import PREDICTIONS, prediction_key
from sim.templates import render

SCALES = {"mm": 1e3, "mrad": 1e3, "degrees": degrees(1.0), "%": 100.0}  # from SI units
MINUS = "\N{MINUS SIGN}"
NONE = "\N{EN DASH}"
GOAL, ACHIEVED, MEASURED = "goal", "achieved", "measured"
ROWS: Mapping[str, str] = {  # of a comparison: label by key
    GOAL: "goal",
    **{key: name.label for key, name in PREDICTIONS.items()},
    ACHIEVED: "achieved",
    MEASURED: "measured",
}


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of the summary, as people read it."""

    key: str  # dotted name in summary.json; `*` is a row of `ROWS`
    label: str
    unit: str = ""  # in which it is shown
    digits: int = 0  # after the point
    column: str = ""  # its heading on the terminal; without one rows have a line for it
    width: int = 10  # of that column
    line: bool = False  # whether a number of the walk has a line of the terminal

    @property
    def title(self) -> str:
        """Label and unit, as heads of tables have them."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    @property
    def scale(self) -> float:
        """From SI units to the unit in which it is shown."""
        return SCALES.get(self.unit, 1.0)

    def value(self, summary: Summary, row: str = "") -> float | None:
        """The number in SI units, that of a row where each has one; None without it."""
        key = self.key.replace("*", row).replace("predicted.achieved", "achieved")
        found: object = summary
        for name in key.split("."):
            found = found.get(name) if isinstance(found, Mapping) else None
        return found if isinstance(found, int | float) else None

    def cell(self, summary: Summary, row: str = "", finer: int = 0) -> str:
        """The number as tables show it under a title, a dash if there is none."""
        value = self.value(summary, row)
        scaled = None if value is None else self.scale * value
        return number(scaled, self.digits + finer)

    def words(self, value: float | None) -> str:
        """A number in SI units as text with its unit; empty if there is none."""
        if value is None:
            return ""
        return f"{self.scale * value:z.{self.digits}f} {self.unit}".rstrip()


POSITION = Quantity("error.*.position", "at the end", "mm", 2)
YAW = Quantity("error.*.yaw", "in yaw", "mrad", 2)
MARGIN = Quantity("predicted.*.min_margin", "least margin", "mm", 1, "margin")
SLIP = Quantity("predicted.*.slip", "slip", "mm", 1, "slip", 11)
OF_ROWS = (  # beside where each row ends, and how far the physics ends off it
    Quantity("error.*.farthest", "at most", "mm", 2, "at most"),
    MARGIN,
    SLIP,
    Quantity("predicted.*.slip_transition", "switch slip", "mm", 1),
)
WALKS = shipped_tables("sim.evaluation", "quantities.toml")
OF_WALKS = tuple(Quantity(key, **shown) for key, shown in WALKS.items())
WRONG, CLAIMED = (q for q in OF_WALKS if q.key[9:] in ("wrong", "claimed"))
COLUMNS = tuple(quantity for quantity in OF_ROWS if quantity.column)
LINES = tuple(quantity for quantity in OF_ROWS if not quantity.column)
HEADS = "".join(f"{quantity.column:>{quantity.width}}" for quantity in COLUMNS)
HEADER = f"{'':13}{'ends at x, y [m], yaw [rad]':33}{'from the achieved end':23}{HEADS}"


def number(value: float | None, digits: int = 2) -> str:
    """A number for people; a dash if there is none."""
    return NONE if value is None else f"{value:z,.{digits}f}".replace("-", MINUS)


def describe(summary: Summary) -> str:
    """The walk and its comparison with the predictions, in lines for a terminal."""
    predicted = summary.predicted.get(prediction_key(summary.steer))
    clearance = predicted.min_clearance if predicted else None
    rows = [HEADER, *_rows(summary), *_lines(summary)]
    return render("walk.txt", rows=rows, clearance=clearance, **summary)


def describe_export(summary: Summary, played: Played, label: str) -> str:
    """An exported walk, played in the physics, beside where it should be."""
    ended = {key: played[key] for key in ("pose", "min_margin", "slip")}
    achieved = replace(summary.achieved, **ended)
    shown = replace(summary, achieved=achieved, error=played.error)
    rows = [_row(shown, row) for row in (GOAL, played.weighed.prediction)]
    return "\n".join([HEADER, *filter(None, rows), _row(shown, ACHIEVED, label)])


def _rows(summary: Summary) -> Iterator[str]:
    for row, label in ROWS.items():
        if why := summary.unpredicted.get(row):
            yield f"{label:13}{why}"
        elif text := _row(summary, row):
            yield text


def _row(summary: Summary, row: str, label: str = "") -> str:
    """Where a row of the comparison ends, and how far the physics ends off it."""
    if (pose := summary.poses.get(row)) is None:
        return ""
    x, y, yaw = pose
    end = f"{x:z8.4f} {y:z8.4f} {yaw:z8.4f}"
    off, length = "", summary.path_length
    if (error := summary.error.get(row)) is not None:
        share = f"{error.position / length:6.2%}" if length else f"{'':6}"
        off = f"{1e3 * error.position:6.2f} mm {share} {error.yaw:7.4f} rad"
    cells = (f" {q.words(q.value(summary, row)):>{q.width - 1}}" for q in COLUMNS)
    return f"{label or ROWS[row]:13}{end:28}{off:28}{''.join(cells)}".rstrip()


def _lines(summary: Summary) -> Iterator[str]:
    """What is ignored, and quantities without a column: of the rows, of the walk."""
    if summary.ignored:
        yield f"{'ignored':13}{summary.ignored}"
    for quantity in LINES if summary.goal else ():  # no lift-offs in a log
        values = {label: quantity.value(summary, row) for row, label in ROWS.items()}
        words = (f"{quantity.words(v)} {k}" for k, v in values.items() if v is not None)
        if found := ", ".join(words):
            yield f"{quantity.label:12} {found}"
    for quantity in OF_WALKS:
        if quantity.line and (found := quantity.words(quantity.value(summary))):
            yield f"{quantity.label:12} {found}"
