"""The table of quantities: how the numbers of a summary are named and shown.

Terminal, report, comparison of runs and tries read it; a test holds docs/numbers.md
against it. Sweeps have every number of the summary by its key.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sim.evaluation.summary import Summary
from sim.scenarios.predictions import PREDICTIONS

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
    """A number of the summary, as people read it.

    Attributes:
        key: Dotted name in summary.json; `*` is a row of `ROWS`.
        label: What it is called.
        unit: In which it is shown.
        scale: From SI units to that unit.
        digits: After the point.
        column: Heading of its column on the terminal; a number for each row that has
            no column is shown in a line of its own.
        width: Of that column.
        line: Whether the terminal gives a number of the walk a line of its own.
    """

    key: str
    label: str
    unit: str = ""
    scale: float = 1.0
    digits: int = 0
    column: str = ""
    width: int = 10
    line: bool = False

    @property
    def title(self) -> str:
        """Label and unit, as heads of tables have them."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

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
        return f"{self.scale * value:.{self.digits}f} {self.unit}".rstrip()


POSITION = Quantity("error.*.position", "at the end", "mm", 1e3, 2)
YAW = Quantity("error.*.yaw", "in yaw", "mrad", 1e3, 2)
MARGIN = Quantity("predicted.*.min_margin", "least margin", "mm", 1e3, 1, "margin")
SLIP = Quantity("predicted.*.slip", "slip", "mm", 1e3, 1, "slip", 11)
OF_ROWS = (  # beside where each row ends, and how far the physics ends off it
    Quantity("error.*.farthest", "at most", "mm", 1e3, 2, "at most"),
    MARGIN,
    SLIP,
    Quantity("predicted.*.slip_transition", "switch slip", "mm", 1e3, 1),
)
WRONG = Quantity("feedback.wrong", "wrongly thought", "mm", 1e3, 2)
CLAIMED = Quantity("feedback.claimed", "claimed error", "mm", 1e3, 2)
OF_WALKS = (
    Quantity("achieved.creep_floor", "creep floor", "mm", 1e3, 3),
    Quantity("contact_switches", "contact switches"),
    Quantity("contact_switches_achieved", "contact switches achieved"),
    Quantity("bounces", "bounces"),
    Quantity("path_length", "length of the path", "m", 1.0, 4),
    Quantity("distance_walked", "way walked", "m", 1.0, 4),
    Quantity("swing_travel", "swing of loaded groups", "rad", 1.0, 2),
    Quantity("air_travel", "swing in the air", "rad", 1.0, 2),
    WRONG,
    CLAIMED,
    Quantity("feedback.bound", "least error", "mm", 1e3, 2),
    Quantity("simulated_time", "simulated time", "s", 1.0, 2),
)
QUANTITIES = (POSITION, YAW, *OF_ROWS, *OF_WALKS)


def number(value: float | None, digits: int = 2) -> str:
    """A number for people; a dash if there is none."""
    if value is None:
        return NONE
    return f"{value:z,.{digits}f}".replace("-", MINUS)
