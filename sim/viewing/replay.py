"""A replay in one file: the walk in three dimensions with a time line, for any browser.

The page asks nothing of the network. viser, which writes it, is an extra.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stdout
from functools import partial
from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING
from unittest.mock import patch

import mujoco
import numpy as np

from models.description import root_body
from planner import Array
from planner.support import installing, tick
from sim import palette
from sim.errors import UsageError
from sim.folder import RunFolder, blamed_on
from sim.palette import ACHIEVED, FOOTPRINT, GOAL, NOMINAL, PREDICTED, Colour
from sim.pictures.clock import FRAME_RATE, clock
from sim.pictures.drawing import CORNERS
from sim.pictures.legend import entries
from sim.runs.run import Run, read_run
from sim.templates import render
from sim.viewing.marks import KIND, TORSO, landings, middle_and_extent, support, thinned

if TYPE_CHECKING:
    from viser import FrameHandle, SceneApi, ViserServer

NAME = "replay.html"
PICTURES_APART = 2  # of the film's clock
LIFT, THICK, WIDE = 0.004, 0.004, 0.007  # of lines, in units of the robot's reach


def write_replay(
    folder: Path, progress: Callable[[float], None] = lambda part: None
) -> Path:
    """Write `replay.html` into a run folder; progress is called with the share done."""
    with blamed_on(folder):
        page = _page(read_run(folder).in_world(), progress)
        tick()  # a callback of viser may have lost an interruption
    RunFolder(folder).write_text(NAME, page)
    return folder / NAME


def _page(walk: Run, progress: Callable[[float], None]) -> str:
    try:
        import viser
        from websockets.asyncio import server as sockets
    except ImportError as error:
        how = installing("replay")
        raise UsageError("no replay without viser", "replay", how) from error
    closed = partial(sockets.serve, start_serving=False)  # nobody is to be answered
    # it tells of a server that nobody needs
    with redirect_stdout(StringIO()), patch.object(sockets, "serve", closed):
        server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        try:
            return _recorded(server, walk, progress)
        finally:
            server.stop()


def _recorded(server: ViserServer, walk: Run, progress: Callable[[float], None]) -> str:
    film = clock(walk.time, walk.scenario.playback)
    recorder = server.get_scene_serializer()
    _draw_still(server.scene, walk)
    robot = _Robot(server.scene, walk)
    (x, y), extent = middle_and_extent(walk)
    away = 1.4 * walk.reach + 0.6 * extent  # behind and above the walk
    server.initial_camera.position = (x - 0.6 * away, y - away, 0.8 * away)
    server.initial_camera.look_at = (x, y, 0.0)
    ended = int(np.searchsorted(film.rows, film.rows[-1]))
    rows = film.rows[film.title : ended + 1 : PICTURES_APART]
    for done, row in enumerate(rows):
        robot.go_to(int(row))
        recorder.insert_sleep(PICTURES_APART / FRAME_RATE)
        progress((done + 1) / len(rows))
    return _explained(recorder.as_html(), walk, film.playback)


def _explained(page: str, walk: Run, playback: float) -> str:
    """The page under a title of its own, with a key of its colours to fold up."""
    before, _, rest = page.partition("<title>")
    body, end, after = rest.partition("</title>")[2].rpartition("</body>")
    name, ink = walk.scenario.name, palette.TEXT
    known = {"name": name, "playback": playback, "ink": ink, "entries": entries(walk)}
    title = f"<title>{escape(name)}, a replay</title>"
    return f"{before}{title}{body}{render('replay_key.html', **known)}\n{end}{after}"


class _Robot:
    """The bodies of the robot, which move, and the polygon that it stands on."""

    def __init__(self, scene: SceneApi, walk: Run) -> None:
        self._scene, self._walk = scene, walk
        self._model = walk.model
        self._data = mujoco.MjData(self._model)
        self._root = root_body(self._model, walk.model_file)
        bodies = np.flatnonzero(self._model.body_rootid == self._root)
        self._bodies = [(int(body), self._add(int(body))) for body in bodies]

    def _add(self, body: int) -> FrameHandle:
        model, name = self._model, f"/robot/{body}"
        frame = self._scene.add_frame(name, show_axes=False)
        of_body = model.body_weldid[body] == self._root
        for geom in np.flatnonzero(model.geom_bodyid == body):
            *colour, opacity = model.geom_rgba[geom]
            if opacity == 0 or (mesh := mesh_of(model, int(geom))) is None:
                continue
            corners, faces = mesh
            self._scene.add_mesh_simple(
                f"{name}/{geom}",
                corners,
                faces,
                color=tuple(int(255 * c) for c in colour),
                opacity=TORSO if of_body else float(opacity),
                wxyz=model.geom_quat[geom],
                position=model.geom_pos[geom],
            )
        return frame

    def go_to(self, row: int) -> None:
        """Show the state of a row."""
        self._data.qpos[:] = self._walk.qpos[row]
        mujoco.mj_kinematics(self._model, self._data)
        for body, frame in self._bodies:
            frame.position, frame.wxyz = self._data.xpos[body], self._data.xquat[body]
        ring, colour = support(self._walk, row)
        _line(self._scene, "/support", ring, colour, self._walk, WIDE)


def _draw_still(scene: SceneApi, walk: Run) -> None:
    """Floor, paths, goal and footprints, which do not move."""
    reach = walk.reach
    scene.set_up_direction("+z")
    middle, extent = middle_and_extent(walk)
    size, cells = 8 * reach + 2 * extent, {"cell_size": 0.1, "section_size": 0.5}
    scene.add_grid("/floor", width=size, height=size, position=(*middle, 0.0), **cells)
    _line(scene, f"/{NOMINAL.label}", walk.nominal[:, :2], NOMINAL.colour, walk, WIDE)
    paths = [(PREDICTED[name], poses) for name, poses in walk.drawn.items()]
    for mark, poses in (*paths, (ACHIEVED, walk.achieved)):
        _line(scene, f"/{mark.label}", thinned(poses[:, :2]), mark.colour, walk, THICK)
    rows, feet = landings(walk)
    places = np.insert(walk.contact_point[rows, feet], 2, LIFT * reach, axis=1)
    owners = [palette.footprint(walk.group_of_foot[int(foot)]) for foot in feet]
    scene.add_point_cloud(
        "/footprints",
        places.astype(np.float32),
        np.array(owners, np.uint8).reshape(-1, 3),
        point_size=2 * FOOTPRINT * reach,
        point_shape="circle",
    )
    angle = np.linspace(0, 2 * np.pi, CORNERS + 1)
    ring = GOAL * reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    _line(scene, "/goal", walk.nominal[-1, :2] + ring, NOMINAL.colour, walk, WIDE)


def _line(
    scene: SceneApi, name: str, points: Array, colour: Colour, run: Run, width: float
) -> None:
    if len(points) < 2:
        return
    raised = np.insert(points, 2, LIFT * run.reach, axis=1).astype(np.float32)
    pieces = np.stack([raised[:-1], raised[1:]], axis=1)
    scene.add_line_segments(name, pieces, colour, thickness=width * run.reach)


def mesh_of(model: mujoco.MjModel, geom: int) -> tuple[Array, Array] | None:
    """Corners (N, 3) [m] and faces (M, 3) of a geom, in its frame; None of floors."""
    import trimesh

    size, kind = model.geom_size[geom], model.geom_type[geom]
    make, sides = trimesh.creation, 20  # of what is round
    if kind == KIND.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        corner, face = model.mesh_vertadr[mesh], model.mesh_faceadr[mesh]
        corners = model.mesh_vert[corner : corner + model.mesh_vertnum[mesh]]
        return corners, model.mesh_face[face : face + model.mesh_facenum[mesh]]
    if kind == KIND.mjGEOM_BOX:
        shape = make.box(extents=2 * size)
    elif kind == KIND.mjGEOM_CYLINDER:
        shape = make.cylinder(radius=size[0], height=2 * size[1], sections=sides)
    elif kind == KIND.mjGEOM_CAPSULE:
        shape = make.capsule(radius=size[0], height=2 * size[1], count=[sides, sides])
    elif kind in (KIND.mjGEOM_SPHERE, KIND.mjGEOM_ELLIPSOID):
        shape = make.icosphere(subdivisions=2, radius=1.0)
        shape.apply_scale(size if kind == KIND.mjGEOM_ELLIPSOID else size[0])
    else:
        return None
    return np.asarray(shape.vertices), np.asarray(shape.faces)
