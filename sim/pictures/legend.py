"""The legend of a film: the meaning of every colour and sign in it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from sim.pictures import relief, style
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.floor import cell
from sim.pictures.panel import EDGE, LARGE, PAD, Draw, Panel, empty, length, text
from sim.pictures.stratum_caption import noun
from sim.pictures.style import Colour

LINE, SWATCH = 25, 34  # height of a line, width of its sample [pixels]
TITLE = 86  # height of what is above the lines [pixels]

Sample = Callable[[Draw, int, Colour], None]


def legend(walk: FilmedWalk) -> Panel:
    """The panel at the top left: the walk, and the meaning of the colours."""
    scenario, entries = walk.scenario, _entries(walk)
    robot = Path(scenario.robot).stem  # of a user's own, the file
    about = f"{robot}, {scenario.fields} fields, {walk.segments} segments"
    labels = [length(label) + SWATCH for label, _, _ in entries]
    still, draw = empty(
        max(length(about), length(scenario.name, LARGE), *labels) + 2 * PAD,
        TITLE - 2 + LINE * len(entries),
    )
    text(draw, (PAD, 10), scenario.name, LARGE)
    text(draw, (PAD, 46), about, colour=style.FAINT)
    for i, (label, colour, sample) in enumerate(entries):
        y = TITLE + i * LINE
        sample(draw, y, colour)
        text(draw, (PAD + SWATCH, y), label, anchor="lm")
    return Panel(EDGE, EDGE, still, lambda draw, row: None)


def _entries(walk: FilmedWalk) -> list[tuple[str, Colour, Sample]]:
    """Label, colour and sample of every line of the legend."""
    groups = noun(walk.legs_per_group)
    around: list[tuple[str, Colour, Sample]] = [
        ("obstacles", style.OBSTACLE, _block),
        ("floor swept over", style.SWEPT, _block),
    ]
    heights = f", contours {1000 * relief.step(walk):.3g} mm"
    return [
        *(around if walk.scenario.obstacles else []),
        ("outline of the robot", style.OUTLINE, _line),
        *([("nose, the front", walk.nose, _block)] if walk.nose else []),
        ("nominal path", style.NOMINAL, _dashes),
        ("goal", style.NOMINAL, _ring),
        *((name, style.PREDICTED[i], _line) for i, name in enumerate(walk.predicted)),
        ("achieved path", style.ACHIEVED, _line),
        ("centre of mass", style.WEIGHT, _disc),
        ("support polygon", style.STABLE, _area),
        *(
            (f"footprints of {groups} {group}", style.footprint(i), _disc)
            for i, group in enumerate(walk.groups)
        ),
        (
            f"grid, {1000 * cell(walk.reach):g} mm"
            + (heights if walk.scenario.bumps else ""),
            style.GRID,
            _mesh,
        ),
    ]


def _line(draw: Draw, y: int, colour: Colour) -> None:
    draw.line((PAD, y, PAD + 24, y), colour, 4)


def _dashes(draw: Draw, y: int, colour: Colour) -> None:
    for x in range(PAD, PAD + 24, 9):
        draw.line((x, y, x + 6, y), colour, 4)


def _disc(draw: Draw, y: int, colour: Colour) -> None:
    draw.ellipse((PAD + 5, y - 7, PAD + 19, y + 7), fill=colour)


def _ring(draw: Draw, y: int, colour: Colour) -> None:
    draw.ellipse((PAD + 4, y - 8, PAD + 20, y + 8), style.PAPER, colour, 3)


def _mesh(draw: Draw, y: int, colour: Colour) -> None:
    for x in (PAD + 6, PAD + 18):
        draw.line((x, y - 9, x, y + 9), colour, 2)
    for height in (y - 5, y + 5):
        draw.line((PAD, height, PAD + 24, height), colour, 2)


def _block(draw: Draw, y: int, colour: Colour) -> None:
    draw.rectangle((PAD, y - 7, PAD + 24, y + 7), colour)


def _area(draw: Draw, y: int, colour: Colour) -> None:
    draw.rectangle((PAD, y - 7, PAD + 24, y + 7), (*colour, 90), colour, 2)
