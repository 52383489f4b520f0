"""Captions of a film: clock, stratum, contacts, margin, errors, scales and cards."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import wrap

import numpy as np
from PIL import Image, ImageDraw

from planner import Array
from sim import palette
from sim.evaluation.flows import WalkedPhase
from sim.evaluation.quantities import ACHIEVED, OF_ROWS, OF_WALKS
from sim.pictures import legend
from sim.pictures.camera import FILM, HEIGHT, WIDTH, Camera
from sim.pictures.clock import Clock
from sim.pictures.ghost import ghost_of
from sim.pictures.inset import inset
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
LETTERS = 44  # of a line of a card, which ends beside the robot
CARDS: Mapping[str, list[str]] = FILM["cards"]


class Captions:
    """Writes on the pictures of one film, and draws its two cards."""

    def __init__(self, walk: Run, clock: Clock, view: Camera) -> None:
        key = legend.legend(walk, 1 / (view.pixel * view.distance))
        scale = scale_bar(view, walk.reach)
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
    about = CARDS["played" if scenario.motion else "planned"]
    return [scenario.name, f"{Path(scenario.robot).stem}: {what}", "", *about]


def _results(walk: Run) -> list[str]:
    summary = walk.summary
    head, *further = summary.verdict_text.split("; ")
    found = [
        f"{q.label}: {q.words(value)}"
        for q in (*OF_WALKS, *(q for q in OF_ROWS if q.key.startswith("predicted")))
        if q.key in CARDS["results"]
        and (value := q.value(summary, ACHIEVED)) is not None
    ]
    end = head.removeprefix(summary.verdict).lstrip(": ")
    normal = summary.verdict == "arrived" and not walk.scenario.motion
    slips = normal and summary.achieved.slip > summary.path_length
    why = CARDS["slipping"] if slips else []
    return [f"{walk.scenario.name}: {summary.verdict}", end, *further, "", *found, *why]


def _card(lines: Sequence[str], behind: Array) -> Array:
    """A headline, and lines below it, on a picture that fades to the left."""
    veil = np.interp(np.linspace(0, 1, WIDTH), *VEIL)[:, np.newaxis]
    picture = Image.fromarray(np.uint8(veil * palette.PAPER + (1 - veil) * behind))
    draw = ImageDraw.Draw(picture)
    headline, *rest = lines
    rest = [part for line in rest for part in wrap(line, LETTERS) or [""]]
    y = HEIGHT // 2 - (HEADLINE + STEP * len(rest)) // 2
    words = legend.fitting(headline, WIDTH - 2 * MARGIN, HEADLINE)
    legend.text(draw, (MARGIN, y), words, HEADLINE)
    for number, line in enumerate(rest):
        colour = palette.TEXT if number < rest.index("") else palette.FAINT
        place = MARGIN, y + 2 * HEADLINE + STEP * number
        legend.text(draw, place, line, legend.MIDDLE, colour=colour)
    return np.array(picture)


def _bar(walk: Run, playback: float) -> legend.Panel:
    """At the bottom: stratum, feet in contact, present measurements and the time."""
    width, height = WIDTH - 2 * legend.EDGE, BAR
    still, draw = legend.empty(width, height)
    first = ghost_of(walk)
    off = np.hypot(*(walk.achieved - walk.predicted[first])[:, :2].T)
    label = f"off {PREDICTIONS[first].label}"
    numbers = {"stability margin": walk.margin, label: off}
    if walk.clearance is not None:
        numbers["clear of obstacles"] = walk.clearance
    speed = "at real speed" if playback == 1 else f"at {playback:g}x real speed"
    ends = [width - legend.PAD - i * COLUMN for i in range(len(numbers) + 1)]
    for end, label in zip(ends, (speed, *numbers), strict=True):
        legend.text(draw, (end, 54), label, anchor="ra", colour=palette.FAINT)

    noun, lamps = legend.noun(walk), [*map(palette.group, walk.group_of_foot)]

    def write(draw: legend.Draw, row: int) -> None:
        words = describe(walk.phases[walk.phase[row]], walk.card.groups, noun)
        words = legend.fitting(words, ends[-1] - COLUMN - legend.PAD, legend.MIDDLE)
        legend.text(draw, (legend.PAD, 12), words, legend.MIDDLE)
        for foot, leg in enumerate(walk.legs):  # a disc, filled while it touches
            colour, touches = lamps[foot], walk.contact[row, foot]
            x, y = legend.PAD + LAMP + 3 * LAMP * foot, height - legend.PAD - LAMP
            draw.circle((x, y), LAMP, colour if touches else None, colour, 2)
            ink = colour.ink if touches else palette.TEXT
            legend.text(draw, (x, y), str(leg), 14, "mm", ink)
        shown = (metres[row] for metres in numbers.values())
        values = (f"{1000 * m:.1f} mm" if np.isfinite(m) else "none" for m in shown)
        for end, value in zip(ends, (f"{walk.time[row]:.1f} s", *values), strict=True):
            legend.text(draw, (end, 14), value, legend.LARGE, "ra")

    return legend.Panel(legend.EDGE, HEIGHT - legend.EDGE - height, still, write)


def describe(flow: WalkedPhase, groups: Iterable[str], noun: str) -> str:
    """A clause for groups that do the same: `tripod 1 stands, tripod 2 lifts`."""
    doing: dict[str, list[str]] = {}
    for group in groups:
        rests = group not in flow.group or flow.kind == "hold"
        verbs = FILM["verbs"]["hold" if rests else flow.kind]
        doing.setdefault(verbs[group in flow.stratum], []).append(group)
    clauses = []
    for verb, (*others, last) in doing.items():
        names = f"s {', '.join(others)} and {last}" if others else f" {last}"
        words = verb.format(s="" if others else "s")
        clauses.append(f"{noun}{names} {words}")
    return ", ".join(clauses)


def scale_bar(view: Camera, reach: float) -> legend.Panel:
    """The panel at the left, above the bar of numbers: one cell of the grid."""
    metres, words = cell(reach), f"{1000 * cell(reach):g} mm on the floor here"
    tilt = np.radians(view.elevation)
    bottom = HEIGHT - legend.EDGE - BAR - GAP
    above = (HEIGHT / 2 - bottom + SCALE // 3) * view.pixel  # at a distance of one
    # How deep in the picture the ray through this height meets the floor.
    depth = -view.eyes()[0, 2] / (np.sin(tilt) + above * np.cos(tilt))
    bar = round(float(metres / (view.pixel * depth)))
    width = max(bar, legend.length(words)) + 2 * legend.PAD
    still, draw = legend.empty(width, SCALE)
    legend.text(draw, (width - legend.PAD, 6), words, anchor="ra", colour=palette.FAINT)
    left, right, y = width - legend.PAD - bar, width - legend.PAD, SCALE - 15
    draw.line((left, y, right, y), palette.TEXT, 3)
    for x in (left, right):
        draw.line((x, y - TICK, x, y + TICK), palette.TEXT, 3)
    return legend.Panel(legend.EDGE, bottom - SCALE, still, lambda draw, row: None)
