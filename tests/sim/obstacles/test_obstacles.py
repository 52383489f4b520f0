"""Obstacles as text, as areas of the floor, and as solids that the engine knows."""

import mujoco
import numpy as np
import pytest
import shapely

from models.library import load as load_robot
from sim.errors import UsageError
from sim.physics.engine import Engine
from sim.preparation.setup import prepare
from sim.scenarios import obstacles as shapes
from sim.scenarios.file import dumps, load_scenario
from sim.scenarios.scenario import Scenario
from sim.world.model import build, load as load_world
from sim.world.sensors import Touches

WALL = {"kind": "wall", "points": [[0.4, -0.5], [0.4, 0.3], [0.9, 0.3]]}
BOX = {"kind": "box", "center": [0.5, -0.4], "size": [0.2, 0.1], "yaw": 0.3}
TRIANGLE = {"kind": "polygon", "points": [[0.5, 0.5], [0.8, 0.5], [0.6, 0.9]]}
NOTCHED = {
    "kind": "polygon",
    "points": [[0.5, 0.5], [1.1, 0.5], [1.1, 1.1], [0.8, 0.7], [0.5, 1.1]],
    "height": 0.2,
}
ALL = [WALL, BOX, TRIANGLE, NOTCHED]
ids = [f"{table['kind']}{i}" for i, table in enumerate(ALL)]


def decoded(table):
    return shapes.decode([table])[0]


def world(scenario, *tables):
    text = build(load_robot("hexapod"), scenario(obstacles=shapes.decode(list(tables))))
    return load_world(text)


@pytest.mark.parametrize("table", ALL, ids=ids)
def test_an_obstacle_survives_encoding(table):
    assert shapes.decode([shapes.encode(decoded(table))]) == (decoded(table),)


def test_a_scenario_with_obstacles_survives_its_file(scenario, tmp_path):
    before = scenario(obstacles=shapes.decode(ALL), name="walled")
    file = tmp_path / "walled.toml"
    file.write_text(dumps(before))
    assert load_scenario(str(file)) == before


def test_a_wall_covers_half_its_thickness_on_either_side_and_closes_its_corners():
    area = decoded(WALL | {"thickness": 0.1}).area
    chain = shapely.LineString(WALL["points"])
    expected = chain.buffer(0.05, cap_style="square", join_style="mitre")
    assert shapely.symmetric_difference(area, expected).area < 1e-12


def test_a_box_is_turned_about_its_centre():
    area = decoded(BOX).area
    assert area.area == pytest.approx(0.02)
    assert area.centroid.coords[0] == pytest.approx((0.5, -0.4))
    edge = np.diff(np.array(area.minimum_rotated_rectangle.exterior.coords), axis=0)
    longest = edge[np.hypot(*edge.T).argmax()]
    assert np.arctan2(*longest[::-1]) % np.pi == pytest.approx(0.3)


@pytest.mark.parametrize("table", [TRIANGLE, NOTCHED], ids=["convex", "notched"])
def test_a_polygon_s_pieces_are_convex_and_cover_it_exactly(table):
    made = decoded(table)
    polygon = shapely.Polygon(table["points"])
    pieces = [shapely.Polygon(piece.corners) for piece in made.pieces]
    assert all(piece.convex_hull.area == pytest.approx(piece.area) for piece in pieces)
    assert sum(piece.area for piece in pieces) == pytest.approx(polygon.area)
    assert shapely.symmetric_difference(made.area, polygon).area < 1e-12


@pytest.mark.parametrize("table", ALL, ids=ids)
def test_the_engine_s_solids_are_the_planner_s(scenario, table):
    """Rays straight down hit the solid's top over its area and the floor beside it."""
    model, area = world(scenario, table), decoded(table).area
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    rng = np.random.default_rng(5)
    points = rng.uniform((0.3, -0.7), (1.2, 1.2), (400, 2))
    points = points[
        np.abs(shapely.distance(area.boundary, shapely.points(points))) > 1e-6
    ]
    inside = shapely.contains_xy(area, points)
    assert inside.any()
    assert not inside.all()
    for point, covered in zip(points, inside, strict=True):
        start, hit = np.array([*point, 1.0]), np.zeros(1, dtype=np.int32)
        far = mujoco.mj_ray(
            model, data, start, np.array([0.0, 0, -1]), None, 1, -1, hit
        )
        height = decoded(table).height if covered else 0.0
        assert 1.0 - far == pytest.approx(height, abs=1e-6)


