"""A recorded walk played back: its moments, its forces and the marks in its scene."""

import socket
from types import SimpleNamespace
from unittest import mock

import mujoco
import numpy as np
import pytest

from planner.support import forget_interruption, note_interruption
from sim import palette
from sim.errors import UsageError
from sim.pictures.clock import Playback
from sim.pictures.legend import entries
from sim.runs.run import read_run
from sim.viewing import replay
from sim.viewing.marks import Marks, thinned
from sim.viewing.web import TORSO, looked_through
from tests.finished_runs import predicted_elsewhere

KIND = mujoco.mjtGeom


@pytest.fixture(scope="module")
def recorded(walked):
    return read_run(walked).in_world()


@pytest.fixture(scope="module")
def model(recorded):
    return mujoco.MjModel.from_xml_path(str(recorded.model_file))


def test_time_passes_at_its_speed_stops_and_ends_with_the_walk():
    playback = Playback(end=10.0, speed=4.0)
    playback.pass_by(0.5)
    assert playback.time == pytest.approx(2.0)
    playback.paused = True
    playback.pass_by(5.0)
    assert playback.time == pytest.approx(2.0)
    playback.paused = False
    playback.pass_by(60.0)
    assert playback.time == 10.0
    playback.go_to(-3.0)
    assert playback.time == 0.0


def test_a_folder_that_is_no_run_is_refused(tmp_path):
    with pytest.raises(UsageError, match="it lacks scenario.toml"):
        read_run(tmp_path)
    with pytest.raises(UsageError, match="no such run folder"):
        read_run(tmp_path / "nothing")
    with pytest.raises(UsageError, match="File name too long"):
        read_run(tmp_path / ("long" * 100))


def test_a_run_without_its_commands_is_refused(folder):
    (folder / "commands.npz").unlink()
    with pytest.raises(UsageError, match="not a finished run"):
        read_run(folder)


def test_the_recorded_states_carry_the_robot(recorded, model):
    """State and command of one moment: the floor's forces are the robot's weight."""
    data = mujoco.MjData(model)
    shown = recorded
    holds = [i for i, flow in enumerate(shown.phases) if flow.kind == "hold"]
    row = int(np.flatnonzero(np.isin(shown.phase, holds))[-1])
    data.qpos[:], data.qvel[:] = shown.qpos[row], recorded.qvel[row]
    data.ctrl[:] = recorded.ctrl[row]
    mujoco.mj_forward(model, data)
    force, upward = np.zeros(6), 0.0
    for i in range(data.ncon):
        mujoco.mj_contactForce(model, data, i, force)
        upward += force[0] * abs(data.contact[i].frame[2])
    weight = mujoco.mj_getTotalmass(model) * 9.81
    assert upward == pytest.approx(weight, rel=0.02)  # 0.1 % measured; it stands


def test_the_marks_lie_where_the_walk_was(recorded, model):
    marks, shown = Marks(recorded, model), recorded
    last = len(shown.time) - 1
    geoms = marks.at(last)
    assert len(geoms) < 1024  # what the viewer draws
    places = np.array([geom.pos for geom in geoms])
    colours = np.array([geom.rgba[:3] for geom in geoms])

    def of(colour):
        return places[(np.abs(colours - np.array(colour) / 255) < 1e-3).all(axis=1)]

    weight = of(palette.CENTRE_OF_MASS)
    np.testing.assert_allclose(weight[-1, :2], shown.center_of_mass[last], atol=1e-6)
    rings = [g for g in geoms if g.size[0] == pytest.approx(palette.GOAL * shown.reach)]
    np.testing.assert_allclose(rings[0].pos[:2], shown.nominal[-1, :2], atol=1e-6)
    achieved = of(palette.ACHIEVED.colour)
    gaps = np.hypot(*(achieved[:, None, :2] - shown.achieved[:, :2]).T).min(axis=0)
    assert gaps.max() < 0.002  # the middle of a rod, beside the path


def test_a_path_is_thinned_to_points_evenly_apart_and_one_that_goes_nowhere_to_one():
    path = np.linspace((0.0, 0.0), (3.0, 4.0), 60_000)
    points = thinned(path)
    assert (points[0] == path[0]).all()
    assert (points[-1] == path[-1]).all()
    steps = np.hypot(*np.diff(points, axis=0).T)
    assert steps.max() < 1.01 * steps.min()  # 504 or 505 of the given steps
    assert thinned(np.ones((7, 2))).tolist() == [[1, 1]]


def test_the_ghost_stands_where_the_prediction_is(recorded, model):
    aside = predicted_elsewhere(recorded, lambda poses: poses + (0.1, 0.0, 0.5))
    ghosts = [
        {tuple(np.round(g.rgba, 3)): g.pos.copy() for g in Marks(walk, model).at(5)}
        for walk in (recorded, aside)
    ]
    colour = tuple(
        np.round(
            np.float32(palette.PREDICTED[recorded.best].colour.rgba(palette.GHOST)), 3
        )
    )
    there, moved = (places[colour] for places in ghosts)
    centre = list(recorded.drawn.values())[-1][5]
    cos, sin = np.cos(0.5), np.sin(0.5)
    arm = np.array([[cos, -sin], [sin, cos]]) @ (there[:2] - centre[:2])
    np.testing.assert_allclose(moved[:2], centre[:2] + (0.1, 0.0) + arm, atol=2e-5)
    assert moved[2] == pytest.approx(there[2], abs=1e-5)


def test_footprints_come_with_the_walk(recorded, model):
    marks = Marks(recorded, model)
    counts = [len(marks.at(row)) for row in (0, len(recorded.time) - 1)]
    assert counts[0] < counts[1]


