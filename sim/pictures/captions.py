"""Captions of a film: clock, stratum, contacts, margin, errors, scales and cards.

The inset shows the error of the body's position off each prediction, magnified for
itself, so that a small error is seen beside a large one. Errors are turned with the
picture: right is right in the film.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

from planner import Array
from sim import palette
from sim.evaluation.flows import WalkedPhase
from sim.evaluation.quantities import ACHIEVED, OF_ROWS, OF_WALKS
from sim.motion.poses import spaced_rows
from sim.palette import Colour
from sim.pictures.camera import HEIGHT, WIDTH, Camera
from sim.pictures.clock import Clock
from sim.pictures.ghost import ghost_of
from sim.pictures.legend import (
    EDGE,
    LARGE,
    MIDDLE,
    PAD,
    Draw,
    Panel,
    empty,
    fitting,
    legend,
    length,
    noun,
    text,
)
from sim.pictures.marks import cell
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

GAP = 10  # between panels [pixels]
BAR = 92  # height of the bar at the bottom [pixels]
LAMP = 11  # radius of a foot's lamp [pixels]
COLUMN = 180  # width of a number in the bar [pixels]
SCALE = 50  # height of the scale bar's panel [pixels]
TICK = 5  # half the height of the scale bar's ends [pixels]
VEIL = (0.6, 0.92), (0.92, 0.45)  # share of the width, share of paper over a picture
HEADLINE, STEP, MARGIN = 48, 38, 150  # of cards: type, lines, left edge [pixels]
RESULTS = (
    "path_length",
    "distance_walked",
    "predicted.*.slip",
    "predicted.*.min_margin",
)
VERBS = {  # of a group in the air, of one on the ground
    "hold": ("wait{s} in the air", "stand{s}"),
    "swing": ("swing{s} in the air", "swing{s} the body"),
    "lift": ("lift{s}", "lift{s}"),
    "land": ("land{s}", "land{s}"),
}
TOP, BOX, APART = 60, 128, 16  # of the inset: words above a plot, its side, the next
PLOTS = 2
DOT, CROSS = 4, 5  # of the present error, and of no error [pixels]
TRAIL_STEP = 1.0  # between points of a trail [pixels]
FILL = 0.92  # of half the plot, at most, for the largest error
NOTHING = 1e-9  # [m], below which an error is rounding
DIGITS = np.array([1.0, 2.0, 5.0])


class Captions:
    """Writes on the pictures of one film, and draws its two cards."""

    def __init__(self, walk: Run, clock: Clock, view: Camera) -> None:
        key, scale = legend(walk), scale_bar(view, walk.reach)
        error = inset(walk, view, key.bottom + GAP)
        self._panels = (key, scale, error, _bar(walk, clock.playback))
        self._walk, self._clock = walk, clock

    def write(self, picture: Array, row: int) -> None:
        """Write on the picture of a row, shape (HEIGHT, WIDTH, 3), bytes, in place."""
        for panel in self._panels:
            panel.put(picture, row)

    def lay_card(self, picture: Array, frame: int) -> None:
        """Lay the title, or the results, over the robot before or after its walk."""
        is_first = frame < self._clock.scene.start
        words = _title(self._walk) if is_first else _results(self._walk)
        picture[:] = _card(words, picture)


def _title(walk: Run) -> list[str]:
    scenario = walk.scenario
    steered = f"{scenario.fields} fields, {walk.segments} segments"
    what = scenario.description or ("played" if scenario.motion else steered)
    plan = [
        "Legs that can only swing and lift; a plan made of Lie brackets",
        "after Goodwine and Burdick, IROS 2000; physics by MuJoCo",
    ]
    about = ["Motion from elsewhere; physics by MuJoCo"] if scenario.motion else plan
    return [scenario.name, f"{Path(scenario.robot).stem}: {what}", "", *about]


def _results(walk: Run) -> list[str]:
    summary = walk.summary
    head, *further = summary.verdict_text.split("; ")
    found = [
        f"{q.label}: {q.words(value)}"
        for q in (*OF_WALKS, *(q for q in OF_ROWS if q.key.startswith("predicted")))
        if q.key in RESULTS and (value := q.value(summary, ACHIEVED)) is not None
    ]
    said = head.removeprefix(summary.verdict).lstrip(": ")
    return [f"{walk.scenario.name}: {summary.verdict}", said, *further, "", *found]


def _card(lines: Sequence[str], behind: Array) -> Array:
    """A headline, and lines below it, on a picture that fades to the left."""
    veil = np.interp(np.linspace(0, 1, WIDTH), *VEIL)[:, np.newaxis]
    picture = Image.fromarray(np.uint8(veil * palette.PAPER + (1 - veil) * behind))
    draw = ImageDraw.Draw(picture)
    headline, *rest = (fitting(line, WIDTH - 2 * MARGIN, MIDDLE) for line in lines)
    y = HEIGHT // 2 - (HEADLINE + STEP * len(rest)) // 2
    text(draw, (MARGIN, y), headline, HEADLINE)
    for number, line in enumerate(rest):
        colour = palette.FAINT if number else palette.TEXT
        place = MARGIN, y + 2 * HEADLINE + STEP * number
        text(draw, place, line, MIDDLE, colour=colour)
    return np.array(picture)


def _bar(walk: Run, playback: float) -> Panel:
    """At the bottom: stratum, feet in contact, present measurements and the time."""
    width, height = WIDTH - 2 * EDGE, BAR
    still, draw = empty(width, height)
    first = ghost_of(walk)
    off = np.hypot(*(walk.achieved - walk.predicted[first])[:, :2].T)
    label = f"off {PREDICTIONS[first].label}"
    numbers = {"stability margin": walk.margin, label: off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    speed = "at real speed" if playback == 1 else f"at {playback:g}x real speed"
    ends = [width - PAD - i * COLUMN for i in range(len(numbers) + 1)]
    for end, label in zip(ends, (speed, *numbers), strict=True):
        text(draw, (end, 54), label, anchor="ra", colour=palette.FAINT)

    def write(draw: Draw, row: int) -> None:
        words = describe(walk.phases[walk.phase[row]], walk.groups, walk.legs_per_group)
        text(draw, (PAD, 12), fitting(words, ends[-1] - COLUMN - PAD, MIDDLE), MIDDLE)
        for foot, leg in enumerate(walk.legs):
            colour = palette.group(walk.group_of_foot[foot])
            _lamp(draw, foot, str(leg), colour, touches=walk.contact[row, foot])
        values = (_millimetres(metres[row]) for metres in numbers.values())
        for end, value in zip(ends, (f"{walk.time[row]:.1f} s", *values), strict=True):
            text(draw, (end, 14), value, LARGE, "ra")

    return Panel(EDGE, HEIGHT - EDGE - height, still, write)


def _millimetres(metres: float) -> str:
    return f"{1000 * metres:.1f} mm" if np.isfinite(metres) else "none"


def _lamp(draw: Draw, foot: int, leg: str, colour: Colour, touches: bool) -> None:
    """A numbered disc, filled while the foot touches the floor."""
    x, y = PAD + LAMP + 3 * LAMP * foot, BAR - PAD - LAMP
    place = (x - LAMP, y - LAMP, x + LAMP, y + LAMP)
    draw.ellipse(place, fill=colour if touches else None, outline=colour, width=2)
    text(draw, (x, y), leg, 14, "mm", colour.ink if touches else palette.TEXT)


def describe(flow: WalkedPhase, groups: Sequence[str], legs_per_group: int) -> str:
    """A clause for groups that do the same: `tripod 1 stands, tripod 2 lifts`."""
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


def scale_bar(
    view: Camera, reach: float, bottom: int = HEIGHT - EDGE - BAR - GAP
) -> Panel:
    """The panel at the left, above the bar of numbers: one cell of the grid."""
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
    return Panel(EDGE, bottom - SCALE, still, lambda draw, row: None)


@dataclass(frozen=True)
class Trail:
    """The departure from one prediction in the course of a walk, and its plot."""

    colour: Colour
    error: Array  # to the right and up in the picture, (T, 2) [m]
    scale: float  # pixels to a metre
    left: int  # of the plot [pixels]

    @cached_property
    def rows(self) -> Array:
        """Rows at which the trail has come another step farther."""
        return spaced_rows(self.error, TRAIL_STEP / self.scale)

    @cached_property
    def points(self) -> list[tuple[float, float]]:
        """Where those are in the panel."""
        return [self.place(error) for error in self.error[self.rows]]

    def place(self, error: Sequence[float] | Array = (0.0, 0.0)) -> tuple[float, float]:
        """Where an error is in the panel, or where there is none [pixels]."""
        middle = (self.left + BOX / 2, TOP + BOX / 2)
        x, y = middle + np.asarray(error) * self.scale * (1, -1)
        return float(x), float(y)

    def put(self, draw: Draw, row: int) -> None:
        """Draw the trail up to a row, its end as a dot, and its length in words."""
        past = self.points[: int(np.searchsorted(self.rows, row, side="right"))]
        x, y = self.place(self.error[row])
        draw.line([*past, (x, y)], self.colour.tint(0.6), 1)
        draw.ellipse((x - DOT, y - DOT, x + DOT, y + DOT), self.colour)
        size = f"{1000 * np.hypot(*self.error[row]):.2f}"
        text(draw, (self.left + BOX, TOP + BOX + 4), size, anchor="ra")

    def draw_scale(self, draw: Draw) -> None:
        """A cross where there is no error, and a ring at a round distance from it."""
        (x, y), ring = self.place(), _greatest_round(BOX / 2 * FILL / self.scale)
        left, radius = self.left, ring * self.scale
        draw.rectangle((left, TOP, left + BOX, TOP + BOX), None, palette.GRID, 1)
        around = (x - radius, y - radius, x + radius, y + radius)
        draw.ellipse(around, None, palette.FAINT, 1)
        draw.line((x - CROSS, y, x + CROSS, y), palette.FAINT, 1)
        draw.line((x, y - CROSS, x, y + CROSS), palette.FAINT, 1)
        text(draw, (left, TOP + BOX + 4), f"ring {1000 * ring:g}", colour=palette.FAINT)


def inset(walk: Run, view: Camera, top: int) -> Panel:
    """The panel of errors, whose upper edge is at `top` [pixels]."""
    floor = 1 / (view.pixel * view.distance)  # pixels to a metre, about
    still, draw = empty(2 * PAD + PLOTS * BOX + APART, TOP + BOX + 28)
    text(draw, (PAD, 8), "error of the body's position [mm]", colour=palette.FAINT)
    angle = np.radians(view.azimuth.mean())
    right, away = (np.sin(angle), -np.cos(angle)), (np.cos(angle), np.sin(angle))
    trails = []
    for i, (name, poses) in enumerate([*walk.drawn.items()][:PLOTS]):
        error = np.nan_to_num((walk.achieved - poses)[:, :2])
        error, left = error @ np.transpose([right, away]), PAD + i * (BOX + APART)
        factor = magnification(float(np.hypot(*error.T).max()), BOX / 2 * FILL / floor)
        trail = Trail(palette.PREDICTED[name].colour, error, factor * floor, left)
        label = PREDICTIONS[name].label if name in PREDICTIONS else name
        text(draw, (left, 32), f"{label}, {factor:g}x", colour=trail.colour)
        trail.draw_scale(draw)
        trails.append(trail)

    def write(draw: Draw, row: int) -> None:
        for trail in trails:
            trail.put(draw, row)

    return Panel(EDGE, top, still, write)


def magnification(largest: float, room: float) -> float:
    """The greatest round factor that fits the largest error into a room [m]."""
    return _greatest_round(room / max(largest, NOTHING))


def _greatest_round(most: float) -> float:
    """The greatest of 1, 2, 5 times a power of ten that is not above a number."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(power * DIGITS[power * DIGITS <= most * (1 + 1e-9)].max())
