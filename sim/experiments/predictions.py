"""The predictions by name: for steering walks and for comparison with them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import lru_cache

from models import IdealTwists, QuasiStaticTwists, TwistModel
from sim.experiments.identification import identify
from sim.preparation.setup import Setup, prepare

STATIC = 3  # feet at most whose loads follow from the weight alone


def _quasi_static(setup: Setup) -> TwistModel:
    return QuasiStaticTwists(setup.kinematics, setup.ground, setup.limits.swing_speed)


def _identified(setup: Setup) -> TwistModel:
    """Measured without obstacles, which would disturb the experiments."""
    if not setup.scenario.obstacles:
        return identify(setup)
    return identify(prepare(replace(setup.scenario, obstacles=()), setup.robot))


MODELS: Mapping[str, Callable[[Setup], TwistModel]] = {
    "ideal": lambda setup: IdealTwists(setup.equations),
    "quasi_static": _quasi_static,
    "identified": _identified,
}


@lru_cache(maxsize=len(MODELS))
def twist_model(setup: Setup, name: str) -> TwistModel:
    """A prediction's twist model, made when first asked for."""
    return MODELS[name](setup)


def follows_commands(setup: Setup, name: str, strata: Collection[str]) -> bool:
    """Whether a prediction is the same for all frictions, servos and floors.

    The quasi-static one is where no more than three feet stand at a time.
    """
    feet = max((setup.robot.planted(on).sum() for on in strata), default=0)
    return name == "ideal" or (name == "quasi_static" and feet <= STATIC)
