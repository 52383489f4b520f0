"""Setups: robot, equations, model and limits, decided before the first step."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path

import mujoco
import numpy as np

from models import Equations, Ground, Kinematics, Robot, equations
from planner import Array, Execution, ExtendedSystem, Path as Curve, extend
from planner.execution import Coordinates, StanceRule
from sim.errors import UsageError
from sim.feedback.filter import NONE_MISSED, Feedback, Learnt, Misses
from sim.feedback.sensing import sensing_of
from sim.logs.log import Log, read_log
from sim.logs.playing import Motion, posed
from sim.motion.poses import pose_of
from sim.motion.schedule import LegState, MotionLimits, Schedule
from sim.physics.engine import STRETCH
from sim.physics.standing import check_standing
from sim.preparation.reach import explained, lift_angle, require_gait
from sim.preparation.shared import PLAN, Cache, Shared, built, no_cache, world_cache
from sim.scenarios.scenario import Scenario, drawn
from sim.scenarios.settings import IMPERFECTIONS
from sim.world.dead_bands import with_own_band
from sim.world.model import World
from sim.world.servos import Channels, ServoSettings, servo_settings

GoalOffset = tuple[float, float, float]  # from the goal to the aim: x, y [m], yaw [rad]
CACHED_WALKS = 2  # walks whose arrays are kept, a number for every step or moment


@dataclass(frozen=True, eq=False)
class Setup:
    """A scenario with everything decided that precedes planning.

    Two setups are equal if they have the same robot in the same world, whatever their
    paths are; measurements made in one hold for the other.
    """

    scenario: Scenario
    robot: Robot
    equations: Equations
    extended: ExtendedSystem
    kinematics: Kinematics
    world: World
    model: mujoco.MjModel
    limits: MotionLimits
    servo: ServoSettings
    motion: Motion | None = None  # that is played in place of a plan
    goal_offset: GoalOffset = (0.0, 0.0, 0.0)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Setup) and self.model is other.model

    def __hash__(self) -> int:
        return id(self.model)

    @cached_property
    def as_planned(self) -> "Setup":
        """The same without imperfections, as predictions and rehearsals have it."""
        return self.with_imperfections(self.scenario.as_planned)

    @cached_property
    def as_known(self) -> "Setup":
        """The same with what the compliant prediction knows of the imperfections."""
        return self.with_imperfections(self.scenario.as_known)

    def with_imperfections(self, scenario: Scenario) -> "Setup":
        """The same robot in the world of a scenario with other imperfections."""
        own = self.scenario
        if all(getattr(own, n) == getattr(scenario, n) for n in IMPERFECTIONS):
            return self
        world, model = built(self.robot, scenario)
        return replace(self, scenario=scenario, world=world, model=model)

    @property
    def is_shareable(self) -> bool:
        """Whether the walk's plan follows from the ideal fields and the path alone."""
        scenario = self.scenario
        plain = scenario.steer == "ideal" and scenario.words == "printed"
        free = not scenario.obstacles and scenario.min_margin is None
        once = scenario.optimise == "none" and scenario.correct == 1
        return plain and free and once and not self.servo.resolution

    def walk_cache(self, shared: Shared | None) -> Cache:
        """Caches what follows from the walk's commands alone, in any physics."""
        scenario, limits = self.scenario, self.limits
        if shared is None or scenario.replan or not self.is_shareable:
            return no_cache
        asked = scenario.key(*PLAN, "motion", "refusal")
        key = self.robot, asked, limits, scenario.sample_every
        return lambda kind, make: shared.cached(kind, key, make, CACHED_WALKS)

    @property
    def learns(self) -> bool:
        """Whether replanning allows for what segments missed before."""
        asked, scenario = self.scenario.learn, self.scenario
        needed = scenario.is_imperfect or scenario.learnt or scenario.sense != "exact"
        return scenario.replan and bool(needed if asked is None else asked)

    def feedback(self) -> Feedback:
        """What says, as a walk is planned piece by piece, where the robot is."""
        sensing, radius = sensing_of(self.scenario), self.kinematics.reach
        if not self.learns:
            return Feedback(sensing, radius, NONE_MISSED)
        known = self.scenario.learnt or self.robot.card.learnt
        try:
            learnt = Learnt.of(known) if known else None
        except ValueError as error:
            raise UsageError.at("learnt", error, "give what a walk learnt") from error
        return Feedback(sensing, radius, Misses(), learnt)

    @property
    def stance(self) -> StanceRule:
        """The stance of the scenario, or the one that suits the robot's equations."""
        asked, own = self.scenario.stance, self.equations.stance
        return own if asked is None or (asked, own) == ("centred", "stepped") else asked

    @property
    def coordinates(self) -> Coordinates:
        """Hall coordinates with the fewest contact switches, or the shortest words."""
        words = self.scenario.words
        return "fewest" if words == "printed" else words

    @property
    def at_rest(self) -> LegState:
        """Legs at angle 0, all feet down."""
        return LegState((0.0,) * len(self.robot.groups), self.robot.card.bottom)

    @property
    def raised(self) -> dict[str, Array]:
        """How far each group is raised on each of the gait's strata, (G,) [rad]."""
        groups, angle = self.robot.groups, self.limits.lift_angle
        return {
            stratum: np.array([g not in stratum for g in groups]) * angle
            for stratum in self.robot.card.gait
        }

    def execution(self, finish: bool = True) -> Execution:
        """How plans are carried out; centred ones may `finish` with legs at angle 0."""
        return replace(
            self.equations.execution,
            stance=self.stance,
            coordinates=self.coordinates,
            finish=finish,
            gait=self.scenario.gait or (),
        )

    @property
    def channels(self) -> Channels:
        """The commands of the model."""
        return Channels(self.robot, self.model)

    def commands(self, schedule: Schedule, steps: int | None = None) -> Iterator[Array]:
        """The rows of ctrl that carry out a schedule, shape (n, nu), n to `STRETCH`."""
        count = schedule.stop - schedule.start if steps is None else steps
        channels = self.channels
        for begin in range(0, count, STRETCH):
            rows = np.arange(begin, min(begin + STRETCH, count))
            yield channels.ctrl(schedule.targets(self.robot, rows))

    @property
    def ground(self) -> Ground:
        """Compliance of floor and servos as they should be."""
        return Ground.of(self.robot, self.as_planned.model)

    def pose(self, qpos: Array) -> Array:
        """Planar pose of the robot's root in the world, shape (..., 3)."""
        return pose_of(qpos, self.robot.root_address_in(self.model))

    def state(self, pose: Array, swing: tuple[float, ...] | None = None) -> Array:
        """Configuration of the equations, feet on the ground, shape (n,)."""
        groups = len(self.robot.groups)
        angles = np.zeros(groups) if swing is None else np.array(swing)
        return np.concatenate([pose, angles, np.zeros(groups)])

    def recut(self, cuts: Array) -> "Setup":
        """The same setup, its path divided at the cuts and nowhere else."""
        path = self.scenario.path.recut(cuts)
        scenario = replace(self.scenario, path=path, segments=len(cuts) - 1)
        return replace(self, scenario=scenario)

    def nominal(self) -> Curve:
        """The nominal path as configurations: legs at angle 0, feet on the ground.

        Where the walk is aimed beside the goal, the path goes there evenly.
        """
        path = self.scenario.path.curve
        if any(self.goal_offset):
            step, straight = np.array(self.goal_offset), path
            path = Curve(lambda s: straight.at(s) + s[:, None] * step, straight.corners)
        return self.equations.configurations(path)

    def resolved(self, scenario: Scenario, robot: str) -> Scenario:
        """A scenario with the settings that it left to its robot; it walks the same.

        It is the one before its path was divided. What the card gives as an angle, or a
        joint at a time, and what follows from a make of servo, remains open.
        """
        own = None if self.servo.kind else self.world.servo
        stiffness, damping = own or (None, None)
        given = scenario.servo_stiffness, scenario.servo_damping
        return replace(
            scenario,
            robot=robot,
            stance="centred" if self.stance == "stepped" else self.stance,
            servo_stiffness=stiffness if given[0] is None else given[0],
            servo_damping=damping if given[1] is None else given[1],
        )


