"""A robot as a body on chains of hinges: what turns, what is heavy, what may touch.

Everything is read from a compiled model, in the frame of the robot's root where it
starts. Legs of fewer hinges than others have idle ones, whose axes are zero, and soles
of fewer points have absent ones, far above any floor. Other joints are rigid.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from models import Ground, Robot
from models.contact import find_sole
from models.description import actuator_of
from planner import Array
from sim.compliant.equilibrium import Lanes
from sim.world.dead_bands import band_in
from sim.world.imperfections import BACKLASH

ABSENT = -1e3  # [m]; radius of a point that never touches
CORNERS = 4  # of a sole, at most
FREE = np.inf  # [N m]; torque of a servo that has no largest one


@dataclass(frozen=True, eq=False)
class Anatomy:
    """F legs of J hinges, in the order of the card; each foot has K points."""

    anchor: Array  # a point of every hinge, (F, J, 3) [m]
    axis: Array  # (F, J, 3); zero where a leg has no further hinge
    start: Array  # angles in which all this is given, (F, J) [rad]
    actuator: Array  # command of every hinge, (F, J), int
    link_mass: Array  # of what each hinge turns and the next does not, (F, J) [kg]
    link_center: Array  # (F, J, 3) [m]
    sole: Array  # points of the last link, (F, K, 3) [m]
    radius: Array  # by which the floor touches below them, (F, K) [m]
    body_mass: float  # without the legs [kg]
    body_center: Array  # (3,) [m]
    inertia: Array  # of the whole robot about its centre of mass, (3, 3) [kg m^2]
    turned: Array  # rotation of the root where the model starts, (3, 3)


@dataclass(frozen=True, eq=False)
class Robots(Lanes):
    """What may differ from lane to lane, (B, ...); one anatomy for all."""

    stiffness: Array  # of the servos, (B, F, J) [N m/rad]
    damping: Array  # (B, F, J) [N m s/rad]
    torque: Array  # the largest, (B, F, J) [N m]
    slack: Array  # range without torque, (B, F, J) [rad]
    rub: Array  # damping within it, (B, F, J) [N m s/rad]
    offset: Array  # errors of zeros, (B, F, J) [rad]
    radius: Array  # from the soles' points down to the floor, (B, F, K) [m]
    floor: Array  # compliance under every point, (B, F, K) [m/N]
    friction: Array  # along the legs, (B, F, K)
    push: Array  # of the floor on feet that slide, over friction and speed, (B,) [s]
    across: Array  # friction across the legs over that along them, (B, F)
    gravity: Array  # (B, 3) [m/s^2]
    body_mass: Array  # (B,) [kg]
    body_center: Array  # (B, 3) [m]
    mass: Array  # of the whole robot, (B,) [kg]

    @property
    def weight(self) -> Array:
        """Of the whole robot, (B,) [N]."""
        return self.mass * np.linalg.norm(self.gravity, axis=1)


def anatomy_of(robot: Robot, model: mujoco.MjModel) -> Anatomy:
    """Read the legs, masses and soles of a robot in a world."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_fwdPosition(model, data)
    root = model.body(robot.root).id
    origin, turned = data.xpos[root].copy(), data.xmat[root].reshape(3, 3).copy()
    chains = [  # from the body outwards: the engine numbers joints so
        sorted(int(model.joint(name).id) for name in leg.joints)
        for leg in robot.leg_cards
    ]
    shape = len(chains), max(map(len, chains))
    anchor, axis, start = np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape)
    mass, moment = np.zeros(shape), np.zeros((*shape, 3))
    actuator = np.zeros(shape, dtype=int)
    owner: dict[int, tuple[int, int]] = {}  # leg and link of every joint
    for f, chain in enumerate(chains):
        for j, joint in enumerate(chain):
            anchor[f, j] = (data.xanchor[joint] - origin) @ turned
            axis[f, j] = data.xaxis[joint] @ turned
            start[f, j] = data.qpos[model.jnt_qposadr[joint]]
            actuator[f, j] = actuator_of(model, model.joint(joint).name)
            owner[joint] = f, j
        anchor[f, len(chain) :] = anchor[f, len(chain) - 1]
    centers = (data.xipos - origin) @ turned
    body_mass, body_moment = 0.0, np.zeros(3)
    links: dict[int, tuple[int, int] | None] = {root: None}  # leg and hinge of bodies
    for body in range(root + 1, model.nbody):
        if (parent := int(model.body_parentid[body])) in links:
            joints = model.body_jntadr[body] + np.arange(model.body_jntnum[body])
            own = [owner[joint] for joint in joints.tolist() if joint in owner]
            links[body] = own[-1] if own else links[parent]
    for body, link in links.items():
        if link is None:
            body_mass += float(model.body_mass[body])
            body_moment += model.body_mass[body] * centers[body]
        else:
            mass[link] += model.body_mass[body]
            moment[link] += model.body_mass[body] * centers[body]
    sole, radius = _soles(robot, model, data)
    return Anatomy(
        anchor=anchor,
        axis=axis,
        start=start,
        actuator=actuator,
        link_mass=mass,
        link_center=moment / np.maximum(mass, 1e-12)[..., None],
        sole=np.where(radius[..., None] > ABSENT, (sole - origin) @ turned, 0.0),
        radius=radius,
        body_mass=body_mass,
        body_center=body_moment / max(body_mass, 1e-12),
        inertia=_inertia(model, data, root, turned),
        turned=turned,
    )


