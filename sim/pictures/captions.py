"""Captions of a film: key, clock, stratum, contacts, margin, error and scales.

They stand on panels, whose constant parts are drawn once, the others on every picture.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from planner import Array
from sim import palette
from sim.evaluation.flows import WalkedPhase
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

GAP = 10  # between panels [pixels]
BAR = 92  # height of the bar at the bottom [pixels]
LAMP = 11  # radius of a foot's lamp [pixels]
COLUMN = 230  # width of a number in the bar [pixels]
SCALE = 50  # height of the scale bar's panel [pixels]
TICK = 5  # half the height of the scale bar's ends [pixels]

Verb = tuple[str, str]  # singular, plural
STANDS: Verb = ("stands", "stand")
WAITS: Verb = ("waits in the air", "wait in the air")
SWINGS_BODY: Verb = ("swings the body", "swing the body")
SWINGS: Verb = ("swings in the air", "swing in the air")
LIFTS: Verb = ("lifts", "lift")
LANDS: Verb = ("lands", "land")


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
    off = np.hypot(*(walk.achieved - walk.predicted["ideal"])[:, :2].T)
    numbers = {"stability margin": walk.margin, "off the ideal prediction": off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    ends = [width - PAD - i * COLUMN for i in range(len(numbers))]
    for end, label in zip(ends, numbers, strict=True):
        text(draw, (end, 54), label, anchor="ra", colour=palette.FAINT)

    def write(draw: Draw, row: int) -> None:
        flow = walk.phases[walk.phase[row]]
        words = describe(flow, walk.groups, walk.legs_per_group)
        text(draw, (PAD, 12), words, MIDDLE)
        for foot in range(len(walk.group_of_foot)):
            _lamp(draw, walk, row, foot, y=height - PAD - LAMP)
        for end, metres in zip(ends, numbers.values(), strict=True):
            text(draw, (end, 14), millimetres(metres[row]), LARGE, "ra")

    return Panel(EDGE, HEIGHT - EDGE - height, still, write)


def _lamp(draw: Draw, walk: Run, row: int, foot: int, y: int) -> None:
    """A numbered disc, filled while the foot touches the floor."""
    x = PAD + LAMP + 3 * LAMP * foot
    colour = palette.group(walk.group_of_foot[foot])
    touches = walk.contact[row, foot]
    place = (x - LAMP, y - LAMP, x + LAMP, y + LAMP)
    draw.ellipse(place, fill=colour if touches else None, outline=colour, width=2)
    number = str(sorted(walk.card.legs)[foot])
    text(draw, (x, y), number, 14, "mm", colour.ink if touches else palette.TEXT)


def describe(flow: WalkedPhase, groups: Sequence[str], legs_per_group: int) -> str:
    """One clause for each group, those that do the same named together.

    For example `tripod 1 stands, tripod 2 swings in the air`.
    """
    doing: dict[Verb, list[str]] = {}
    for group in groups:
        doing.setdefault(_verb(flow, group), []).append(group)
    return ", ".join(
        _clause(noun(legs_per_group), names, verb) for verb, names in doing.items()
    )


def _verb(flow: WalkedPhase, group: str) -> Verb:
    stands = group in flow.stratum
    if group not in flow.group or flow.kind == "hold":
        return STANDS if stands else WAITS
    if flow.kind == "swing":
        return SWINGS_BODY if stands else SWINGS
    return LIFTS if flow.kind == "lift" else LANDS


def _clause(noun: str, names: list[str], verb: Verb) -> str:
    one, several = verb
    if len(names) == 1:
        return f"{noun} {names[0]} {one}"
    return f"{noun}s {', '.join(names[:-1])} and {names[-1]} {several}"


def scale_bar(view: Camera, reach: float, bottom: int) -> Panel:
    """The panel at the right, above the bar of numbers: one cell of the grid."""
    metres, words = cell(reach), f"{1000 * cell(reach):g} mm on the floor here"
    bar = round(metres * _pixels_per_metre(view, bottom - SCALE // 3))
    width = max(bar, length(words)) + 2 * PAD
    still, draw = empty(width, SCALE)
    text(draw, (width - PAD, 6), words, anchor="ra", colour=palette.FAINT)
    left, right, y = width - PAD - bar, width - PAD, SCALE - 15
    draw.line((left, y, right, y), palette.TEXT, 3)
    for x in (left, right):
        draw.line((x, y - TICK, x, y + TICK), palette.TEXT, 3)
    return Panel(WIDTH - EDGE - width, bottom - SCALE, still, lambda draw, row: None)


def _pixels_per_metre(view: Camera, y: int) -> float:
    """Pixels that one metre across the picture takes on the floor at a height."""
    tilt = np.radians(view.elevation)
    above = (HEIGHT / 2 - y) * view.pixel  # the middle, at a distance of one
    eye = view.eyes()[0]
    # How deep in the picture the ray through this height meets the floor.
    depth = -eye[2] / (np.sin(tilt) + above * np.cos(tilt))
    return float(1 / (view.pixel * depth))
