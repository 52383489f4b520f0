"""Robots made of meshes, textures and height fields, wherever their files are kept."""

import struct
from types import SimpleNamespace

import imageio.v3 as iio
import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.library import load
from sim.folder import RunFolder
from sim.run_folder import run
from sim.scenarios.body_path import line
from sim.scenarios.file import load_scenario
from sim.world import model as world
from sim.world.model import build, load as load_world
from tests.walks import COSTLY

PLATE = (0.085, 0.13, 0.008)  # half sizes of the shipped body plate [m]
HEAD = """
  <compiler meshdir="parts" texturedir="looks"/>
  <include file="assets.xml"/>
  <asset><hfield name="hill" file="hill.png" size="1 1 0.1 0.1"/></asset>
  <default>
"""
ASSETS = """
  <asset>
    <mesh name="plate" file="body/part.stl"/>
    <mesh name="nose" file="nose/part.stl"/>
    <texture name="wood" type="2d" file="wood.png"/>
    <material name="wood" texture="wood"/>
  </asset>
"""


def write_box(path, half):
    """A box as a binary STL file of twelve triangles."""
    path.parent.mkdir(parents=True, exist_ok=True)
    corner = np.array(half) * [
        [x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)
    ]
    quads = (
        (0, 1, 3, 2),
        (4, 6, 7, 5),
        (0, 4, 5, 1),
        (2, 3, 7, 6),
        (0, 2, 6, 4),
        (1, 5, 7, 3),
    )
    faces = [f for a, b, c, d in quads for f in ((a, b, c), (a, c, d))]
    triangles = (
        struct.pack("<12fH", 0, 0, 0, *corner[list(f)].ravel(), 0) for f in faces
    )
    path.write_bytes(bytes(80) + struct.pack("<I", len(faces)) + b"".join(triangles))


