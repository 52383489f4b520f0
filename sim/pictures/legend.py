"""The legend of film, viewer and replay: the meaning of every colour and sign."""

from __future__ import annotations

from pathlib import Path

import mujoco

from sim import palette
from sim.palette import Colour
from sim.pictures.floor import cell, contour_step
from sim.pictures.panel import EDGE, LARGE, PAD, Draw, Panel, empty, length, text
from sim.runs.run import Run

LINE, SWATCH = 25, 34  # height of a line, width of its sample [pixels]
NOSE = "nose"  # geom on the front of the shipped robots
TITLE = 86  # height of what is above the lines [pixels]
NOUNS = {1: "leg", 2: "pair", 3: "tripod", 4: "tetrapod"}  # by legs in a group


def legend(walk: Run) -> Panel:
    """The panel at the top left: the walk, and the meaning of the colours."""
    scenario, lines = walk.scenario, _lines(walk)
    robot = Path(scenario.robot).stem  # of a user's own, the file
    about = f"{robot}, {scenario.fields} fields, {walk.segments} segments"
    labels = [length(label) + SWATCH for label, _, _ in lines]
    width = max(length(about), length(scenario.name, LARGE), *labels) + 2 * PAD
    still, draw = empty(width, TITLE - 2 + LINE * len(lines))
    text(draw, (PAD, 10), scenario.name, LARGE)
    text(draw, (PAD, 46), about, colour=palette.FAINT)
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
    groups, nominal = noun(walk.legs_per_group), palette.NOMINAL
    front, around = (
        nose(walk),
        (
            ("obstacles", palette.OBSTACLE, "block"),
            ("floor swept over", palette.SWEPT, "block"),
        ),
    )
    predicted = [palette.PREDICTED[name] for name in walk.drawn]
    squares = f"grid, {1000 * cell(walk.reach):g} mm"
    if walk.scenario.bumps:
        squares += f", contours {1000 * contour_step(walk):.3g} mm"
    return [
        *(around if walk.scenario.obstacles else []),
        ("outline of the robot", palette.OUTLINE, "line"),
        *([("nose, the front", front, "block")] if front else []),
        (nominal.label, nominal.colour, "dashes"),
        ("goal", nominal.colour, "ring"),
        *((mark.label, mark.colour, "line") for mark in (*predicted, palette.ACHIEVED)),
        *(
            [(palette.THOUGHT.label, palette.THOUGHT.colour, "ring")]
            if walk.thought
            else []
        ),
        ("centre of mass", palette.CENTRE_OF_MASS, "disc"),
        ("support polygon", palette.STABLE, "area"),
        *(
            (f"footprints of {groups} {group}", palette.footprint(i), "disc")
            for i, group in enumerate(walk.groups)
        ),
        (squares, palette.GRID, "mesh"),
    ]


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
        case "mesh":
            for x, height in ((left + 6, y - 5), (left + 18, y + 5)):
                draw.line((x, y - 9, x, y + 9), colour, 2)
                draw.line((left, height, right, height), colour, 2)
        case "block":
            draw.rectangle((left, y - 7, right, y + 7), colour)
        case "area":
            draw.rectangle((left, y - 7, right, y + 7), (*colour, 90), colour, 2)
