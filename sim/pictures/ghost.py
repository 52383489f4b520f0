"""The robot where a prediction has it, in three dimensions, for film and viewer."""

from collections.abc import Iterable

import mujoco
import numpy as np

from models.description import fixed_to, root_body
from planner import Array
from sim import palette
from sim.motion.poses import rotate, wrap
from sim.palette import GHOST, GHOST_TORSO
from sim.runs.run import Run
from sim.world.imperfections import PAYLOAD

INSIDE = 0.93  # size of the ghost, which the robot hides where it is as predicted
FLAT = np.eye(3).ravel()
MESH = mujoco.mjtGeom.mjGEOM_MESH


class Ghost:
    """The robot with the legs that it has, but at the pose of a prediction."""

    def __init__(
        self, walk: Run, model: mujoco.MjModel, name: str, meshes: bool = False
    ) -> None:
        """Meshes are drawn if asked for: the viewer numbers its own differently."""
        self._walk, self._model, self._name = walk, model, name
        self._data = mujoco.MjData(model)
        root = root_body(model, walk.model_file)
        self._address = int(model.jnt_qposadr[model.body_jntadr[root]])
        seen = model.body_rootid[model.geom_bodyid] == root
        seen &= (model.geom_rgba[:, 3] > 0) & (meshes | (model.geom_type != MESH))
        self._body = np.flatnonzero(seen).tolist()
        self._torso = fixed_to(model, root)

    def at(
        self, row: int, geoms: Iterable[mujoco.MjvGeom] | None = None
    ) -> list[mujoco.MjvGeom]:
        """Its parts in a row, in the first of some geoms if they are given."""
        walk, model = self._walk, self._model
        ends = walk.achieved[row], walk.predicted[self._name][row]
        self._data.qpos[:] = _moved(walk.qpos[row], self._address, *ends)
        mujoco.mj_kinematics(model, self._data)
        colour = palette.PREDICTED[self._name].colour
        blank = (mujoco.MjvGeom() for _ in self._body)
        drawn = []
        for i, geom in zip(self._body, geoms or blank, strict=False):
            size, place = INSIDE * model.geom_size[i], self._data.geom_xpos[i]
            rgba = colour.rgba(GHOST_TORSO if i in self._torso else GHOST)
            kind, turned = mujoco.mjtGeom(model.geom_type[i]), self._data.geom_xmat[i]
            drawn.append(decor(kind, size, place, rgba, turned, geom))
            geom.dataid = 2 * model.geom_dataid[i]  # as MuJoCo numbers drawn meshes
        return drawn


def _moved(qpos: Array, address: int, pose: Array, to: Array) -> Array:
    """Joint positions with the body moved from one pose in the plane to another."""
    moved, turn = qpos.copy(), to[2] - pose[2]
    place, attitude = slice(address, address + 2), slice(address + 3, address + 7)
    moved[place] = to[:2] + rotate(qpos[place] - pose[:2], turn)
    about_z = np.array([np.cos(turn / 2), 0.0, 0.0, np.sin(turn / 2)])
    mujoco.mju_mulQuat(moved[attitude], about_z, qpos[attitude])
    return moved


def ghost_of(walk: Run) -> str:
    """The prediction whose robot films show, the simplest that there is."""
    return next(name for name in walk.drawn if name in walk.predicted)


def farthest_ghost(walk: Run) -> float:
    """How far its feet come from those of the robot, at most [m]."""
    off = walk.achieved - walk.predicted[ghost_of(walk)]
    return float((np.hypot(*off[:, :2].T) + walk.reach * np.abs(wrap(off[:, 2]))).max())


def body_corners(model: mujoco.MjModel, root: int) -> Array:
    """Corners of boxes around what is seen of a body, in its frame, shape (n, 3).

    They are where its legs begin, if nothing is seen of it.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    sides = np.stack(np.meshgrid(*[(-1, 1)] * 3), axis=-1).reshape(-1, 3)
    own, corners = fixed_to(model, root), []
    for geom in own[model.geom_rgba[own, 3] > 0]:
        if model.geom(geom).name == PAYLOAD:
            continue
        middle, half = np.split(model.geom_aabb[geom], 2)
        box = (middle + half * sides) @ data.geom_xmat[geom].reshape(3, 3).T
        corners.append(data.geom_xpos[geom] + box)
    if not corners:
        above = model.body_parentid[model.jnt_bodyid]
        corners = [data.xanchor[model.body_weldid[above] == root]]
    return (np.concatenate(corners) - data.xpos[root]) @ data.xmat[root].reshape(3, 3)


def decor(
    kind: mujoco.mjtGeom,
    size: Array,
    place: Array,
    colour: tuple[float, float, float, float],
    turned: Array = FLAT,
    geom: mujoco.MjvGeom | None = None,
) -> mujoco.MjvGeom:
    """A shape that is drawn only."""
    geom = geom or mujoco.MjvGeom()
    mujoco.mjv_initGeom(geom, kind, size, place, turned, np.array(colour, np.float32))
    geom.category = mujoco.mjtCatBit.mjCAT_DECOR
    return geom
