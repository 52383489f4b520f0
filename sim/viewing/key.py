"""The key of viewer and replay: the meaning of their colours."""

from __future__ import annotations

from html import escape

from sim.pictures import style
from sim.pictures.filmed_walk import FilmedWalk
from sim.pictures.stratum_caption import noun
from sim.pictures.style import Colour

BOX = (
    "position: fixed; top: 12px; right: 12px; max-width: 45vw; padding: 8px 12px; "
    "border-radius: 6px; background: rgba(255, 255, 255, 0.85); color: #212936; "
    "font: 13px/1.6 system-ui, sans-serif"
)
MARK = (
    "display: inline-block; width: 14px; height: 6px; margin-right: 6px; "
    "vertical-align: middle; background: rgb{}"
)


def key(walk: FilmedWalk, playback: float) -> str:
    """The key as an element of the page; it can be folded up.

    Args:
        walk: What is replayed.
        playback: Speed of the replay, in times real time.
    """
    lines = "".join(
        f'<div><span style="{MARK.format(colour)}"></span>{escape(label)}</div>'
        for label, colour in entries(walk)
    )
    scenario = walk.scenario
    speed = "in real time" if playback == 1 else f"{playback:g} times real time"
    title = escape(f"{scenario.name}, {speed}")
    return f'<details open style="{BOX}"><summary>{title}</summary>{lines}</details>'


def entries(walk: FilmedWalk) -> list[tuple[str, Colour]]:
    """Each thing that is drawn, with its colour.

    Args:
        walk: What is shown.
    """
    groups = noun(walk.legs_per_group)
    return [
        *([("nose, the front", walk.nose)] if walk.nose else []),
        ("nominal path, and a ring at its goal", style.NOMINAL),
        *((name, style.PREDICTED[i]) for i, name in enumerate(walk.predicted)),
        ("achieved path", style.ACHIEVED),
        ("support polygon", style.STABLE),
        ("support polygon, weight outside", style.TIPPING),
        *(
            (f"legs of {groups} {group}, and paler their footprints", style.group(i))
            for i, group in enumerate(walk.groups)
        ),
    ]