@pytest.fixture
def hexapod_of_meshes(tmp_path):
    """The shipped hexapod, its plate and nose meshes of one name in two folders."""
    folder = tmp_path / "robot"
    write_box(folder / "parts/body/part.stl", PLATE)
    write_box(folder / "parts/nose/part.stl", (0.01, 0.04, 0.008))
    (folder / "looks").mkdir()
    noise = np.random.default_rng(0).integers(0, 255, (8, 8, 3), dtype=np.uint8)
    iio.imwrite(folder / "looks/wood.png", noise)
    iio.imwrite(folder / "parts/hill.png", noise[..., 0])
    (folder / "scene.xml").write_text((FOLDER / "scene.xml").read_text())
    (folder / "assets.xml").write_text(f"<mujoco>{ASSETS}</mujoco>")
    text = (FOLDER / "hexapod.xml").read_text()
    for old, new in (
        ("<default>", HEAD),
        (
            'size="0.085 0.13 0.008" name="plate" type="box"',
            'name="plate" type="mesh" mesh="plate" material="wood"',
        ),
        (
            'size="0.01275 0.0455 0.008" rgba="0.95 0.55 0.15 1"',
            'mesh="nose" rgba="0.95 0.55 0.15 1"',
        ),
        ('name="nose" type="box"', 'name="nose" type="mesh"'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "meshes.xml"
    path.write_text(text)
    path.with_suffix(".toml").write_text((FOLDER / "hexapod.toml").read_text())
    return path


def test_a_run_of_meshes_replays_in_bare_mujoco_wherever_it_is_moved(
    hexapod_of_meshes, scenario, tmp_path, monkeypatch
):
    made = tmp_path / "run"
    made.mkdir()
    path = line((0.005, 0.0, 0.0))
    given = scenario(robot=str(hexapod_of_meshes), path=path, segments=1)
    run(given, RunFolder(made), without=COSTLY)
    moved = made.rename(tmp_path / "elsewhere")
    hexapod_of_meshes.parent.rename(tmp_path / "gone")
    monkeypatch.chdir("/")
    model = mujoco.MjModel.from_xml_path(str(moved / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for row in np.load(moved / "commands.npz")["ctrl"]:
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
    assert (data.qpos == np.load(moved / "trajectory.npz")["qpos"][-1]).all()


def test_a_rerun_from_the_folder_gives_the_same_numbers(
    hexapod_of_meshes, scenario, tmp_path, monkeypatch
):
    path = line((0.005, 0.0, 0.0))
    given = scenario(robot=str(hexapod_of_meshes), path=path, segments=1)
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        run(given, RunFolder(tmp_path / name), without=COSTLY)
        monkeypatch.chdir("/")
        given = load_scenario(str(tmp_path / name / "scenario.toml"))
    ends = [
        np.load(tmp_path / n / "trajectory.npz")["qpos"] for n in ("first", "second")
    ]
    assert (ends[0] == ends[1]).all()


def test_every_file_is_kept_once_and_as_it_is(hexapod_of_meshes, scenario):
    world = build(load(str(hexapod_of_meshes)), scenario())
    folder = hexapod_of_meshes.parent
    assert world.assets == {
        "assets/part.stl": (folder / "parts/body/part.stl").read_bytes(),
        "assets/part-2.stl": (folder / "parts/nose/part.stl").read_bytes(),
        "assets/hill.png": (folder / "parts/hill.png").read_bytes(),
        "assets/wood.png": (folder / "looks/wood.png").read_bytes(),
    }


def test_another_file_of_the_same_name_is_another_mesh(hexapod_of_meshes, scenario):
    sizes = []
    for half in (PLATE, (0.05, 0.05, 0.05)):
        write_box(hexapod_of_meshes.parent / "parts/body/part.stl", half)
        model = load_world(build(load(str(hexapod_of_meshes)), scenario()))
        sizes.append(model.geom("plate").rbound[0])
    # half diagonals, as single precision keeps the vertices
    assert sizes == pytest.approx([np.hypot.reduce(PLATE), 0.05 * 3**0.5], rel=1e-6)


def test_a_file_that_the_compiler_dropped_is_looked_for_beside_the_model(
    tmp_path, monkeypatch
):
    (tmp_path / "looks").mkdir()
    (tmp_path / "looks" / "sky.png").write_bytes(b"sky")
    (tmp_path / "elsewhere.png").write_bytes(b"there")
    folders = [SimpleNamespace(meshdir="a", texturedir="b") for _ in range(3)]
    dropped, found = (
        SimpleNamespace(file=name, compiler=folder)
        for name, folder in zip(("sky.png", "sea.png"), folders, strict=False)
    )
    elements = (dropped, "looks", None), (found, "looks", tmp_path / "elsewhere.png")
    (tmp_path / "looks" / "up.png").write_bytes(b"up")
    dropped.cubefiles = ["up.png", ""]
    monkeypatch.setattr(world, "elements_with_files", lambda *_: elements)
    spec = SimpleNamespace(modelfiledir=str(tmp_path), compiler=folders[2])
    robot = SimpleNamespace(model=None, path="robot.xml")
    kept = {"assets/sky.png": b"sky", "assets/elsewhere.png": b"there"}
    kept["assets/up.png"] = b"up"
    assert world.gather(spec, robot) == kept
    assert [dropped.file, found.file, dropped.cubefiles[0]] == [*kept]
    assert {folder.texturedir + folder.meshdir for folder in folders} == {""}


def test_the_card_of_a_robot_that_is_a_link_is_beside_the_link(
    edited, tmp_path, monkeypatch
):
    """What it leads to may have any name, and another card beside it."""
    robot = edited("lift_angle = ", "lift_angle = ").path
    store, mine = tmp_path / "store", tmp_path / "mine"
    store.mkdir()
    mine.mkdir()
    (store / "1234").write_text(robot.read_text())
    (store / "1234.toml").write_text("lift_angle = 0.1")
    (mine / "scene.xml").write_text((tmp_path / "scene.xml").read_text())
    (mine / "robot.xml").symlink_to(store / "1234")
    (mine / "robot.toml").write_text(robot.with_suffix(".toml").read_text())
    monkeypatch.chdir(mine)
    read = load(load_scenario("line", {"robot": "robot.xml"}).robot)
    assert read.card_text == (mine / "robot.toml").read_text()
    (mine / "bare.xml").symlink_to(robot)  # all is beside what it leads to
    assert load(load_scenario("line", {"robot": "bare.xml"}).robot).path == robot
    main, copies = world.origin(read)
    assert main == "robot/robot.xml"
    assert copies["robot/robot.toml"] == (mine / "robot.toml").read_bytes()


def test_a_path_through_a_linked_folder_is_the_one_that_the_system_opens(
    edited, tmp_path
):
    """Two dots lead out of the folder that a link leads to."""
    robot = edited("lift_angle = ", "lift_angle = ").path
    deep, other = tmp_path / "real" / "deep", tmp_path / "real" / "robots"
    deep.mkdir(parents=True)
    other.symlink_to(tmp_path)
    (tmp_path / "link").symlink_to(deep)
    asked = {"robot": str(tmp_path / "link" / ".." / "robots" / robot.name)}
    read = load(load_scenario("line", asked).robot)
    assert read.path == tmp_path.resolve() / robot.name
    main, copies = world.origin(read)
    assert main == f"robot/{robot.name}"
    assert copies[main] == robot.read_bytes()
