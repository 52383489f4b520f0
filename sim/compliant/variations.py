"""What small changes of a robot and its floor do to the end of a walk.

Every change is made by a share of its unit, and its effect scaled up, so that effects
are slopes. They are those of the commands as they were given.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from planner import Array
from sim.compliant.phases import Course, Phases
from sim.compliant.places import Robots

SHARE = 0.25  # of a unit that a change is made by
FOOT = 1e-3  # [m]
NEWTON = 1.0  # [N]
TENTH = 0.1  # of the coefficient of friction


@dataclass(frozen=True)
class Variation:
    """A change of one unit."""

    what: str
    unit: str
    robot: Robots  # changed by `SHARE` of it


def variations(phases: Phases, legs: Sequence[int]) -> Iterator[Variation]:
    """Zeros and length of every leg, payload, slope and friction, one at a time."""
    robot, size = phases.robot, np.linalg.norm(phases.robot.gravity)
    step = SHARE * radians(1)
    real: Array = np.any(phases.mechanics.anatomy.axis, axis=-1)
    for joint in range(real.shape[1]):
        for foot, leg in enumerate(legs):
            if real[foot, joint]:
                offset = robot.offset.copy()
                offset[0, foot, joint] += step
                what = f"zero of joint {joint + 1} of leg {leg}"
                yield Variation(what, "degree", replace(robot, offset=offset))
    for foot, leg in enumerate(legs):
        radius = robot.radius.copy()
        radius[0, foot] += SHARE * FOOT
        yield Variation(f"length of leg {leg}", "mm", replace(robot, radius=radius))
    mass = SHARE * NEWTON / size
    center = robot.body_center * (robot.body_mass / (robot.body_mass + mass))[:, None]
    laden = replace(
        robot,
        body_mass=robot.body_mass + mass,
        body_center=center,
        mass=robot.mass + mass,
    )
    yield Variation("payload in the body's middle", "N", laden)
    for axis, way in enumerate(("ahead", "to the left")):
        down = np.zeros(3)
        down[axis] = size * step
        leaning = replace(robot, gravity=robot.gravity + down)
        yield Variation(f"floor that leans down {way}", "degree", leaning)
    rough = replace(robot, friction=robot.friction + SHARE * TENTH)
    yield Variation("friction", "tenth", rough)


def effects(
    phases: Phases, course: Course, legs: Sequence[int]
) -> Iterator[tuple[Variation, Array]]:
    """Every variation, and by how much a unit moves the end: x, y [m], yaw [rad].

    Raises MeasurementError where the robot tips over, or no equilibrium is found.
    """
    end = phases.follow(course).pose[-1]
    for variation in variations(phases, legs):
        varied = Phases(phases.mechanics, variation.robot, phases.pace)
        moved = varied.follow(course).pose[-1]
        yield variation, (moved - end) / SHARE
