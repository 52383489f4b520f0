"""The legend of film, viewer and replay: the meaning of every colour and sign."""

from __future__ import annotations

from pathlib import Path

import mujoco

from sim import palette
from sim.palette import NOMINAL, PREDICTED, Colour
from sim.pictures.floor import contour_step
from sim.pictures.ghost import ghost_of
from sim.pictures.panel import EDGE, LARGE, PAD, Draw, Panel, empty, fitting, text
from sim.runs.run import Run

LINE, SWATCH = 25, 34  # height of a line, width of its sample [pixels]
NOSE = "nose"  # geom on the front of the shipped robots
ENTRIES, WIDE = 6, 304  # lines; width [pixels]
TITLE = 86  # height of what is above the lines [pixels]
NOUNS = {1: "leg", 2: "pair", 3: "tripod", 4: "tetrapod"}  # by legs in a group


def legend(walk: Run) -> Panel:
    """The panel at the top left: the walk, and the meaning of the colours."""
    scenario, lines = walk.scenario, _lines(walk)
    robot = Path(scenario.robot).stem  # of a user's own, the file
    about = f"{robot}, {scenario.fields} fields"
    still, draw = empty(WIDE, TITLE - 2 + LINE * len(lines))
    text(draw, (PAD, 10), fitting(scenario.name, WIDE - 2 * PAD, LARGE), LARGE)
    text(draw, (PAD, 46), fitting(about, WIDE - 2 * PAD), colour=palette.FAINT)
    for i, (label, colour, kind) in enumerate(lines):
        y = TITLE + i * LINE
        _sample(draw, kind, y, colour)
        text(draw, (PAD + SWATCH, y), label, anchor="lm")
    return Panel(EDGE, EDGE, still, lambda draw, row: None)


def entries(walk: Run) -> list[tuple[str, Colour]]:
    """Labels and colours of what viewer and replay show."""
    paths = [palette.NOMINAL, *(palette.PREDICTED[name] for name in walk.drawn)]
    groups, front = noun(walk.legs_per_group), nose(walk)
    return [
        *([("nose, the front", front)] if front else []),
        *((mark.label, mark.colour) for mark in (*paths, palette.ACHIEVED)),
        ("goal", palette.NOMINAL.colour),
        ("support polygon", palette.STABLE),
        ("support polygon, weight outside", palette.LIMIT),
        *(
            (f"legs of {groups} {group}, and paler their footprints", palette.group(i))
            for i, group in enumerate(walk.groups)
        ),
    ]


def noun(legs_per_group: int) -> str:
    """What a group of so many legs is called; 0 where the groups differ."""
    return NOUNS.get(legs_per_group, "group")


def nose(walk: Run) -> Colour | None:
    """Colour of the part that shows which side of the robot is the front, if any."""
    geoms = mujoco.MjSpec.from_file(str(walk.model_file)).geoms
    for rgba in (geom.rgba for geom in geoms if geom.name == NOSE):
        return Colour(*(round(255 * part) for part in rgba[:3]))
    return None


def _lines(walk: Run) -> list[tuple[str, Colour, str]]:
    """Label, colour and kind of sample of every line of a film's legend."""
    paths, own = {name: PREDICTED[name] for name in walk.drawn}, ghost_of(walk)
    ghost = {own: f"{PREDICTED[own].label}, ghost"}
    around = ("floor swept over", palette.SWEPT, "block")
    thought = (palette.THOUGHT.label, palette.THOUGHT.colour, "ring")
    bumps = f"contours, {1000 * contour_step(walk):.3g} mm"
    lines = [
        ("nominal path, goal", NOMINAL.colour, "dashes"),
        *((ghost.get(n, m.label), m.colour, "line") for n, m in paths.items()),
        (palette.ACHIEVED.label, palette.ACHIEVED.colour, "line"),
        ("support, centre of mass", palette.STABLE, "area"),
        *([thought] if walk.thought else []),
        *([around] if walk.scenario.obstacles else []),
        *([(bumps, palette.RELIEF, "line")] if walk.scenario.bumps else []),
        ("footprints, fading", palette.group(0).tint(0.6), "disc"),
    ]
    return lines[:ENTRIES]


def _sample(draw: Draw, kind: str, y: int, colour: Colour) -> None:
    """Draw how a meaning looks, at the left of its line."""
    left, right = PAD, PAD + 24
    match kind:
        case "line":
            draw.line((left, y, right, y), colour, 4)
        case "dashes":
            for x in range(left, right, 9):
                draw.line((x, y, x + 6, y), colour, 4)
        case "disc":
            draw.ellipse((left + 5, y - 7, left + 19, y + 7), fill=colour)
        case "ring":
            draw.ellipse((left + 4, y - 8, left + 20, y + 8), palette.PAPER, colour, 3)
        case "block":
            draw.rectangle((left, y - 7, right, y + 7), colour)
        case "area":
            draw.rectangle((left, y - 7, right, y + 7), (*colour, 90), colour, 2)
            draw.ellipse((left + 8, y - 4, left + 16, y + 4), palette.CENTRE_OF_MASS)
