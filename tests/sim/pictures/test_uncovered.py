"""No foot is ever under a panel: computed from the camera, not seen on pictures."""

import mujoco
import numpy as np
import pytest
import shapely

from sim.pictures.camera import ACROSS, FREE, HEIGHT, WIDTH, View, camera
from sim.pictures.captions import Captions
from sim.pictures.clock import clock
from sim.pictures.offscreen import RADIUS
from sim.run_folder import write
from sim.runs.run import read_run
from sim.scenarios.file import load_scenario, shipped_scenarios
from sim.simulation import simulate


def is_uncovered(walk):
    """Whether each foot is clear of each panel and of the edge in every picture."""
    film = clock(walk.time, walk.scenario.playback)
    view, model = camera(walk, film), walk.model
    data, seen = mujoco.MjData(model), []
    feet = [model.geom(walk.card.legs[leg].foot[0]).id for leg in walk.legs]
    for frame in film.scene:
        data.qpos[:] = walk.qpos[film.rows[frame]]
        mujoco.mj_kinematics(model, data)
        seen.append(view.pixels(frame, data.geom_xpos[feet]))
    feet = shapely.points(np.array(seen)).ravel()
    picture = shapely.box(RADIUS, RADIUS, WIDTH - RADIUS, HEIGHT - RADIUS)
    panels = shapely.union_all(
        [
            shapely.box(p.left, p.top, p.left + p.still.size[0], p.bottom)
            for p in Captions(walk, film, view)._panels
        ]
    )
    clear = shapely.distance(panels, feet) > RADIUS  # of the number on a foot
    return clear & shapely.contains(picture, feet)


def test_no_foot_is_under_a_panel(walked):
    assert is_uncovered(read_run(walked).in_world()).all()


def test_feet_in_the_air_throughout_a_stretch_are_in_its_picture(walked):
    walk = read_run(walked).in_world()
    begin = int(np.flatnonzero(~walk.contact[:, 0])[0])  # a foot in front
    film = clock(walk.time, stretch=(walk.time[begin], walk.time[begin + 1]))
    places = np.insert(walk.contact_point[begin], 2, 0.0, axis=1)
    left, top, right, bottom = FREE
    for view in (ACROSS, View(-90.0, -25.0, 100.0), View(0.0, -25.0, 100.0)):
        x, y = camera(walk, film, view).pixels(film.scene.start, places).T
        assert left - RADIUS < x.min() < x.max() < right + 2 * RADIUS < WIDTH
        assert top - RADIUS < y.min() < y.max() < bottom + RADIUS


@pytest.mark.full
@pytest.mark.parametrize("name", shipped_scenarios())
def test_no_foot_of_a_shipped_scenario_is_under_a_panel(name, tmp_path):
    without = ("identified", "compliant", "creep_floor")
    folder = write(simulate(load_scenario(name), without=without), tmp_path / "run")
    assert is_uncovered(read_run(folder).in_world()).all()
