"""A test that a robot stands at its start, on its feet and on nothing else.

It takes half a second of physics with the servos holding, which is long enough for soft
legs to give way and for an unsupported body to tip over.
"""

import copy
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

import mujoco
import numpy as np

from models import Kinematics, ModelError, Robot
from models.contact import UPRIGHT
from models.description import actuator_of, silence_the_engine
from planner.support import sentences
from sim.errors import UsageError
from sim.scenarios.predictions import imperfect
from sim.scenarios.scenario import Scenario
from sim.world.model import suitable_integrator
from sim.world.sensors import WALL, floor_in

SETTLING = 0.5  # [s]
CHUNK = 10  # steps between two looks at whether Ctrl-C was pressed
SHORTER = (0.002, 0.001, 0.0005)  # timesteps to try where a longer one fails [s]
MOST_STEPS = 4000  # steps, for tiny timesteps
say = sentences("sim.physics", "standing.toml")


def check_standing(
    kinematics: Kinematics,
    model: mujoco.MjModel,
    lift_angle: float,
    scenario: Scenario | None = None,
    world_of: Callable[[Scenario], Any] | None = None,
) -> None:
    """Refuse a robot that does not stand at keyframe `start`.

    It must clear the ground with lifted legs [rad] even if others sag. A simulation
    that diverges is not refused here; the walk reports when and why. A timestep that is
    too long for the servos, and a start inside an obstacle, are a `UsageError`, and so
    are a scenario's imperfections, if it stands in the `world_of` it without them.
    """
    silence_the_engine()
    try:
        _check_standing(kinematics, model, lift_angle)
    except ModelError as refusal:
        _blame_the_timestep(kinematics, model, lift_angle, refusal)
        if scenario is None or world_of is None or not scenario.is_imperfect:
            raise
        with suppress(ModelError):
            _check_standing(kinematics, world_of(scenario.as_planned).model, lift_angle)
            settings = (f"{n} = {getattr(scenario, n)}" for n in imperfect(scenario))
            facts = {"robot": kinematics.robot, "settings": ", ".join(settings)}
            where = f"scenario {scenario.name!r}"
            raise UsageError.of("too_much", where, **facts) from refusal
        raise
    except mujoco.FatalError as error:
        reason = " ".join(str(error).split())
        what = f"MuJoCo cannot run the model: {kinematics.robot.path}"
        raise ModelError(f"{what}; {reason}") from error


def _check_standing(
    kinematics: Kinematics, model: mujoco.MjModel, lift_angle: float
) -> None:
    robot, data = kinematics.robot, mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    _refuse_obstacles(model, data)
    standing = _Standing(robot, model, data)
    _refuse(robot, standing.weightless())
    _refuse(robot, standing.lying())
    height = robot.root_address_in(model) + 2
    before = float(data.qpos[height])
    for _ in range(0, min(round(SETTLING / model.opt.timestep), MOST_STEPS), CHUNK):
        mujoco.mj_step(model, data, nstep=CHUNK)  # a large model is slow
    if any(warning.number for warning in data.warning):
        return
    rise = 1e3 * float(kinematics.rise(np.array(lift_angle)).min())
    sag = 1e3 * (before - float(data.qpos[height]))
    sagging = [say("sags", sag=sag, rise=rise)] if sag > rise else []
    lying, soft = [*standing.lying()], standing.too_soft()
    weak = standing.weak() if sagging else ()
    found = weak, standing.tipped(), lying and sagging, lying, standing.aloft(), sagging
    _refuse(robot, chain(*found, soft))


def _blame_the_timestep(
    kinematics: Kinematics, model: mujoco.MjModel, lift: float, refusal: ModelError
) -> None:
    """Refuse the timestep instead, if the robot stands at a shorter one."""
    asked = model.opt.timestep
    for timestep in (step for step in SHORTER if step < asked):
        with suppress(ModelError):
            _check_standing(kinematics, with_timestep(model, timestep), lift)
            facts = {"asked": asked, "robot": kinematics.robot, "most": timestep}
            raise UsageError.of("long_step", "timestep", **facts) from refusal


def with_timestep(model: mujoco.MjModel, timestep: float) -> mujoco.MjModel:
    """The same world with another timestep and the integrator that suits it."""
    other = copy.copy(model)
    other.opt.timestep = timestep
    other.opt.integrator = suitable_integrator(other)
    return other


