"""Colours of the pages, for the colour-blind; meanings are those of the figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sim.figures.style import IDEAL, PHYSICS, QUASI_STATIC

ACHIEVED = PHYSICS
NOMINAL = "#666666"
PREDICTED: Mapping[str, str] = {
    "ideal": IDEAL,
    "quasi_static": QUASI_STATIC,
    "identified": "#AA4499",
}
DASHES: Mapping[str, Any] = {  # told apart in greyscale
    "ideal": "-",
    "quasi_static": (0, (4, 1.5)),
    "identified": (0, (1, 1)),
}
OUTLINES = "#b9c0ca"
LIMIT = "#b3261e"
LEGS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#666666",
        "#000000")  # fmt: skip
GROUPS = ("#2970bf", "#cc453d", "#d6a024", "#7c5cb6", "#409ea8", "#c468a0")


def of_leg(index: int) -> str:
    """Colour of a leg's curve; after the last one they begin again."""
    return LEGS[index % len(LEGS)]


def of_group(index: int) -> str:
    """Colour of a group of legs, as in films."""
    return GROUPS[index % len(GROUPS)]
