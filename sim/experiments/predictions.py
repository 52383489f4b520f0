"""The predictions by name: for steering walks and for comparison with them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache

from models import IdealTwists, QuasiStaticTwists, TwistModel, ground_of
from sim.experiments.identification import identify
from sim.preparation.setup import Setup, prepare


def _quasi_static(setup: Setup) -> TwistModel:
    ground = ground_of(setup.robot, setup.as_planned.model)
    return QuasiStaticTwists(setup.kinematics, ground, setup.limits.swing_speed)


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
    """A prediction's twist model, made when first asked for.

    Args:
        setup: Robot, world and limits; the path does not matter.
        name: One of `MODELS`.
    """
    return MODELS[name](setup)
