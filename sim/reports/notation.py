"""The control sequence of a walk in the paper's notation, as HTML.

A flow along the field g for a time t is written as eq. (14) of the paper does, with the
time above and the field below; a stratum is named after the groups that stand. The
order is that of time, from left to right.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby

from markupsafe import Markup

from sim.evaluation.flows import WalkedPhase
from sim.runs.run import Run

FIELD = re.compile(r"g(\w+)_(\w+)")
MINUS = "\N{MINUS SIGN}"


def sequence(run: Run) -> Iterator[tuple[int, Markup]]:
    """Number of each segment, from 1, and its flows."""
    last = ""
    for segment, phases in groupby(run.phases, key=lambda phase: phase.segment):
        parts: list[Markup] = []
        for phase in phases:
            stratum = _stratum(phase, run.groups)
            if stratum != last:
                arrow = Markup(" &rarr; ") if last else Markup("")
                parts.append(arrow + _subscript("S", stratum))
                last = stratum
            if phase.kind == "swing":
                parts.append(Markup(" ") + flow(phase))
        yield segment + 1, Markup("").join(parts)


def flow(phase: WalkedPhase) -> Markup:
    """A flow, as in eq. (14)."""
    amount = f"{phase.amount:.4g}".replace("-", MINUS)
    text = "<span class=flow>&phi;<span><sup>{}</sup><sub>{}</sub></span></span>"
    return Markup(text).format(amount, field(phase.field))


def field(name: str) -> Markup:
    """A field's name: of stratum 12 the first, say."""
    found = FIELD.fullmatch(name)
    return _subscript("g", f"{found[1]},{found[2]}") if found else Markup.escape(name)


def _stratum(phase: WalkedPhase, groups: Sequence[str]) -> str:
    """The stratum that the robot is on once the phase is over."""
    if phase.kind != "land":
        return phase.stratum
    return "".join(g for g in groups if g in phase.stratum or g in phase.group)


def _subscript(letter: str, index: str) -> Markup:
    return Markup("{}<sub>{}</sub>").format(letter, index)
