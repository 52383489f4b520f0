"""Short experiments: fields are identified, and the creep of feet; predictions by name.

To identify a field, the legs are brought through the air to one end of its swing and
swing on its stratum to the other one, so slowly that speed does not matter, while the
pose of the body is read. A stroke back over the whole range of the joints confirms the
field as far as it is predicted; what is missed of it tells which walks to trust it on.
"""

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import Polynomial

import models
from models.contact import UPRIGHT
from models.motion import FailedField, MeasuredField
from planner import Array, Flow
from sim.errors import SimulationError, message
from sim.motion.poses import relative, tilt, trail
from sim.motion.schedule import Scheduler
from sim.physics.recording import Moments, recorded
from sim.preparation.scheduling import check_effort
from sim.preparation.setup import Setup, prepare
from sim.progress import Progress, silent

SPAN = 0.25  # [rad] either side; loaded sweeps of the shipped walks stay within
POSE_DEGREE = 6  # of the pose by the angle; the twist is of one degree less
TOLERATED = 0.2  # of a stroke's motion; up to 0.12 measured on shipped robots
LONGEST_STAND = 10.0  # [s], that creep is measured for
WAY_PARTS = 200  # parts of the way in which predictions are summed


def identify(setup: Setup, progress: Progress = silent) -> models.IdentifiedTwists:
    """Measure every loaded field of every stratum, or record why it is impossible."""
    equations, system = setup.equations, setup.equations.system
    fields: dict[str, MeasuredField] = {}
    failed: dict[str, FailedField] = {}
    names = [name for name, twist in equations.twists.items() if any(twist)]
    for done, name in enumerate(names):
        progress("measuring fields", done / len(names))
        stratum = system.stratum_of[name]
        try:
            fields[name] = confirmed(setup, name, measure(setup, stratum, name))
        except (models.MeasurementError, SimulationError) as error:
            failed[name] = FailedField(stratum, str(error))
    progress("measuring fields", 1.0)
    return models.IdentifiedTwists(fields, failed)


def confirmed(setup: Setup, name: str, field: MeasuredField) -> MeasuredField:
    """The field, with the range in which an opposite stroke agrees with it.

    The stroke goes at most to the ends of the joint range. It is refused if the field
    does not even predict it within its span.
    """
    farthest = whole_range(setup, field.direction)
    way, pose = _stroke_back(setup, name, (farthest, field.span))
    if (came := np.abs(way).max()) < field.span / 2:
        what = "a stroke in the opposite direction came to"
        raise models.MeasurementError(f"{what} {came:.2g} of {field.span:.2g} rad")
    ways = np.linspace(0.0, came, WAY_PARTS)
    share = _shares(setup, field, ways, way, pose)
    if (worst := share[ways <= field.span].max()) > TOLERATED:
        raise models.MeasurementError(message("departs", share=100 * worst))
    beyond = np.flatnonzero(share > TOLERATED)
    reach = float(ways[beyond[0] - 1] if len(beyond) else ways[-1])
    return replace(field, reach=max(reach, field.span), off=float(worst))


def measure(setup: Setup, stratum: str, field: str) -> MeasuredField:
    """One experiment: the field's twists along its swing, from both ends' poses."""
    direction = setup.equations.swings[field]
    span = min(SPAN, whole_range(setup, direction))
    way, pose, slip = swing(setup, field, span)
    return MeasuredField(stratum, direction, span, _fit(way, pose, span), slip)


