"""The verdict on a run in plain sentences, from its summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MM = 1e3


def word(summary: Mapping[str, Any]) -> str:
    """The verdict in one word; a run of an older version was not judged."""
    return str(summary.get("verdict", "not judged"))


def sentences(summary: Mapping[str, Any]) -> list[str]:
    """What became of the walk, the most important first."""
    text = str(summary.get("verdict_text", "not judged"))
    achieved = summary["achieved"]
    return [text[:1].upper() + text[1:] + ".", _margin(achieved), _slip(achieved)]


def _margin(achieved: Mapping[str, Any]) -> str:
    least = MM * achieved["min_margin"]
    if least >= 0:
        return (
            f"Its centre of mass was never less than {least:.1f} mm inside its support."
        )
    return f"Its centre of mass was up to {-least:.1f} mm outside its support."


def _slip(achieved: Mapping[str, Any]) -> str:
    slipped = f"Its feet slipped {MM * achieved['slip']:.1f} mm in all"
    if (floor := achieved["creep_floor"]) is None:
        return f"{slipped}."
    return f"{slipped}; {MM * floor:.2g} mm of that is the solver's creep."
