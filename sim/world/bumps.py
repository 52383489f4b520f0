"""A floor with bumps: the plane becomes a height field, drawn anew for every draw."""

from __future__ import annotations

import mujoco
import numpy as np

from planner import Array
from sim.scenarios.scenario import Scenario
from sim.world.floor import Floor

BUMPS = "bumps"  # name of the height field
CELL = 0.01  # [m] between heights, or more where the floor is large
WIDE = 3.0  # cells; standard deviation of what heights are averaged over
MARGIN = 0.5  # [m] of floor around the path
MOST = 400  # heights along a side
DEEP = 0.05  # [m] of floor under the lowest height


def add_bumps(spec: mujoco.MjSpec, floor: Floor, scenario: Scenario) -> None:
    """Turn the plane of the floor into a field of smooth bumps, as high as asked for.

    Their tops are where the plane was, so that no foot starts within a bump.

    Args:
        spec: World with the floor.
        floor: The plane.
        scenario: Its bumps, its draw, and the path that must lie on the field.
    """
    way = scenario.path.curve.at(np.linspace(0.0, 1.0, 101))[:, :2]
    low, high = way.min(axis=0) - MARGIN, way.max(axis=0) + MARGIN
    sides = np.clip(np.ceil((high - low) / CELL), 2, MOST).astype(int)
    half = (high - low) / 2
    spec.add_hfield(
        name=BUMPS,
        ncol=int(sides[0]),
        nrow=int(sides[1]),
        size=[*half.tolist(), scenario.bumps, DEEP],
        userdata=_heights(sides, scenario.draw).ravel().tolist(),
    )
    geom = spec.geom(floor.name)
    geom.type = mujoco.mjtGeom.mjGEOM_HFIELD
    geom.hfieldname = BUMPS
    geom.pos = [*((low + high) / 2).tolist(), floor.height - scenario.bumps]
    geom.quat = [1.0, 0.0, 0.0, 0.0]


def _heights(sides: Array, draw: int) -> Array:
    """Heights from 0 to 1, a row for each y, (rows, columns)."""
    from scipy.ndimage import gaussian_filter  # slow to import, and seldom needed

    drawn = np.random.default_rng([draw, 1]).standard_normal((sides[1], sides[0]))
    smooth = gaussian_filter(drawn, WIDE, mode="nearest")
    heights: Array = (smooth - smooth.min()) / np.ptp(smooth)
    return heights