def swing(setup: Setup, field: str, span: float) -> tuple[Array, Array, float]:
    """Swing a field through the physics from -span to span [rad], or back if negative.

    How far along it the legs are, shape (T,) [rad]; the body's pose then, (T, 3); and
    the slip of all feet on the whole way [m]. Refused if the robot falls, or stands on
    other feet than those of the stratum.
    """
    direction = setup.equations.swings[field]
    limits = replace(  # those of the walk, unless it would be slow
        setup.limits,
        swing_speed=max(setup.limits.swing_speed, 0.5),  # [rad/s]
        swing_acceleration=max(setup.limits.swing_acceleration, 5.0),  # [rad/s^2]
        hold=min(setup.limits.hold, 0.5),  # [s]; a robot has settled by then
    )
    stratum = setup.equations.system.stratum_of[field]
    scheduler = Scheduler(limits, setup.at_rest)
    scheduler.hold(limits.hold)
    for flow in _approach(setup, direction, -span):
        scheduler.flow(flow, setup.equations.swings[flow.field])
    scheduler.flow(Flow(stratum, field, 2 * span), direction)
    schedule = scheduler.finish()
    check_effort(setup, schedule.stop)
    begin, steps = schedule.phases[-1].start, schedule.phases[-1].steps
    commands, every = setup.commands(schedule), max(steps // 400, 1)  # poses read
    recording = recorded(setup.model, setup.robot, commands, every, np.array([begin]))
    moments = recording.moments
    on_the_way = moments.at(recording.marks.sampled & (moments.step > begin))
    _check(setup, stratum, on_the_way)
    qpos = on_the_way.qpos
    d = np.array(direction)
    slip = float((moments.slip[-1] - recording.slip_after(begin)).sum())
    return setup.channels.swing(qpos) @ d / (d @ d), setup.pose(qpos), slip


def _check(setup: Setup, stratum: str, way: Moments) -> None:
    """Refuse a swing during which mostly other feet than the stratum's stood."""
    leaning = float(tilt(way.qpos, setup.robot.root_address_in(setup.model)).max())
    if leaning > UPRIGHT:
        angle = np.rad2deg(leaning)
        raise models.MeasurementError(message("tilts", stratum=stratum, angle=angle))
    planned = setup.robot.planted(stratum)
    wrong = (way.contact != planned).mean(axis=0) > 0.5
    for leg, foot, down in zip(setup.robot.legs, wrong, planned, strict=True):
        if foot:
            where = "in the air" if down else "on the ground"
            why = f"on S{stratum} the foot of leg {leg} stays {where}"
            raise models.MeasurementError(why)


def whole_range(setup: Setup, direction: tuple[float, ...]) -> float:
    """How far to swing either way, within the range of every group that moves."""
    ranges = [setup.robot.swing_range[group] for group in setup.robot.groups]
    return min(
        min(-low, high) / abs(share)
        for (low, high), share in zip(ranges, direction, strict=True)
        if share
    )


def _approach(setup: Setup, direction: tuple[float, ...], amount: float) -> list[Flow]:
    """Swings in the air that bring the legs to one end of a field's swing."""
    equations = setup.equations
    stratum_of = equations.system.stratum_of
    flows = []
    for i, share in enumerate(direction):
        only = tuple(float(k == i) for k in range(len(direction)))
        for name, moved in equations.swings.items():
            if share and moved == only and not any(equations.twists[name]):
                flows.append(Flow(stratum_of[name], name, amount * share))
                break
    return flows


def _fit(
    way: Array, pose: Array, span: float
) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Polynomials of the body twist by the way along the field.

    Poses are smooth functions of the way, so they are fitted and differentiated; the
    velocity is turned into the body's frame and fitted once more.
    """
    yaw = np.unwrap(pose[:, 2])
    x, y, theta = (Polynomial.fit(way, c, POSE_DEGREE) for c in (*pose.T[:2], yaw))
    grid = span * np.cos(np.linspace(np.pi, 0, 4 * POSE_DEGREE))
    vx, vy, turn = (p.deriv()(grid) for p in (x, y, theta))
    cos, sin = np.cos(theta(grid)), np.sin(theta(grid))
    forward, left = cos * vx + sin * vy, cos * vy - sin * vx
    first, second, third = (
        Polynomial.fit(grid, part, POSE_DEGREE - 1) for part in (forward, left, turn)
    )
    return first, second, third


def _stroke_back(
    setup: Setup, name: str, spans: tuple[float, ...]
) -> tuple[Array, Array]:
    """The longest stroke that succeeds, its ways ascending."""
    for span in spans:
        try:
            way, pose, _ = swing(setup, name, -span)
        except (models.MeasurementError, SimulationError) as error:
            refusal = error
            continue
        order = np.argsort(way)
        return way[order], np.unwrap(pose[order], axis=0, period=2 * np.pi)
    raise models.MeasurementError(message("not_confirmed", why=refusal))


def _shares(
    setup: Setup, field: MeasuredField, ways: Array, way: Array, pose: Array
) -> Array:
    """Largest miss up to each way, either side, as a share of the motion up to it."""
    arm = setup.kinematics.reach
    miss, motion = np.zeros(len(ways)), np.zeros(len(ways))
    for side in (-1, 1):
        at = np.stack([np.interp(side * ways, way, c) for c in pose.T], axis=1)
        reached = relative(at[0], at)
        middle = side * (ways[1:] + ways[:-1]) / 2
        foreseen = trail(field(middle) * side * np.diff(ways)[:, None])
        miss = np.maximum(miss, _size(reached - foreseen, arm))
        motion = np.maximum(motion, _size(foreseen, arm))
    total = np.maximum.accumulate(motion)
    total = np.maximum(total, total[np.searchsorted(ways, field.span / 2)])
    return np.maximum.accumulate(miss) / np.where(total > 0, total, 1.0)


def _size(poses: Array, arm: float) -> Array:
    return np.hypot(poses[:, 0], poses[:, 1]) + arm * np.abs(poses[:, 2])


def creep_floor(setup: Setup, duration: float) -> float:
    """Slip of all feet together in a stand that lasts as long as a walk [m].

    Soft contacts let a loaded foot creep, more slowly as the stresses between the feet
    relax. Beyond `LONGEST_STAND` it is extrapolated at the rate of its last second,
    which is too much rather than too little.
    """
    stand = min(duration, LONGEST_STAND)
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(setup.limits.hold)
    scheduler.hold(stand)
    schedule = scheduler.finish()
    held, end = (phase.stop for phase in schedule.phases)
    last = min(round(1.0 / setup.limits.timestep), end)
    commands, looks = setup.commands(schedule), np.unique([held, end - last, end])
    recording = recorded(setup.model, setup.robot, commands, end, looks)
    begin, before, after = (
        float(recording.slip_after(step).sum()) for step in (held, end - last, end)
    )
    rate = (after - before) / (last * setup.limits.timestep)
    return after - begin + rate * (duration - stand)


@lru_cache(maxsize=3)
def twist_model(setup: Setup, name: str) -> models.TwistModel:
    """A prediction's twist model, made when first asked for."""
    if name == "ideal":
        return models.IdealTwists(setup.equations)
    if name == "quasi_static":
        speed = setup.limits.swing_speed
        return models.QuasiStaticTwists(setup.kinematics, setup.ground, speed)
    if setup.scenario.obstacles:  # which would disturb the experiments
        setup = prepare(replace(setup.scenario, obstacles=()), setup.robot)
    return identify(setup)


def follows_commands(setup: Setup, name: str, strata: Collection[str]) -> bool:
    """Whether a prediction is the same for all frictions, servos and floors.

    The quasi-static one is where no more than three feet stand at a time.
    """
    feet = max((setup.robot.planted(on).sum() for on in strata), default=0)
    return name == "ideal" or (name == "quasi_static" and feet <= 3)  # static