def robots_of(robot: Robot, model: mujoco.MjModel, anatomy: Anatomy) -> Robots:
    """Read the servos, with their backlash and dead bands, and the floor: one lane."""
    at, real = anatomy.actuator, anatomy.axis.any(axis=-1)
    joints, ground = model.actuator_trnid[at, 0], Ground.of(robot, model)
    dofs, (feet, points) = model.jnt_dofadr[joints], anatomy.radius.shape
    damping = -model.actuator_biasprm[at, 2] + model.dof_damping[dofs]
    loose = [
        _slack(model, model.joint(number).name, own)
        for number, own in zip(joints.flat, damping.flat, strict=True)
    ]
    slack, rub = np.reshape(np.transpose(loose), (2, *at.shape))
    limited = real & model.actuator_forcelimited[at].astype(bool)
    share = (anatomy.radius > ABSENT).sum(axis=1)  # points that share a foot's spring
    one = {
        "stiffness": np.where(real, model.actuator_gainprm[at, 0], 1.0),
        "damping": np.where(real, damping, 0.0),
        "torque": np.where(limited, model.actuator_forcerange[at, 1], FREE),
        "slack": np.where(real, slack, 0.0),
        "rub": rub,
        "offset": np.zeros(at.shape),
        "radius": anatomy.radius,
        "floor": np.repeat((ground.contact * share)[:, None], points, axis=1),
        "friction": np.repeat(np.transpose([ground.frictions]), points, axis=1),
        "push": ground.push,
        "across": np.ones(feet),
        "gravity": model.opt.gravity,
        "body_mass": anatomy.body_mass,
        "body_center": anatomy.body_center,
        "mass": anatomy.body_mass + anatomy.link_mass.sum(),
    }
    return Robots(**{name: np.array([value]) for name, value in one.items()})


def _slack(model: mujoco.MjModel, joint: str, damping: float) -> tuple[float, float]:
    """How far a leg joint is loose [rad], and what damps it then."""
    width, rub = band_in(model, joint), damping or 1.0
    joints = {model.joint(number).name for number in range(model.njnt)}
    if (loose := BACKLASH + joint) in joints:
        width += float(np.ptp(model.joint(loose).range))
        rub = float(model.joint(loose).damping[0])
    return width, rub


def _soles(
    robot: Robot, model: mujoco.MjModel, data: mujoco.MjData
) -> tuple[Array, Array]:
    """Points that may touch, (F, K, 3) in the world, and their radii, (F, K) [m]."""
    feet = []
    for leg in robot.leg_cards:
        sole = find_sole(model, data, leg.foot)
        placed = sole.placed(data)
        feet.append((placed[_outermost(placed)], sole.depth))
    most = max(len(points) for points, _ in feet)
    soles, radius = np.zeros((len(feet), most, 3)), np.full((len(feet), most), ABSENT)
    for f, (points, depth) in enumerate(feet):
        soles[f, : len(points)], radius[f, : len(points)] = points, depth
    return soles, radius


def _outermost(points: Array) -> Array:
    """Up to `CORNERS` of some points, each as far as possible from those before it."""
    chosen = [int(np.argmax(points[:, 0]))]
    while len(chosen) < CORNERS:
        apart = np.linalg.norm(points[:, None] - points[chosen], axis=2).min(axis=1)
        if apart.max() < 1e-4:
            break
        chosen.append(int(apart.argmax()))
    return np.array(chosen)


def _inertia(
    model: mujoco.MjModel, data: mujoco.MjData, root: int, turned: Array
) -> Array:
    """Of all bodies at their places about the common centre of mass, root's axes."""
    own = model.body_rootid == root
    mass = model.body_mass[own]
    away = (data.xipos[own] - mass @ data.xipos[own] / mass.sum()) @ turned
    frames = turned.T @ data.ximat[own].reshape(-1, 3, 3)
    spins = frames * model.body_inertia[own][:, None] @ np.swapaxes(frames, 1, 2)
    squares = (away**2).sum(axis=1)[:, None, None] * np.eye(3)
    shifted = squares - away[:, :, None] * away[:, None]
    return (spins + mass[:, None, None] * shifted).sum(axis=0)
