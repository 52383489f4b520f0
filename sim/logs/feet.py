"""Feet of a robot whose joints move as they like: where they are, which ones stand.

Feet that are as low as the lowest one are planned to stand; where the weight would not
rest on them, those are that the robot comes to rest on. The feet that stand move the
body, and slide on it as little as dry friction under their loads allows.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import mujoco
import numpy as np

from models import Ground, Kinematics, Robot, contact as contacts
from planner import Array
from sim.motion.poses import trail

LIFTED = 0.02  # of the highest lift, from which on a foot is in the air
INSIDE_FEET = -1e-6  # share of the weight on each of three feet that bear it
FLAT_FEET = 1e-9  # [m^2]; feet on a line make no triangle
TOGETHER = 10**6  # triangles of feet at moments, which take 300 MB together


@dataclass(frozen=True, eq=False)
class Posture:
    """Feet and centre of mass of the level body in its own frame at N moments."""

    feet: Array  # where they would touch, (N, F, 3) [m]
    center_of_mass: Array  # (N, 3) [m]
    gives: Array  # of the soles by one joint that gives as all of a leg's, (N, F, 3)

    @property
    def height(self) -> Array:
        """Of each foot above the lowest one, (N, F) [m]."""
        height = self.feet[..., 2]
        return height - height.min(axis=1, keepdims=True)

    @property
    def near(self) -> float:
        """Height up to which a foot is as low as the lowest one [m]."""
        return max(LIFTED * float(self.height.max()), 5e-4)  # [m]

    @property
    def standing(self) -> Array:
        """Feet that are planned to stand, (N, F), bool: low ones that stay as low.

        Those that rise or sink are about to swing, or have swung.
        """
        above = self.height
        rise = np.abs(np.gradient(above, axis=0)) if len(above) > 1 else above * 0.0
        still = rise <= max(LIFTED * float(rise.max()), FLAT_FEET)
        standing = (above <= self.near) & still
        three = np.array([*combinations(range(above.shape[1]), 3)])
        blocks = 1 + len(above) * len(three) // TOGETHER
        for rows in np.array_split(np.arange(len(above)), blocks):
            self._rest(rows, three, standing)
        return standing

    def _rest(self, rows: Array, three: Array, standing: Array) -> None:
        """Let the weight rest on feet where it would not on those that are to stand."""
        feet = self.feet[rows]
        shares = _shares(feet, self.center_of_mass[rows], three)
        inside = shares.min(axis=2) >= INSIDE_FEET
        held = (inside & standing[rows][:, three].all(axis=2)).any(axis=1)
        falls = np.flatnonzero(inside.any(axis=1) & ~held)
        # no foot is beneath that triangle around the weight which is lowest there
        under = (shares * feet[:, three, 2]).sum(axis=2)
        lowest = np.where(inside, under, np.inf)[falls].round(9).argmin(axis=1)
        tilt, above = _seen_from_plane(feet[falls], three[lowest])
        upright = tilt <= np.tan(contacts.UPRIGHT)
        standing[rows[falls[upright]]] = above[upright] <= self.near


def posture(robot: Robot, joints: Sequence[str], angles: Array) -> Posture:
    """Feet of a robot whose joints are at angles (N, J) [rad], others as it stands."""
    model, data = robot.model, mujoco.MjData(robot.model)
    data.qpos[:] = Kinematics(robot).level_qpos
    mujoco.mj_kinematics(model, data)
    soles = [contacts.find_sole(model, data, leg.foot) for leg in robot.leg_cards]
    places = [int(model.joint(joint).qposadr[0]) for joint in joints]
    dofs = [[model.joint(j).dofadr[0] for j in leg.joints] for leg in robot.leg_cards]
    root = model.body(robot.root).id
    origin = data.xpos[root] * (1, 1, 0)
    feet = np.empty((len(angles), len(soles), 3))
    gives, center = np.empty_like(feet), np.empty((len(angles), 3))
    jacobian = np.empty((3, model.nv))
    for row, at in enumerate(angles):
        data.qpos[places] = at
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        center[row] = data.subtree_com[root] - origin
        for foot, sole in enumerate(soles):
            point, body = sole.touch(data), model.geom_bodyid[sole.geoms[0]]
            mujoco.mj_jac(model, data, jacobian, None, point, body)
            feet[row, foot] = point - origin
            gives[row, foot] = _together(jacobian[:, dofs[foot]])
    return Posture(feet, center, gives)


def _together(J: Array) -> Array:
    """Derivative of a sole by one joint that gives as all joints of the leg do, (3,).

    A force f moves the sole by J J' f; what counts are its upward parts.
    """
    upward = float(np.sqrt((J[2] ** 2).sum()))
    return np.append(J[:2] @ J[2] / max(upward, FLAT_FEET), upward)


def _shares(feet: Array, center: Array, three: Array) -> Array:
    """Shares of the weight on feet that bear it three by three, (N, C, 3)."""
    spokes = feet[:, three, :2] - center[:, None, None, :2]  # (N, C, 3, 2)
    after = np.roll(spokes, -1, axis=2)
    area = spokes[..., 0] * after[..., 1] - spokes[..., 1] * after[..., 0]
    whole = area.sum(axis=2, keepdims=True)
    whole[np.abs(whole) <= FLAT_FEET] = np.nan
    return np.nan_to_num(np.roll(area, -1, axis=2) / whole, nan=-1.0)


def _seen_from_plane(feet: Array, corners: Array) -> tuple[Array, Array]:
    """Steepness (N,) of the plane of three feet (N, 3), heights above it (N, F)."""
    flat = np.concatenate([np.ones_like(feet[..., :1]), feet[..., :2]], axis=2)
    own = (np.arange(len(feet))[:, None], corners)
    plane = np.linalg.solve(flat[own], feet[own][..., 2:])  # (N, 3, 1)
    return np.hypot(*plane[:, 1:, 0].T), (feet[..., 2:] - flat @ plane)[..., 0]


def moved(
    found: Posture, contact: Array, ground: Ground, step: float
) -> tuple[Array, Array]:
    """Poses (N, 3) of the body and slip of every foot so far, (N, F) [m].

    Moments are a step apart [s]; in each of them the feet in contact (N, F) stand that
    stood before and stand after.
    """
    feet, shift = found.feet[..., :2], np.diff(found.feet[..., :2], axis=0)
    middle = (feet[1:] + feet[:-1]) / 2
    center = (found.center_of_mass[1:, :2] + found.center_of_mass[:-1, :2]) / 2
    both = contact[1:] & contact[:-1]
    on = np.where(both.any(axis=1, keepdims=True), both, contact[1:])
    twist = np.zeros((len(shift), 3))
    sets, of = np.unique(on, axis=0, return_inverse=True)
    for number, stand in enumerate(sets):
        rows = np.flatnonzero(of.ravel() == number)
        there = np.ix_(rows, np.flatnonzero(stand))
        own, by, weight = middle[there], shift[there], center[rows]
        below = ground.under(stand)
        if stand.sum() <= 3:
            loads = contacts.static_loads(own, weight) * below.shares
            twist[rows] = contacts.least_dissipation_twist(own, by, loads)
            continue
        stance = contacts.Stance(
            own, by, found.gives[there], found.feet[there][..., 2], weight
        )
        twist[rows] = step * contacts.sliding_twist(stance, by / step, below, 1.0)[0]
    speed = np.linalg.norm(contacts.foot_velocities(middle, shift, twist), axis=-1)
    slip = np.vstack([np.zeros(on.shape[1]), np.cumsum(np.where(on, speed, 0), axis=0)])
    return trail(twist), slip
