"""Contours of bumps lie where the physics has the floor at their height."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from sim.pictures.marks import LEVELS, contours
from sim.preparation.setup import prepare

BUMPS = 0.004


@pytest.fixture
def bumpy(scenario, tmp_path):
    def make(**changes):
        setup = prepare(scenario(**changes))
        (tmp_path / "model.xml").write_text(setup.world.text)
        walk = SimpleNamespace(model=setup.model, scenario=setup.scenario, reach=0.2)
        return walk, setup.model

    return make


def height(model, place):
    """Of the floor under a place, by a ray from above."""
    data, geom = mujoco.MjData(model), np.zeros(1, np.int32)
    mujoco.mj_forward(model, data)
    floor = model.geom("floor").id
    model.geom_group[:] = 1
    model.geom_group[floor] = 0
    groups = np.array([1, 0, 0, 0, 0, 0], np.uint8)
    down, above = np.array([0.0, 0.0, -1.0]), np.array([*place, 1.0])
    return 1.0 - mujoco.mj_ray(model, data, above, down, groups, 1, -1, geom)


def test_the_floor_is_as_high_on_a_contour_as_the_contour_says(bumpy):
    walk, model = bumpy(bumps=BUMPS, draw=3)
    drawn = contours(walk)
    step = BUMPS / LEVELS
    assert (drawn.frames == 0).all()
    middles = drawn.points.mean(axis=1)[:: len(drawn) // 60]
    levels = np.array([height(model, place) for place in middles]) / step
    # a ribbon's triangle is up to half a width beside its line; 0.013 was measured
    assert np.abs(levels - np.round(levels)).max() < 0.05
    found = {int(level) for level in np.round(levels)}
    assert {-4, -3, -2} <= found <= {-4, -3, -2, -1}  # steps below the tops


def test_a_plane_has_no_contours(bumpy):
    walk, _ = bumpy()
    assert len(contours(walk)) == 0
