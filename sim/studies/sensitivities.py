"""What small changes of a robot and its floor do to a finished walk.

The compliant prediction plays the run's own commands on robots changed a little, all of
them side by side. Effects are slopes; contacts switch: they hold near the robot as is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import radians
from typing import NamedTuple

import numpy as np

from models import Robot
from planner import Array
from sim.compliant.anatomy import Robots
from sim.compliant.phases import Course, Motion, Phases
from sim.compliant.prediction import course_along, phases_of
from sim.preparation.setup import prepare
from sim.runs.run import Run

SHARE = 0.25  # of a unit that a change is made by
MILLIMETRE = 1e-3  # [m]
NEWTON = 1.0  # [N]
TENTH = 0.1  # of the coefficient of friction, or of all servos' stiffness


@dataclass(frozen=True)
class Change:
    """A robot, one lane, that differs by `SHARE` of a unit."""

    what: str
    unit: str
    robot: Robots


class Sensitivities(NamedTuple):
    """Effects of V changes at T moments, per unit, in the frame of the start pose."""

    changes: tuple[Change, ...]
    unchanged: Motion  # of the robot as it is, at the T moments
    pose: Array  # effects on x, y [m] and yaw [rad], (V, T, 3)
    lean: Array  # on the height of the root [m], roll and pitch [rad], (V, T, 3)


def sensitivities_of(run: Run, robot: Robot | None = None) -> Sensitivities:
    """Of a finished run at its end; MeasurementError where a robot tips over."""
    phases, course = course_of_run(run, robot)
    changes = list(changes_of(phases, run.legs))
    return sensitivities(phases, course, changes, run.time[-1:])


def sensitivities(
    phases: Phases, course: Course, changes: Sequence[Change], times: Array
) -> Sensitivities:
    """Effects of changes on a course at times (T,) [s].

    Robots on level floors and those on others walk in two batches: where the floor
    leans, phases depend on the heading too, and fewer are alike.
    """
    shape = len(changes), len(times), 3
    pose, lean = np.empty(shape), np.empty(shape)
    batches: dict[bool, list[int]] = {}
    for number, each in enumerate(changes):
        batches.setdefault(bool(each.robot.gravity[0, :2].any()), []).append(number)
    for batch in batches.values() or ([],):
        some = [phases.robots, *(changes[number].robot for number in batch)]
        lanes = {n: np.concatenate([vars(r)[n] for r in some]) for n in vars(some[0])}
        walks = Phases(phases.mechanics, Robots(**lanes)).follow_all(course)
        unchanged = next(walks).at(times)
        for change, walk in zip(batch, walks, strict=True):
            changed = walk.at(times)
            pose[change] = (changed.pose - unchanged.pose) / SHARE
            lean[change] = (changed.lean - unchanged.lean) / SHARE
    return Sensitivities(tuple(changes), unchanged, pose, lean)


def course_of_run(run: Run, robot: Robot | None = None) -> tuple[Phases, Course]:
    """The run's robot as the compliant prediction knows it, and its commands."""
    setup = prepare(run.scenario, robot)
    phases = phases_of(setup.as_known)
    spans = np.array([(phase.start, phase.end) for phase in run.phases])
    heading = np.interp(spans[:, 0], run.time, np.unwrap(run.achieved[:, 2]))
    steps = np.round(spans / setup.limits.timestep).astype(int)
    ctrl = run.commands["ctrl"]
    return phases, course_along(setup, phases, ctrl, steps, heading, {0: np.zeros(3)})


def changes_of(phases: Phases, legs: Sequence[int]) -> Iterator[Change]:
    """Zeros and length of every leg, mass and its place, slope, friction, stiffness."""
    robot, size = phases.robots, np.linalg.norm(phases.robots.gravity)
    step = SHARE * radians(1)
    real: Array = np.any(phases.mechanics.anatomy.axis, axis=-1)
    for joint in range(real.shape[1]):
        for foot, leg in enumerate(legs):
            if real[foot, joint]:
                offset = robot.offset.copy()
                offset[0, foot, joint] += step
                what = f"zero of joint {joint + 1} of leg {leg}"
                yield Change(what, "1 degree", replace(robot, offset=offset))
    for foot, leg in enumerate(legs):
        radius = robot.radius.copy()
        radius[0, foot] += SHARE * MILLIMETRE
        yield Change(f"length of leg {leg}", "1 mm", replace(robot, radius=radius))
    mass = SHARE * NEWTON / size
    body = robot.body_mass + mass
    center = robot.body_center * (robot.body_mass / body)[:, None]
    laden = replace(robot, body_mass=body, body_center=center, mass=robot.mass + mass)
    yield Change("payload in the body's middle", "1 N", laden)
    for axis, way in enumerate(("ahead", "to the left")):
        shift = np.zeros(3)
        shift[axis] = SHARE * MILLIMETRE * robot.mass[0] / robot.body_mass[0]
        moved = replace(robot, body_center=robot.body_center + shift)
        yield Change(f"centre of mass {way}", "1 mm", moved)
    for axis, way in enumerate(("ahead", "to the left")):
        down = np.zeros(3)
        down[axis] = size * step
        leaning = replace(robot, gravity=robot.gravity + down)
        yield Change(f"floor that leans down {way}", "1 degree", leaning)
    rough = replace(robot, friction=robot.friction + SHARE * TENTH)
    yield Change("friction", "0.1", rough)
    stiff = replace(robot, stiffness=robot.stiffness * (1 + SHARE * TENTH))
    yield Change("stiffness of all servos", "10 %", stiff)
