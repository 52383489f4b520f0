"""A test that a robot stands at its start, on its feet and on nothing else.

It takes half a second of physics with the servos holding, which is long enough for soft
legs to give way and for an unsupported body to tip over.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator
from contextlib import suppress

import mujoco
import numpy as np

from models import Kinematics, ModelError, Robot
from models.contact import UPRIGHT
from models.description import actuator_of, silence_the_engine
from sim.errors import UsageError
from sim.world.integrator import suitable_integrator
from sim.world.sensors import contact_sensor
from sim.world.walls import PREFIX

SETTLING = 0.5  # [s]
CHUNK = 10  # steps between two looks at whether Ctrl-C was pressed
SHORTER = (0.002, 0.001, 0.0005)  # timesteps to try where a longer one fails [s]
MOST_STEPS = 4000  # steps, for tiny timesteps


def check_standing(
    kinematics: Kinematics, model: mujoco.MjModel, lift_angle: float
) -> None:
    """Refuse a robot that does not stand at keyframe `start`.

    It must clear the ground with lifted legs [rad] even if others sag. A simulation
    that diverges is not refused here; the walk reports when and why. A timestep that is
    too long for the servos, and a start inside an obstacle, are a `UsageError`.
    """
    silence_the_engine()
    try:
        _check_standing(kinematics, model, lift_angle)
    except ModelError as refusal:
        _blame_the_timestep(kinematics, model, lift_angle, refusal)
        raise
    except mujoco.FatalError as error:
        reason = " ".join(str(error).split())
        raise ModelError(
            f"the engine cannot run it: {kinematics.robot.path}; {reason}"
        ) from error


def _check_standing(
    kinematics: Kinematics, model: mujoco.MjModel, lift_angle: float
) -> None:
    robot, data = kinematics.robot, mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    _refuse_obstacles(model, data)
    _refuse(robot, _lying(robot, model, data))
    height = data.qpos[_height(robot, model)]
    for _ in range(0, min(round(SETTLING / model.opt.timestep), MOST_STEPS), CHUNK):
        mujoco.mj_step(model, data, nstep=CHUNK)  # a large model is slow
    if any(warning.number for warning in data.warning):
        return
    sag = float(height - data.qpos[_height(robot, model)])
    rise = float(kinematics.lifting.rise(np.array(lift_angle)).min())
    _refuse(robot, _tipped(robot, data))
    _refuse(robot, _lying(robot, model, data))
    _refuse(robot, _aloft(robot, model, data))
    _refuse(robot, _sagged(sag, rise))
    _refuse(robot, _too_soft(robot, model, data))


def _blame_the_timestep(
    kinematics: Kinematics,
    model: mujoco.MjModel,
    lift_angle: float,
    refusal: ModelError,
) -> None:
    """Refuse the timestep instead, if the robot stands at a shorter one."""
    asked = model.opt.timestep
    for timestep in (step for step in SHORTER if step < asked):
        finer = with_timestep(model, timestep)
        with suppress(ModelError):
            _check_standing(kinematics, finer, lift_angle)
            raise UsageError(
                f"timestep = {asked:g} is too long for the servos of "
                f"{kinematics.robot}, which are unstable with it and make it fall",
                "timestep",
                f"give at most {timestep:g}, at which it stands",
            ) from refusal


def with_timestep(model: mujoco.MjModel, timestep: float) -> mujoco.MjModel:
    """The same world with another timestep and the integrator that suits it."""
    other = copy.copy(model)
    other.opt.timestep = timestep
    other.opt.integrator = suitable_integrator(other)
    return other


def _refuse(robot: Robot, problems: Iterable[tuple[str, str]]) -> None:
    for what, remedy in problems:
        raise ModelError(f"it does not stand: {what}: {robot.path}; {remedy}")


def _refuse_obstacles(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    for contact in data.contact:
        names = sorted(model.geom(g).name for g in contact.geom)
        for own, other in (names, names[::-1]):
            if other.startswith(PREFIX) and contact.dist < 0:
                number = other.removeprefix(PREFIX).split("_")[0]
                raise UsageError(
                    f"the robot starts with {own} {-1e3 * contact.dist:.1f} mm deep in "
                    f"obstacle {number}",
                    "obstacles",
                    "move the obstacle; poses are measured from the start",
                )


def _height(robot: Robot, model: mujoco.MjModel) -> int:
    return robot.root_address_in(model) + 2


def _tipped(robot: Robot, data: mujoco.MjData) -> Iterator[tuple[str, str]]:
    up = data.body(robot.root).xmat[8]
    tilt = float(np.arccos(np.clip(up, -1, 1)))
    if tilt > UPRIGHT:
        yield (
            f"it tilts by {np.rad2deg(tilt):.3g} degrees in {data.time:.2g} s",
            "put its feet around its centre of mass, or stiffen its servos",
        )


def _sagged(sag: float, rise: float) -> Iterator[tuple[str, str]]:
    if sag > rise:
        yield (
            f"its legs give way by {1e3 * sag:.1f} mm, and a lifted foot rises by "
            f"{1e3 * rise:.1f} mm only",
            "stiffen its servos (servo_stiffness), or lift higher (lift_height)",
        )


def _too_soft(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> Iterator[tuple[str, str]]:
    """Lift servos that their load would bend by more than they are to lift."""
    load = np.abs(data.qfrc_bias - data.qfrc_constraint)
    for leg in robot.card.legs.values():
        stiffness = model.actuator_gainprm[actuator_of(model, leg.lift), 0]
        torque = load[model.joint(leg.lift).dofadr[0]]
        if torque > stiffness * robot.card.lift_angle:
            yield (
                f"joint {leg.lift!r} bears {torque:.3g} N m, for which its servo of "
                f"{stiffness:.3g} N m/rad has to bend by more than lift_angle = "
                f"{robot.card.lift_angle:g}",
                f"stiffen it (servo_stiffness), to {10 * torque / UPRIGHT:.2g} or so",
            )


def _lying(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> Iterator[tuple[str, str]]:
    """Contacts of parts that are no feet, or with things that are not the floor."""
    feet, floor = _feet(robot, model), _floor(robot, model)
    for own, other in _touched(robot, model, data):
        if own not in feet:
            yield (
                f"{_name(model, own)} lies on {_name(model, other)}",
                "lift the body off it, or make that geom a foot",
            )
        elif other != floor:
            yield (
                f"foot {model.geom(own).name!r} stands on {_name(model, other)}, which "
                f"is not the floor, {_name(model, floor)}",
                "leave one of the two out, or make the former a horizontal plane",
            )


def _aloft(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> Iterator[tuple[str, str]]:
    """Legs whose feet touch nothing."""
    feet, touched = _feet(robot, model), _touched(robot, model, data)
    aloft = set(robot.legs) - {feet[own] for own, _ in touched if own in feet}
    if not aloft:
        return
    what = f"the foot of leg {min(aloft)} touches nothing"
    if jammed := _jammed(robot, model, data):
        one, other = (_name(model, geom) for geom in jammed)
        yield (
            f"{what}, while {one} and {other} of it push against each other",
            "make room between them, or let them pass through each other (<exclude>)",
        )
    yield what, "correct its angles in keyframe 'start', or the geoms of its foot"


def _jammed(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> tuple[int, int] | None:
    """Two parts of the robot that are in contact with each other."""
    root = model.body(robot.root).id
    for contact in data.contact:
        one, other = (int(geom) for geom in contact.geom)
        owners = {int(model.body_rootid[model.geom_bodyid[g]]) for g in (one, other)}
        if contact.efc_address >= 0 and owners == {root}:
            return one, other
    return None


def _feet(robot: Robot, model: mujoco.MjModel) -> dict[int, int]:
    """The leg of every foot geom."""
    legs = robot.card.legs
    return {model.geom(name).id: leg for leg in legs for name in legs[leg].foot}


def _floor(robot: Robot, model: mujoco.MjModel) -> int:
    """The geom that contact sensors watch the feet against."""
    foot = robot.card.feet[0]
    return int(model.sensor_objid[model.sensor(contact_sensor(foot)).id])


def _touched(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> Iterator[tuple[int, int]]:
    """Geoms of the robot in contact with others; obstacles are for others to judge."""
    root = model.body(robot.root).id
    for contact in data.contact:
        pair = [int(geom) for geom in contact.geom]
        own = [g for g in pair if model.body_rootid[model.geom_bodyid[g]] == root]
        others = [g for g in pair if g not in own]
        if contact.efc_address < 0 or len(own) != 1:
            continue
        if not model.geom(others[0]).name.startswith(PREFIX):
            yield own[0], others[0]


def _name(model: mujoco.MjModel, geom: int) -> str:
    name = model.geom(geom).name
    return f"geom {name!r}" if name else "a geom without a name"
