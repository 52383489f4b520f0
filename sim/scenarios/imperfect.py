"""Imperfect robots: plausible sets of imperfections, drawn at random."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi, radians

import numpy as np

from models import Robot
from sim.scenarios.scenario import Scenario


def _hobby(scenario: Scenario, robot: Robot, random: np.random.Generator) -> Scenario:
    """Twelve servos fitted by hand, a battery not quite in the middle, a table.

    Zeros of servos are within half a degree, gears have half a degree of backlash, a
    twentieth of the robot's mass lies up to 10 mm off the middle, the table leans by up
    to a degree, feet rub unequally, and what they stand on is ten times as soft.
    """
    mass = float(robot.model.body_mass.sum())
    return replace(
        scenario,
        zero_offset=radians(0.5),
        backlash=radians(0.5),
        payload=(0.05 * mass, *random.uniform(-0.01, 0.01, 2).tolist(), 0.02),
        slope=(radians(random.uniform(0, 1)), random.uniform(-pi, pi)),
        foot_friction=tuple(random.uniform(0.6, 1.0, len(robot.legs)).tolist()),
        floor_stiffness=1e4,
    )


Draw = Callable[[Scenario, Robot, np.random.Generator], Scenario]
SETS: Mapping[str, Draw] = {"hobby": _hobby}
"""Sets of imperfections by the words of the setting `imperfect`."""


def drawn(scenario: Scenario, robot: Robot) -> Scenario:
    """The scenario with the set of imperfections that it asks for as its settings.

    The same robot and `draw` give the same values, which replace what is given.
    """
    if scenario.imperfect is None:
        return scenario
    random = np.random.default_rng(scenario.draw)
    return replace(SETS[scenario.imperfect](scenario, robot, random), imperfect=None)