def prepare(
    scenario: Scenario,
    robot: Robot | None = None,
    shared: Shared | None = None,
    log: Log | None = None,
) -> Setup:
    """Load the robot, compile its equations, build its world.

    Args:
        scenario: What to walk.
        robot: The scenario's robot, if it is loaded already.
        shared: What earlier walks have built.
        log: The log of its `motion`, if that is read already.

    Raises:
        UnknownRobotError: If there is no such robot.
        ModelError: If the robot cannot be used.
        UsageError: If a setting asks for what the robot cannot do.
        SimulationError: If its strokes do not reach every direction.

    Example:
        >>> from sim import load_scenario, prepare
        >>> setup = prepare(load_scenario("line"))
        >>> setup.robot.name, setup.model.nu
        ('hexapod', 12)
    """
    shared = shared or Shared()
    if robot is None or robot.geometry != (scenario.geometry or robot.geometry):
        robot = shared.robot(scenario)
    scenario = with_own_band(drawn(scenario, robot), robot.card)
    key = robot, scenario.key("equations")
    made = shared.cached("mathematics", key, partial(_mathematics, robot, scenario))
    described, extended, kinematics = made
    if log is None and scenario.motion is not None:
        log = read_log(Path(scenario.motion), robot.card.joints, robot.legs)
    of_world = world_cache(scenario, robot, shared)
    if log is None:
        require_gait(scenario, robot, described)
        world, model = of_world("world", partial(built, robot, scenario))
        lift = lift_angle(kinematics, scenario.lift_height)
    else:  # which begins in a posture of its own
        robot = posed(robot, log)
        kinematics = Kinematics(robot)
        world, model = built(robot, scenario)
        lift = robot.card.lift_angle
    limits = MotionLimits(
        swing_speed=scenario.swing_speed,
        swing_acceleration=scenario.swing_acceleration,
        lift_angle=lift,
        lift_time=robot.card.lift_time,
        hold=scenario.hold,
        timestep=scenario.timestep,
        groups=robot.groups,
        gains=tuple(robot.largest_gain.tolist()),
    )
    known = scenario, robot, described, extended, kinematics, world, model, limits
    motion = None if log is None else Motion(log, robot, limits)
    setup = Setup(*known, servo_settings(scenario, robot.card), motion)
    if setup.motion is None:
        model = (setup.as_planned if scenario.bumps else setup).model
        tried = kinematics, model, lift, scenario, setup.with_imperfections
        of_world("standing", partial(check_standing, *tried))
    return setup


def _mathematics(
    robot: Robot, scenario: Scenario
) -> tuple[Equations, ExtendedSystem, Kinematics]:
    """Equations, extended system to a degree, and kinematics of a robot."""
    described = equations(robot, scenario.fields)
    with explained(robot, described):
        try:
            extended = extend(described.system, described.elements, scenario.degree)
        except ValueError as error:
            raise UsageError.at("degree", error) from error
    return described, extended, Kinematics(robot)
