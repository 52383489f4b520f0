"""Captions of a film: key, clock, stratum, contacts, margin, error and scales."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner import Array
from sim import palette
from sim.evaluation.flows import WalkedPhase
from sim.palette import Colour
from sim.pictures.camera import HEIGHT, WIDTH, Camera
from sim.pictures.clock import Clock
from sim.pictures.floor import cell
from sim.pictures.inset import inset
from sim.pictures.legend import legend, noun
from sim.pictures.panel import (
    EDGE,
    LARGE,
    MIDDLE,
    PAD,
    Draw,
    Panel,
    empty,
    length,
    millimetres,
    text,
)
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

GAP = 10  # between panels [pixels]
BAR = 92  # height of the bar at the bottom [pixels]
LAMP = 11  # radius of a foot's lamp [pixels]
COLUMN = 230  # width of a number in the bar [pixels]
SCALE = 50  # height of the scale bar's panel [pixels]
TICK = 5  # half the height of the scale bar's ends [pixels]

VERBS = {  # of a group in the air, of one on the ground
    "hold": ("wait{s} in the air", "stand{s}"),
    "swing": ("swing{s} in the air", "swing{s} the body"),
    "lift": ("lift{s}", "lift{s}"),
    "land": ("land{s}", "land{s}"),
}


class Captions:
    """Writes on the pictures of one film."""

    def __init__(self, walk: Run, clock: Clock, view: Camera) -> None:
        bottom = HEIGHT - EDGE - BAR - GAP
        key, scale = legend(walk), scale_bar(view, walk.reach, bottom)
        error = inset(walk, view, key.bottom, bottom, clear=scale.top - GAP)
        time = _clock(walk, clock.playback)
        self._panels = (key, time, scale, error, _bar(walk))

    def write(self, picture: Array, row: int) -> None:
        """Write on the picture of a row, shape (HEIGHT, WIDTH, 3), bytes, in place."""
        for panel in self._panels:
            panel.put(picture, row)


def _clock(walk: Run, playback: float) -> Panel:
    """Top right: the time, and how much faster it passes."""
    still, draw = empty(150, 82)
    speed = "real time" if playback == 1 else f"{playback:g}x real time"
    text(draw, (150 - PAD, 48), speed, anchor="ra", colour=palette.FAINT)

    def write(draw: Draw, row: int) -> None:
        text(draw, (150 - PAD, 10), f"{walk.time[row]:.1f} s", LARGE, "ra")

    return Panel(WIDTH - EDGE - 150, EDGE, still, write)


def _bar(walk: Run) -> Panel:
    """At the bottom: stratum, feet in contact, and present measurements."""
    width, height = WIDTH - 2 * EDGE, BAR
    still, draw = empty(width, height)
    first = next(name for name in walk.drawn if name in walk.predicted)
    off = np.hypot(*(walk.achieved - walk.predicted[first])[:, :2].T)
    label = f"off the {PREDICTIONS[first].label} prediction"
    numbers = {"stability margin": walk.margin, label: off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    ends = [width - PAD - i * COLUMN for i in range(len(numbers))]
    for end, label in zip(ends, numbers, strict=True):
        text(draw, (end, 54), label, anchor="ra", colour=palette.FAINT)

    def write(draw: Draw, row: int) -> None:
        flow = walk.phases[walk.phase[row]]
        words = describe(flow, walk.groups, walk.legs_per_group)
        text(draw, (PAD, 12), words, MIDDLE)
        for foot, leg in enumerate(walk.legs):
            colour = palette.group(walk.group_of_foot[foot])
            _lamp(draw, foot, str(leg), colour, touches=walk.contact[row, foot])
        for end, metres in zip(ends, numbers.values(), strict=True):
            text(draw, (end, 14), millimetres(metres[row]), LARGE, "ra")

    return Panel(EDGE, HEIGHT - EDGE - height, still, write)


def _lamp(draw: Draw, foot: int, leg: str, colour: Colour, touches: bool) -> None:
    """A numbered disc, filled while the foot touches the floor."""
    x, y = PAD + LAMP + 3 * LAMP * foot, BAR - PAD - LAMP
    place = (x - LAMP, y - LAMP, x + LAMP, y + LAMP)
    draw.ellipse(place, fill=colour if touches else None, outline=colour, width=2)
    text(draw, (x, y), leg, 14, "mm", colour.ink if touches else palette.TEXT)


def describe(flow: WalkedPhase, groups: Sequence[str], legs_per_group: int) -> str:
    """One clause for each group, those that do the same named together.

    For example `tripod 1 stands, tripod 2 swings in the air`.
    """
    doing: dict[str, list[str]] = {}
    for group in groups:
        rests = group not in flow.group or flow.kind == "hold"
        verbs = VERBS["hold" if rests else flow.kind]
        doing.setdefault(verbs[group in flow.stratum], []).append(group)
    clauses = []
    for verb, (*others, last) in doing.items():
        names = f"s {', '.join(others)} and {last}" if others else f" {last}"
        words = verb.format(s="" if others else "s")
        clauses.append(f"{noun(legs_per_group)}{names} {words}")
    return ", ".join(clauses)


def scale_bar(view: Camera, reach: float, bottom: int) -> Panel:
    """The panel at the right, above the bar of numbers: one cell of the grid."""
    metres, words = cell(reach), f"{1000 * cell(reach):g} mm on the floor here"
    tilt = np.radians(view.elevation)
    above = (HEIGHT / 2 - bottom + SCALE // 3) * view.pixel  # at a distance of one
    # How deep in the picture the ray through this height meets the floor.
    depth = -view.eyes()[0, 2] / (np.sin(tilt) + above * np.cos(tilt))
    bar = round(float(metres / (view.pixel * depth)))
    width = max(bar, length(words)) + 2 * PAD
    still, draw = empty(width, SCALE)
    text(draw, (width - PAD, 6), words, anchor="ra", colour=palette.FAINT)
    left, right, y = width - PAD - bar, width - PAD, SCALE - 15
    draw.line((left, y, right, y), palette.TEXT, 3)
    for x in (left, right):
        draw.line((x, y - TICK, x, y + TICK), palette.TEXT, 3)
    return Panel(WIDTH - EDGE - width, bottom - SCALE, still, lambda draw, row: None)