def test_a_world_with_obstacles_loads_in_bare_mujoco(scenario, tmp_path):
    made = scenario(obstacles=shapes.decode(ALL))
    file = tmp_path / "model.xml"
    file.write_text(build(load_robot("hexapod"), made).text)
    model = mujoco.MjModel.from_xml_path(str(file))
    names = {model.geom(i).name for i in range(model.ngeom)}
    assert {"obstacle_1_1", "obstacle_1_2", "obstacle_2_1", "obstacle_3_1"} <= names


BESIDE = {"kind": "box", "center": [0.276, 0.15], "size": [0.2, 0.1]}


@pytest.mark.physics
def test_a_leg_that_swings_into_a_box_touches_it(scenario):
    model = world(scenario, BESIDE)
    engine, touches = Engine(model), Touches(model)
    ctrl = np.tile(model.key("start").ctrl, (200, 1))
    touches.read(engine.advance(ctrl).sensordata)
    assert touches.count == 0
    ctrl[:, model.actuator("lift_1").id] = 0.3
    ctrl[:, model.actuator("swing_1").id] = -0.4 * np.linspace(0, 1, 200)
    touches.read(engine.advance(ctrl).sensordata)
    assert touches.count >= 1


def test_touches_are_counted_when_they_begin(scenario):
    model = world(scenario, BESIDE, WALL)
    touches, readings = Touches(model), np.zeros((9, model.nsensordata))
    first, second = (
        model.sensor(name).adr[0] for name in ("obstacle_1_1", "obstacle_2_2")
    )
    readings[[1, 2, 3, 6], first] = 1
    readings[2:, second] = 1
    for stretch in np.split(readings, 3):  # a touch that lasts is not counted again
        touches.read(stretch)
    assert touches.count == 3


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("wall", "'wall' is not allowed: obstacle 1; give a table whose kind is on"),
        ({"kind": "moat"}, "unknown kind 'moat': obstacle 1; there are wall, box, p"),
        (
            {"kind": "box", "size": [1, 1]},
            r"center is missing: obstacle 1; give center = \[x, y\]",
        ),
        ({"kind": "box"}, "center is missing"),  # the first of all, in every process
        (BOX | {"c": 1, "b": 1, "a": 1}, "unknown key 'c'"),
        (BOX | {"hight": 1}, "unknown key 'hight': obstacle 1; did you mean 'height'"),
        (
            BOX | {"size": [1, 0]},
            r"\[1, 0\] is not allowed: obstacle 1: size; give two",
        ),
        (
            BOX | {"yaw": "left"},
            "'left' is not allowed: obstacle 1: yaw; give an angle",
        ),
        (BOX | {"height": -1}, "-1 is not allowed: obstacle 1: height; give a length"),
        (WALL | {"thickness": 0}, "0 is not allowed: obstacle 1: thickness; give a"),
        (WALL | {"points": [[0, 0]]}, "obstacle 1: points; give at least 2 points"),
        (WALL | {"points": [[0, 0], [0, 0]]}, "give points that differ from one to"),
        (WALL | {"points": [[0, 0], [1]]}, r"\[1\] is not allowed: obstacle 1: points"),
        (WALL | {"points": [[0, 0], [1e9, 0]]}, "give a point .* none beyond 1000"),
        (
            {"kind": "polygon", "points": [[0, 0], [1, 1], [1, 0], [0, 1]]},
            "obstacle 1: points; give corners of a polygon in order, no sides crossing",
        ),
    ],
)
def test_impossible_obstacles_are_refused(table, message):
    with pytest.raises(UsageError, match=message):
        shapes.decode([table])


def test_obstacles_are_a_list():
    with pytest.raises(UsageError, match="give a list of tables"):
        shapes.decode("walls")


def test_a_scenario_without_obstacles_has_none(scenario):
    assert isinstance(scenario(), Scenario)
    assert scenario().obstacles == ()
    assert "[[obstacles]]" not in dumps(scenario())


