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

TIPPING = -1e-6  # [m], of a margin that is less than rounding
INSPECTED_APART = 5e-3  # [rad] by which configurations differ that are looked at
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
    if (margin := found.margin[worst]) < TIPPING:
        stratum = schedule.phases[found.phase[worst]].stratum
        where = f"its margin on S{stratum} is predicted as {1e3 * margin:.1f} mm"
        what = f"the plan tips the robot over: {where}"
        raise _refusal(what, setup, rows[worst])


def _refuse_collisions(setup: Setup, swing: Array, lift: Array, rows: Array) -> None:
    angles, overlaps = np.concatenate([swing, lift], axis=1), Collisions(setup)
    _, first = np.unique(np.round(angles / INSPECTED_APART), axis=0, return_index=True)
    seen = np.sort(first)
    for row, found in zip(seen, overlaps(swing[seen], lift[seen]), strict=True):
        for pair, depth in found.items():
            names = " and ".join(_name(setup.model, geom) for geom in pair)
            what = f"the plan makes legs collide: {names} overlap by "
            raise _refusal(f"{what}{1e3 * depth:.1f} mm", setup, rows[row])


class Collisions:
    """Which parts of a robot overlap at given angles that do not where it stands."""

    def __init__(self, setup: Setup) -> None:
        robot, model = setup.robot, copy(setup.model)
        other = model.body_rootid[model.geom_bodyid] != model.body(robot.root).id
        model.geom_contype[other] = model.geom_conaffinity[other] = 0
        self._robot, self._model, self._data = robot, model, mujoco.MjData(model)
        self._data.qpos[:] = model.key("start").qpos
        self._other = other

    def __call__(self, swing: Array, lift: Array) -> Iterator[Pairs]:
        """Overlapping geoms at angles of the groups in turn, (T, G) each [rad]."""
        rest = np.zeros((1, len(self._robot.groups)))
        always = next(self._overlaps(rest, rest))
        for found in self._overlaps(swing, lift):
            yield {pair: depth for pair, depth in found.items() if pair not in always}

    def _overlaps(self, swing: Array, lift: Array) -> Iterator[Pairs]:
        model, data = self._model, self._data
        targets = self._robot.targets(swing, lift)
        places = [model.joint(joint).qposadr[0] for joint in targets]
        for angles in np.stack(list(targets.values()), axis=-1):
            tick()
            data.qpos[places] = angles
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_collision(model, data)
            yield self._found() if data.ncon else {}

    def _found(self) -> Pairs:
        found, contact = Pairs(), self._data.contact
        own = ~self._other[contact.geom].any(axis=1)  # pairs may be declared
        for k in np.flatnonzero(own & (contact.dist < 0) & (contact.exclude == 0)):
            one, other = sorted(contact.geom[k].tolist())
            found[one, other] = -float(contact.dist[k])
        return found


def _refusal(what: str, setup: Setup, row: int) -> SimulationError:
    time = float(row) * setup.limits.timestep
    where = f"{setup.scenario.name} on {setup.robot.name}, {time:.1f} s after the start"
    return SimulationError(what, where, f"more segments swing the legs less; {ALLOW}")


def _name(model: mujoco.MjModel, geom: int) -> str:
    body = model.body(int(model.geom_bodyid[geom])).name
    return model.geom(geom).name or f"a geom of {body or 'a body without a name'}"