def test_footprints_and_goal_are_flat(recorded, model):
    """The goal would hide the robot, and footprints are not pegs."""
    drawn = Marks(recorded, model).at(len(recorded.time) - 1)
    flat = [g for g in drawn if g.type == mujoco.mjtGeom.mjGEOM_CYLINDER]
    assert len(flat) > 10
    for geom in flat:  # radius, radius, half height
        assert geom.size[2] < 0.2 * geom.size[0]
        assert geom.pos[2] >= geom.size[2]


def test_paths_pass_above_the_footprints_that_they_cross(recorded, model):
    drawn = Marks(recorded, model).at(len(recorded.time) - 1)
    radius = np.float32(palette.FOOTPRINT * recorded.reach)
    prints = [g for g in drawn if g.size[0] == radius]
    colours = [c.colour.rgba() for c in (palette.ACHIEVED, palette.NOMINAL)]
    paths = [g for g in drawn if g.type == mujoco.mjtGeom.mjGEOM_BOX
             and any(np.allclose(g.rgba, colour) for colour in colours)]  # fmt: skip
    top = max(g.pos[2] + g.size[2] for g in prints)
    assert len(prints) > 5
    assert len(paths) > 5
    assert min(g.pos[2] - g.size[1] for g in paths) > top


def test_the_robot_hides_a_ghost_that_stands_where_it_does(recorded, model):
    shown = looked_through(recorded)
    torso = model.geom_bodyid == model.body("torso").id
    opacity, before = shown.geom_rgba[:, 3], model.geom_rgba[:, 3]
    assert opacity[torso] == pytest.approx(TORSO * before[torso])
    assert np.array_equal(opacity[~torso], before[~torso])
    drawn = Marks(recorded, shown).at(0)
    ghosts = [g for g in drawn if g.rgba[3] == np.float32(palette.GHOST_TORSO)]
    sizes = model.geom_size[torso & (before > 0)]
    assert len(ghosts) == len(sizes) > 0
    for ghost, size in zip(ghosts, sizes, strict=True):
        assert (ghost.size < size).all()


def test_round_shapes_are_drawn_in_few_faces(recorded, model):
    """Half the time of a frame without a graphics card; flat faces need no division."""
    drawn, before = looked_through(recorded).vis.quality, model.vis.quality
    assert drawn.numslices * drawn.numstacks < before.numslices * before.numstacks / 4
    assert drawn.numquads == 1


def test_colours_are_explained(recorded):
    said = dict(entries(recorded))
    assert said["achieved path"] == palette.ACHIEVED.colour
    assert said["legs of tripod 2; their footprints are paler"] == palette.group(1)


def test_a_button_of_the_panel_sets_the_speed(monkeypatch):
    plugins = pytest.importorskip("sim.viewing.plugins")
    imgui = mock.MagicMock()
    imgui.SliderFloat.return_value = False, 0.0
    imgui.Button.side_effect = lambda label: label == "4x"
    monkeypatch.setattr(plugins, "imgui", imgui)
    panel = plugins.Panel.__new__(plugins.Panel)
    panel._playback, panel._key = SimpleNamespace(time=0, end=9, paused=True), ()
    panel.on_gui(None)
    assert (panel._playback.speed, panel._playback.paused) == (4, True)


def test_lines_lie_over_one_another_and_over_the_disc_of_the_goal(recorded, model):
    """In parts of the reach; lines of one height would flicker."""
    drawn = Marks(recorded, model).at(len(recorded.time) // 2)
    lines = [g for g in drawn if g.type == KIND.mjGEOM_BOX and g.rgba[3] == 1]
    found = {(tuple(g.rgba), round(float(g.pos[2]) / recorded.reach, 4)) for g in lines}
    assert sorted(h for _, h in found) == [0.008, 0.0104, 0.0128, 0.0152, 0.0176]
    widths = {round(2 * float(g.size[0]) / recorded.reach, 4) for g in lines}
    assert widths == {0.006, 0.01}  # of paths, of the edge of the support
    (disc,) = (
        g for g in drawn if np.allclose(g.rgba, palette.NOMINAL.colour.rgba(0.5))
    )
    middle, half = disc.pos[2] / recorded.reach, disc.size[2] / recorded.reach
    assert (middle, half) == pytest.approx((0.004, 0.002))  # of height, on the floor


def test_an_interruption_that_a_library_loses_leaves_no_replay(folder, monkeypatch):
    """As one that comes in a callback of viser does."""

    def lose(*_):
        note_interruption(KeyboardInterrupt(), lambda: None)
        return "a page"

    monkeypatch.setattr(replay, "_page", lose)
    try:
        with pytest.raises(KeyboardInterrupt):
            replay.write_replay(folder)
    finally:
        forget_interruption()
    assert not (folder / replay.NAME).exists()


def test_nobody_can_speak_to_what_writes_a_replay(recorded, monkeypatch):
    def recording(server, walk, progress):
        with pytest.raises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", server.get_port()))
        return "a page"

    monkeypatch.setattr(replay, "_recorded", recording)
    assert replay._page(recorded, lambda part: None) == "a page"


def test_a_client_that_asks_for_threads_gets_none(recorded, model, monkeypatch):
    """So many would end the process."""
    from mujoco.studio import messages
    from mujoco.studio.viewer_handle import ViewerHandle

    from sim.viewing.plugins import Player

    made = []
    monkeypatch.setattr(mujoco, "mju_threadpool", lambda *asked: made.append(asked))
    player = Player(recorded, Playback(end=1.0))
    handle = ViewerHandle(mock.MagicMock(), sim_plugins=[player])
    handle.set_model(model)
    handle.dispatch(messages.ThreadPoolEvent(nthread=100_000))
    assert not made