def test_a_robot_that_starts_in_an_obstacle_is_told_which(scenario):
    box = {"kind": "box", "center": [0.15, 0.18], "size": [0.1, 0.1]}
    inside = scenario(obstacles=shapes.decode([WALL, box]))
    with pytest.raises(UsageError, match=r"\w+_1 \d+\.\d mm deep in obstacle 2: obst"):
        prepare(inside)


@pytest.mark.parametrize("thickness", [shapes.SMALLEST_SIZE, 0.05, shapes.FARTHEST])
def test_every_piece_of_a_wall_is_longer_by_its_thickness(thickness):
    across, along = decoded(WALL | {"thickness": thickness}).pieces
    assert across.half == pytest.approx(((0.8 + thickness) / 2, thickness / 2))
    assert along.half == pytest.approx(((0.5 + thickness) / 2, thickness / 2))
    assert (across.center, along.center) == ((0.4, -0.1), (0.65, 0.3))
    assert (across.yaw, along.yaw) == (pytest.approx(np.pi / 2), 0.0)


def test_a_wall_is_as_thick_and_as_high_as_documented():
    plain = decoded(WALL)
    assert plain.pieces[0].half[1] == pytest.approx(0.01)
    assert plain.height == 0.12
    assert decoded(WALL | {"height": 0.2}).height == 0.2


LEAST, MOST = 1e-4, 1e3  # [m], as docs/scenarios.md has them


@pytest.mark.parametrize("key", ["thickness", "height"])
@pytest.mark.parametrize("length", [0.99 * LEAST, 1.001 * MOST, 0.0, -1.0])
def test_lengths_that_no_obstacle_has_are_refused(key, length):
    with pytest.raises(UsageError, match=r"give a length from 0.0001 to 1000 m"):
        decoded(WALL | {key: length})
    for taken in (LEAST, MOST):
        assert decoded(WALL | {key: taken}).kind == "wall"


@pytest.mark.parametrize("apart", [0.99 * LEAST, 0.0])
def test_points_closer_than_any_length_are_refused(apart):
    with pytest.raises(UsageError, match="points that differ"):
        decoded({"kind": "wall", "points": [[0.5, 0], [0.5, apart]]})
    assert decoded({"kind": "wall", "points": [[0.5, 0], [0.5, LEAST]]}).pieces


@pytest.mark.parametrize(("kind", "least"), [("wall", 2), ("polygon", 3)])
def test_the_fewest_points_are_enough(kind, least):
    points = [[0.5, 0.0], [0.8, 0.0], [0.6, 0.4]][:least]
    assert decoded({"kind": kind, "points": points}).pieces
    with pytest.raises(UsageError, match=f"at least {least} points"):
        decoded({"kind": kind, "points": points[:-1]})


@pytest.mark.parametrize("size", [[LEAST, MOST], [MOST, LEAST]])
def test_a_box_is_as_long_as_it_says(size):
    (piece,) = decoded({"kind": "box", "center": [0.0, 0.0], "size": size}).pieces
    assert piece.half == (size[0] / 2, size[1] / 2)
    for spoilt in ([0.9 * LEAST, 1.0], [1.0, 1.1 * MOST]):
        with pytest.raises(UsageError, match="two lengths above 0"):
            decoded({"kind": "box", "center": [0.0, 0.0], "size": spoilt})


MANY = [[5 + 0.001 * i, 0.01 * (i % 2)] for i in range(31_000)]


@pytest.mark.parametrize(
    "tables",
    [
        [{"kind": "polygon", "points": MANY}],
        [{"kind": "wall", "points": MANY}],
        [BOX] * 30_000,
        [{"kind": "wall", "points": MANY[:1600]}] * 2,
    ],
)
def test_obstacles_that_take_minutes_to_compile_are_refused(tables):
    with pytest.raises(UsageError, match="points of obstacles: .*; give at most 3000"):
        shapes.decode(tables)


def test_corners_that_cross_or_have_no_area_are_no_polygon():
    bow = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0), (2.0, 3.0)]  # its sides cross
    line = [(0.0, 0.0), (1.0, 0.0), (2.0, 1e-12)]
    for corners in (bow, line):
        with pytest.raises(ValueError, match="no sides crossing"):
            shapes._polygon(corners, {})
    assert len(shapes._polygon([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], {})) == 1
