"""Views that a film can be taken from, by name or by two angles."""

from __future__ import annotations

import math
from dataclasses import dataclass

from planner.support import did_you_mean
from sim.errors import UsageError

ELEVATION = -50.0  # [degrees]
FARTHEST = 7.0  # in units of the robot's reach; beyond, the camera follows
CLOSE = 3.5
STEEPEST, FLATTEST = -89.9, -5.0  # [degrees]; the floor hides all from below


@dataclass(frozen=True, slots=True)
class View:
    """From where a film is taken.

    Attributes:
        azimuth: Direction in which the camera looks, 0 along x and 90 along y
            [degrees]; None looks across the path.
        elevation: Below the horizon, negative [degrees].
        farthest: Largest distance, in units of the robot's reach; where the whole walk
            does not fit, the camera follows the robot.
    """

    azimuth: float | None = None
    elevation: float = ELEVATION
    farthest: float = FARTHEST


ACROSS = View()
VIEWS = {
    "across": ACROSS,
    "follow": View(farthest=CLOSE),
    "top": View(90.0, STEEPEST),
    "front": View(180.0, -25.0),
    "back": View(0.0, -25.0),
    "left": View(-90.0, -25.0),
    "right": View(90.0, -25.0),
}
"""Named views; sides are those of the robot at the start."""


def view_of(text: str) -> View:
    """The view of a name, or of two angles in degrees, `AZIMUTH,ELEVATION`.

    Raises:
        UsageError: If it is neither, or looks up from below the floor.
    """
    if text in VIEWS:
        return VIEWS[text]
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        remedy = f"{did_you_mean(text, [*VIEWS])}; or give AZIMUTH,ELEVATION in degrees"
        raise UsageError(f"unknown camera {text!r}", "film", remedy) from None
    if not (math.isfinite(azimuth) and -90 <= elevation <= FLATTEST):
        what = f"camera {text!r} does not see the floor"
        raise UsageError(
            what, "film", f"give an elevation from -90 to {FLATTEST:g} degrees"
        )
    return View(azimuth, max(elevation, STEEPEST))
