"""Whether a measured prediction holds for a walk that it was not made from.

It was made from single strokes, and the walk is other strokes, often several at a time.
"""

from __future__ import annotations

from collections.abc import Mapping

from planner import Array
from sim.evaluation.deviations import NEAR, Scale
from sim.preparation.setup import Setup
from sim.scenarios.predictions import IDENTIFIED, PREDICTIONS

UNLIKE = 2.0  # times the distance from the walk of the prediction that judges it


def left_out(setup: Setup, poses: Mapping[str, Array]) -> dict[str, str]:
    """Predictions that do not hold for a walk, and why; not the one it is steered on.

    Given are poses of what was `achieved` and of the predictions, (T, 3) each.
    """
    scenario, name = setup.scenario, IDENTIFIED.key
    if name not in poses or scenario.steered_on == name:
        return {}
    scale = Scale.of(scenario.path, setup.kinematics.reach, poses)
    why = does_not_hold(scale, name, poses)
    return {name: why} if why else {}


def does_not_hold(scale: Scale, name: str, poses: Mapping[str, Array]) -> str:
    """Why a measured prediction does not hold for a walk; empty if it does."""
    achieved, judge = poses["achieved"], scale.prediction
    off, usual = (scale.share(achieved, poses[key]) for key in (name, judge))
    if off <= max(NEAR, UNLIKE * usual):
        return ""
    label = PREDICTIONS[judge].label
    return (
        f"left out: made from single strokes, it is up to {100 * off:.1f} % of the "
        f"path off this walk, and the {label} one {100 * usual:.1f} %"
    )
