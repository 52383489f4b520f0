"""The least systems on which brackets show, with which examples begin."""

from collections.abc import Mapping

from planner.systems.strata import StratifiedSystem

XYZ, F, G = ("x", "y", "z"), {"f": [1, 0, 0]}, {"g": [0, 1, "x"]}
CAR = {"drive": ["cos(a)", "sin(a)", 0], "turn": [0, 0, 1]}

EXAMPLES: Mapping[str, StratifiedSystem] = {
    "heisenberg": StratifiedSystem(XYZ, {"0": F | G}, "0"),
    "walker": StratifiedSystem(XYZ, {"12": {}, "1": F, "2": G}, "12"),
    "car": StratifiedSystem(("x", "y", "a"), {"0": CAR}, "0"),
}
"""In `heisenberg`, [f, g] alone moves z. `walker` is the same on two feet, one of which
each field lifts. `car` moves aside by [drive, turn].

Example:
    >>> from planner import EXAMPLES
    >>> EXAMPLES["walker"].dimension
    3
"""
