"""Refusal of plans that are predicted to tip the robot over or to make legs collide.

The commanded angles alone decide, with the body level and the contacts as planned.
"""

from collections.abc import Iterable, Iterator
from contextlib import nullcontext
from copy import copy

import mujoco
import numpy as np

from planner import Array, Flow, Plan
from planner.support import tick, unlimited
from sim.errors import SimulationError
from sim.motion.prediction import commanded, inspections
from sim.motion.schedule import LegState, Schedule
from sim.preparation.scheduling import scheduled
from sim.preparation.setup import Setup

ALLOW = "or walk it all the same with --allow-unstable"

Pairs = dict[tuple[int, int], float]  # geoms that touch, and how deep [m]


def require_sound(setup: Setup, planned: Plan) -> None:
    """Refuse an open-loop plan that tips over or makes legs collide, unless allowed."""
    searched = setup.scenario.optimise != "none"  # which may have used up the time
    with unlimited() if searched else nullcontext():
        require_sound_flows(setup, planned.segments(), setup.at_rest)


def require_sound_flows(
    setup: Setup, segments: Iterable[Iterable[Flow]], begin: LegState
) -> None:
    """The same for flows from some state of the legs; times count from their start."""
    if setup.scenario.allow_unstable:
        return
    schedule = scheduled(setup, segments, begin)
    if schedule.phases:
        rows = inspections(schedule) - 1 - schedule.start
        _refuse_tipping(setup, schedule, rows)
        _refuse_collisions(setup, *schedule.angles(rows), rows)


def _refuse_tipping(setup: Setup, schedule: Schedule, rows: Array) -> None:
    found = commanded(schedule, rows, setup.kinematics)
    worst = int(found.margin.argmin())
    if (margin := found.margin[worst]) < -1e-6:  # [m], beyond rounding
        stratum = schedule.phases[found.phase[worst]].stratum
        where = f"its margin on S{stratum} is predicted as {1e3 * margin:.1f} mm"
        raise _refusal(f"the plan tips the robot over: {where}", setup, rows[worst])


def _refuse_collisions(setup: Setup, swing: Array, lift: Array, rows: Array) -> None:
    angles = np.concatenate([swing, lift], axis=1)
    _, first = np.unique(np.round(angles / 5e-3), axis=0, return_index=True)  # [rad]
    seen = np.sort(first)
    every = collisions(setup, swing[seen], lift[seen])
    for row, found in zip(seen, every, strict=True):
        for pair, depth in found.items():
            names = " and ".join(_name(setup.model, geom) for geom in pair)
            what = f"the plan makes legs collide: {names} overlap by "
            raise _refusal(f"{what}{1e3 * depth:.1f} mm", setup, rows[row])


def collisions(setup: Setup, swing: Array, lift: Array) -> Iterator[Pairs]:
    """Geoms of a robot that overlap, and do not where it stands.

    They are found at angles of the groups in turn, (T, G) each [rad].
    """
    robot, model = setup.robot, copy(setup.model)
    other = model.body_rootid[model.geom_bodyid] != model.body(robot.root).id
    model.geom_contype[other] = model.geom_conaffinity[other] = 0
    data, rest = mujoco.MjData(model), np.zeros((1, len(robot.groups)))
    data.qpos[:] = model.key("start").qpos
    targets = robot.targets(np.vstack([rest, swing]), np.vstack([rest, lift]))
    places = [model.joint(joint).qposadr[0] for joint in targets]
    always: Pairs | None = None  # what overlaps at rest
    for angles in np.stack(list(targets.values()), axis=-1):
        tick()
        data.qpos[places] = angles
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        found, contact = Pairs(), data.contact
        own = ~other[contact.geom.reshape(-1, 2)].any(axis=1)  # pairs may be declared
        for k in np.flatnonzero(own & (contact.dist < 0) & (contact.exclude == 0)):
            one, two = sorted(contact.geom[k].tolist())
            found[one, two] = -float(contact.dist[k])
        always = found if always is None else always
        if found is not always:
            yield {pair: depth for pair, depth in found.items() if pair not in always}


def _refusal(what: str, setup: Setup, row: int) -> SimulationError:
    time = float(row) * setup.limits.timestep
    where = f"{setup.scenario.name} on {setup.robot.name}, {time:.1f} s after the start"
    return SimulationError(what, where, f"more segments swing the legs less; {ALLOW}")


def _name(model: mujoco.MjModel, geom: int) -> str:
    body = model.body(int(model.geom_bodyid[geom])).name
    return model.geom(geom).name or f"a geom of {body or 'a body without a name'}"
