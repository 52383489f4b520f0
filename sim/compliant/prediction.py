"""The compliant prediction of a walk, from its phases and the commands of its servos.

It is a second physics; sliding pushes contacts apart in it as in the engine.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from models import IdealTwists
from planner import Array
from sim.compliant.anatomy import anatomy_of, robots_of
from sim.compliant.increment import LOADED, Mechanics
from sim.compliant.march import Commands, changes
from sim.compliant.phases import REMEMBERED, SOON, Course, Phases
from sim.motion.poses import wrap
from sim.motion.prediction import Prediction, Predictor
from sim.motion.schedule import Schedule
from sim.preparation.setup import Setup


@dataclass(frozen=True, eq=False)
class Leg:
    """A part of a walk with one schedule, and the pose where it begins, (3,)."""

    schedule: Schedule
    pose: Array


@dataclass(frozen=True)
class CompliantPrediction(Prediction):
    """What no other prediction has: how the body leans, what feet and servos bear."""

    lean: Array  # height of the root [m], roll, pitch [rad], (T, 3)
    load: Array  # of every foot, (T, F) [N]
    torque: Array  # of every servo, legs ascending, from the body outwards, (T, J)
    weight: float  # of the robot [N]

    @property
    def further(self) -> dict[str, Array]:
        """Height, roll, pitch, loads and torques."""
        lean = zip(("height", "roll", "pitch"), self.lean.T, strict=True)
        return {**dict(lean), "load": self.load, "torque": self.torque}

    @property
    def standing(self) -> Array:
        """Which feet bear a load, (T, F), bool."""
        return self.load > LOADED * self.weight


def phases_of(setup: Setup) -> Phases:
    """The robot of a setup in its world, of whose phases nothing is known yet."""
    robot, model = setup.robot, setup.model
    anatomy, floor = anatomy_of(robot, model), model.geom(setup.world.floor)
    mechanics = Mechanics(anatomy, float(floor.pos[2]))
    return Phases(mechanics, robots_of(robot, model, anatomy))


def course_along(
    setup: Setup,
    phases: Phases,
    ctrl: Array,
    spans: Array,
    heading: Array,
    restarts: Mapping[int, Array],
) -> Course:
    """The course of any commands, rows (T, nu) of ctrl, for legs of any joints [rad].

    Phases are given by `spans` as those of a `Course`; they need no contacts. A heading
    counts where the floor leans, and a guess will do.
    """
    dt, rate = setup.limits.timestep, setup.servo.rate
    rows, ends = ctrl[:, phases.mechanics.anatomy.actuator], spans[:, 1] * dt
    # from 200 commands a second on they need not be told apart
    held = bool(setup.servo.resolution or 0 < rate < 200.0)
    edges = np.union1d(ends, changes(rows, dt)) if held else ends
    commands = Commands(rows, dt, np.append(edges, 1e9), held)  # for ever
    memory = REMEMBERED * max(1.0, setup.limits.lift_time / SOON) ** 2.5
    return Course(commands, spans, heading, restarts, memory)


def course_of(
    setup: Setup, phases: Phases, legs: Sequence[Leg], rows: Iterable[Array]
) -> Course:
    """The course of a walk with these schedules and rows of ctrl, (n, nu) each."""
    spans = np.array([(p.start, p.stop) for leg in legs for p in leg.schedule.phases])
    heading = _headings(setup, legs) if phases.leans else np.zeros(len(spans))
    first = np.cumsum([0, *(len(leg.schedule.phases) for leg in legs[:-1])])
    poses = {int(at): leg.pose for at, leg in zip(first, legs, strict=True)}
    return course_along(setup, phases, np.concatenate([*rows]), spans, heading, poses)


def _headings(setup: Setup, legs: Sequence[Leg]) -> Array:
    """Of the ideal prediction as every phase begins, (P,) [rad]."""
    if setup.motion is not None:  # of which the rounds of `Phases.follow` make sure
        return np.zeros(sum(len(leg.schedule.phases) for leg in legs))
    twists, found = IdealTwists(setup.equations), []
    for leg in legs:
        starts = np.array([p.start for p in leg.schedule.phases]) - leg.schedule.start
        predict = Predictor(leg.schedule, twists, setup.kinematics, tuple(leg.pose))
        found.append(predict(starts).pose[:, 2])
    return np.concatenate(found)


def foreseen(
    setup: Setup, legs: Sequence[Leg], rows: Iterable[Array], t: Array, contact: Array
) -> CompliantPrediction:
    """The prediction of a walk at times t (T,) [s], beside planned contacts (T, F)."""
    phases = phases_of(setup)
    motion = phases.follow(course_of(setup, phases, legs, rows)).at(t)
    return CompliantPrediction(
        pose=np.column_stack([motion.pose[:, :2], wrap(motion.pose[:, 2])]),
        slip=motion.slip,
        margin=motion.margin,
        contact=contact,
        lean=motion.lean,
        load=motion.load,
        torque=motion.torque[:, phases.mechanics.anatomy.axis.any(axis=-1)],
        weight=float(phases.robots.weight[0]),
    )
