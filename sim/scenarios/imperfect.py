"""Imperfect robots: plausible sets of imperfections, drawn at random."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi, radians
from typing import Any

import numpy as np

from models import Robot
from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario

NONE: Mapping[str, Any] = {
    "command_delay": 0.0,
    "dead_band": 0.0,
    "zero_offset": 0.0,
    "play": 0.0,
    "payload": None,
    "slope": None,
    "floor_stiffness": None,
    "foot_friction": None,
    "bumps": 0.0,
}
"""Settings of imperfections, as they are where there are none."""

Draw = Callable[[np.random.Generator, Robot], dict[str, Any]]


def _hobby(random: np.random.Generator, robot: Robot) -> dict[str, Any]:
    """Twelve servos fitted by hand, a battery not quite in the middle, a table.

    Zeros of servos are within half a degree, gears have half a degree of play, a
    twentieth of the robot's mass lies up to 10 mm off the middle, the table leans by up
    to a degree, feet rub unequally, and what they stand on is ten times as soft.
    """
    mass = float(robot.model.body_mass.sum())
    return {
        "zero_offset": radians(0.5),
        "play": radians(0.5),
        "payload": [0.05 * mass, *random.uniform(-0.01, 0.01, 2).tolist(), 0.02],
        "slope": [radians(random.uniform(0, 1)), random.uniform(-pi, pi)],
        "foot_friction": random.uniform(0.6, 1.0, len(robot.legs)).tolist(),
        "floor_stiffness": 1e4,
    }


IMPERFECT: Mapping[str, Draw] = {"hobby": _hobby}
"""Sets of imperfections by name."""


def imperfections(name: str, robot: Robot, draw: int) -> dict[str, Any]:
    """Settings of one draw; the same for the same robot and draw.

    Args:
        name: Which set.
        robot: Robot that has them.
        draw: Number of the draw.

    Raises:
        UsageError: If there is no such set.
    """
    if name not in IMPERFECT:
        raise UsageError(
            f"unknown set of imperfections {name!r}",
            "--imperfect",
            did_you_mean(name, IMPERFECT),
        )
    return IMPERFECT[name](np.random.default_rng(draw), robot) | {"draw": draw}


def is_imperfect(scenario: Scenario) -> bool:
    """Whether a scenario has any imperfection that no prediction knows of."""
    return any(getattr(scenario, key) != value for key, value in NONE.items())


def without_imperfections(scenario: Scenario) -> Scenario:
    """The scenario as it is planned: the robot and its floor as they should be."""
    return replace(scenario, **NONE)