def _refuse(robot: Robot, problems: Iterable[str]) -> None:
    for problem in problems:
        what, _, remedy = problem.rpartition("; ")
        raise ModelError(f"the robot does not stand: {what}: {robot.path}; {remedy}")


def _refuse_obstacles(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    for contact in data.contact:
        names = sorted(model.geom(g).name for g in contact.geom)
        for own, other in (names, names[::-1]):
            if (wall := re.fullmatch(WALL, other)) and contact.dist < 0:
                deep = f"{-1e3 * contact.dist:.1f} mm deep in obstacle {wall[1]}"
                raise UsageError.of("starts_in", "obstacles", part=own, deep=deep)


@dataclass(frozen=True)
class _Standing:
    """A robot that stands or not; its problems are sentences."""

    robot: Robot
    model: mujoco.MjModel
    data: mujoco.MjData

    def weightless(self) -> Iterator[str]:
        if self.model.opt.gravity[2] >= 0:
            yield say("weightless")

    def tipped(self) -> Iterator[str]:
        tilt = float(np.arccos(np.clip(self.data.body(self.robot.root).xmat[8], -1, 1)))
        if tilt > UPRIGHT:
            yield say("tipped", tilt=np.rad2deg(tilt), time=self.data.time)

    def weak(self) -> Iterator[str]:
        """Servos that give all the torque that they have."""
        model, given = self.model, self.data.actuator_force
        for joint in self.robot.card.joints:
            at = actuator_of(model, joint)
            low, most = model.actuator_forcerange[at]
            if model.actuator_forcelimited[at] and not low < given[at] < most:
                yield say("weak", joint=joint, most=most)

    def too_soft(self) -> Iterator[str]:
        """Lift servos that their load would bend by more than they are to lift."""
        robot, model = self.robot, self.model
        load = np.abs(self.data.qfrc_bias - self.data.qfrc_constraint)
        for leg in robot.card.legs.values():
            stiffness = model.actuator_gainprm[actuator_of(model, leg.lift), 0]
            torque = load[model.joint(leg.lift).dofadr[0]]
            if torque > stiffness * robot.card.lift_angle:
                bent = {"joint": leg.lift, "torque": torque, "stiffness": stiffness}
                stiff, lift = 10 * torque / UPRIGHT, robot.card.lift_angle
                yield say("too_soft", lift=lift, stiff=stiff, **bent)

    def lying(self) -> Iterator[str]:
        """Contacts of parts that are no feet, or with things that are not the floor."""
        model, floor = self.model, floor_in(self.model, self.robot.card.feet[0])
        for own, other in self._touched():
            if own not in self._feet:
                yield say("lies", own=self._name(own), other=self._name(other))
            elif other != floor:
                below = {"other": self._name(other), "floor": self._name(floor)}
                yield say("no_floor", own=model.geom(own).name, **below)

    def aloft(self) -> Iterator[str]:
        """Legs whose feet touch nothing."""
        aloft = {*self.robot.legs} - {self._feet.get(own) for own, _ in self._touched()}
        if not aloft:
            return
        for one, other in self._contacts(robots=2):
            both = {"one": self._name(one), "other": self._name(other)}
            yield say("pushing", leg=min(aloft), **both)
        yield say("aloft", leg=min(aloft))

    @cached_property
    def _feet(self) -> dict[int, int]:
        """The leg of every foot geom."""
        legs = self.robot.card.legs
        return {self.model.geom(g).id: leg for leg in legs for g in legs[leg].foot}

    def _touched(self) -> Iterator[tuple[int, int]]:
        """Geoms of the robot in contact with others but obstacles, judged elsewhere."""
        for own, other in self._contacts(robots=1):
            if not re.fullmatch(WALL, self.model.geom(other).name):
                yield own, other

    def _contacts(self, robots: int) -> Iterator[tuple[int, int]]:
        """Pairs of geoms that push, so many of them the robot's, which come first."""
        root, model = self.model.body(self.robot.root).id, self.model
        for contact in self.data.contact:
            geoms = [int(geom) for geom in contact.geom]
            own = model.body_rootid[model.geom_bodyid[geoms]] == root
            if contact.efc_address >= 0 and own.sum() == robots:
                yield (geoms[0], geoms[1]) if own[0] else (geoms[1], geoms[0])

    def _name(self, geom: int) -> str:
        name = self.model.geom(geom).name
        return f"geom {name!r}" if name else "a geom without a name"
