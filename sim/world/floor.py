"""The floor: a horizontal plane of the robot's file, or that of the shipped scene.

Every foot must be able to touch it. Other planes remain: vertical ones are walls, and
planes without contact are decoration. A floor with bumps is a height field in place of
the plane, drawn anew for every draw.
"""

from dataclasses import dataclass

import mujoco
import numpy as np

from models import ModelError, Robot
from models.description import FOLDER, compile_model
from planner import Array
from sim.errors import message
from sim.scenarios.scenario import Scenario
from sim.world.parts import copy_settings, fixed_geoms

BUMPS = "bumps"  # name of the height field
CELL = 0.01  # [m] between heights, or more where the floor is large
FLOOR_MARGIN = 0.5  # [m] of floor around the path
DEEP = 0.05  # [m] of floor under the lowest height
LEVEL = 1e-3  # [rad]; a plane tilted less is horizontal, as single precision writes it
WALL = np.deg2rad(45)  # a plane tilted more is a wall, and no attempt at a floor


@dataclass(frozen=True, slots=True)
class Floor:
    """The plane that the robot stands on."""

    name: str  # of the plane
    height: float  # [m]


@dataclass(frozen=True)
class _Plane:
    geom: mujoco.MjsGeom
    place: Array  # of its middle in the world, (3,) [m]
    tilt: float  # of its normal from the vertical [rad]
    out_of_reach: list[str]  # feet that can never touch it

    def __str__(self) -> str:
        return f"plane {self.geom.name!r}"


SOLVING = (  # options of which a robot's file has no say: how exact the physics is
    "solver", "iterations", "tolerance", "ls_iterations", "ls_tolerance", "enableflags",
    "noslip_iterations", "noslip_tolerance", "disableflags", "disableactuator",
)  # fmt: skip


def scene() -> mujoco.MjSpec:
    """A copy of the shipped scene: solver settings, floor, light."""
    return mujoco.MjSpec.from_file(str(FOLDER / "scene.xml"))


def floor_pairs(spec: mujoco.MjSpec, robot: Robot) -> list[mujoco.MjsPair]:
    """The file's own contacts of feet with the world, friction and all."""
    world, feet = {*fixed_geoms(robot.model)}, {*robot.card.feet}
    ends = [(pair, {pair.geomname1, pair.geomname2}) for pair in spec.pairs]
    return [pair for pair, both in ends if both & feet and both & world]


def ensure_floor(spec: mujoco.MjSpec, robot: Robot) -> Floor:
    """The plane to stand on, with the contact of the shipped scene's floor.

    It is the highest horizontal plane that all feet can touch, which is moved into the
    world's own body; the shipped scene joins a robot that has none. A plane that is
    neither floor nor wall is refused.
    """
    for pair in floor_pairs(spec, robot):
        spec.delete(pair)
    feet = [spec.geom(name) for name in robot.card.feet]
    for foot in feet:
        if not (foot.contype or foot.conaffinity):
            raise ModelError(message("untouchable", foot=foot.name, source=robot.path))
    planes = _planes(spec, robot, feet)
    floors = [p for p in planes if p.tilt < LEVEL and not p.out_of_reach]
    if not floors:
        for plane in planes:
            _refuse_half_a_floor(plane, robot)
        return _join_scene(spec, feet)
    plane = max(floors, key=lambda p: p.place[2])
    floor, own, name = plane.geom, scene().geom("floor"), plane.geom.name
    if floor.frame is not None or floor.parent != spec.worldbody:
        floor = spec.worldbody.add_geom()
        copy_settings(floor, plane.geom)
        spec.delete(plane.geom)
    floor.name, floor.pos, floor.quat = name, plane.place, [1, 0, 0, 0]
    floor.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    floor.solref, floor.solimp, floor.condim = own.solref, own.solimp, own.condim
    floor.priority = 1 + max(0, *(foot.priority for foot in feet))
    return Floor(str(floor.name), float(plane.place[2]))


def _planes(
    spec: mujoco.MjSpec, robot: Robot, feet: list[mujoco.MjsGeom]
) -> list[_Plane]:
    """Planes that do not move, with their places at the start."""
    model = compile_model(spec, str(robot.path))  # numbers the geoms
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    planes = []
    for geom in spec.geoms:
        fixed = model.body_weldid[model.geom_bodyid[geom.id]] == 0
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE and fixed:
            up = np.clip(data.geom_xmat[geom.id, 8], -1, 1)
            own, hits = geom.contype, geom.conaffinity
            apart = [f.name for f in feet if not own & f.conaffinity | f.contype & hits]
            place = data.geom_xpos[geom.id]
            planes.append(_Plane(geom, place, float(np.arccos(up)), apart))
    return planes


def _refuse_half_a_floor(plane: _Plane, robot: Robot) -> None:
    """Refuse a plane that some feet can touch, unless it is a wall."""
    if len(plane.out_of_reach) == len(robot.card.feet) or plane.tilt >= WALL:
        return
    if plane.tilt >= LEVEL:
        facts = {"angle": np.rad2deg(plane.tilt), "source": robot.path}
        raise ModelError(message("tilted", plane=plane, **facts))
    feet = ", ".join(map(repr, plane.out_of_reach))
    raise ModelError(message("half", plane=plane, feet=feet, source=robot.path))


def _join_scene(spec: mujoco.MjSpec, feet: list[mujoco.MjsGeom]) -> Floor:
    joined = scene()
    joined.option.timestep = spec.option.timestep  # otherwise the two would conflict
    floor = joined.geom("floor")
    for foot in feet:
        floor.contype |= foot.conaffinity
        floor.conaffinity |= foot.contype
        floor.priority = max(floor.priority, foot.priority + 1)
    spec.visual.map.znear = joined.visual.map.znear
    spec.attach(joined, frame=spec.worldbody.add_frame(), prefix="scene_")
    return Floor("scene_floor", 0.0)


def add_bumps(spec: mujoco.MjSpec, floor: Floor, scenario: Scenario) -> None:
    """Turn the plane of the floor into a field of smooth bumps, as high as asked for.

    Their tops are where the plane was, so that no foot starts within a bump.
    """
    from scipy.ndimage import gaussian_filter  # slow to import, and seldom needed

    way = scenario.path.curve.at(np.linspace(0.0, 1.0, 101))[:, :2]
    low, high = way.min(axis=0) - FLOOR_MARGIN, way.max(axis=0) + FLOOR_MARGIN
    sides = np.clip(np.ceil((high - low) / CELL), 2, 400).astype(int)
    half = (high - low) / 2
    drawn = np.random.default_rng([scenario.draw, 1]).standard_normal(sides[::-1])
    smooth = gaussian_filter(drawn, 3.0, mode="nearest")  # cells
    heights = (smooth - smooth.min()) / np.ptp(smooth)  # a row for each y
    columns, rows = sides.tolist()
    size, heights = [*half.tolist(), scenario.bumps, DEEP], heights.ravel().tolist()
    spec.add_hfield(name=BUMPS, ncol=columns, nrow=rows, size=size, userdata=heights)
    geom = spec.geom(floor.name)
    geom.type = mujoco.mjtGeom.mjGEOM_HFIELD
    geom.hfieldname = BUMPS
    geom.pos = [*((low + high) / 2).tolist(), floor.height - scenario.bumps]
    geom.quat = [1.0, 0.0, 0.0, 0.0]
