"""Shapes as expressions against shapely: distances, hulls, discs and limbs."""

import numpy as np
import pytest
import shapely

from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

shapes = pytest.importorskip("sim.optimisation.clearances")
RNG = np.random.default_rng(3)
POINTS = RNG.uniform(-2, 2, (60, 2))


def polygon(seed, count=7):
    """Corners of a convex polygon, counter-clockwise, and its sides."""
    cloud = np.random.default_rng(seed).normal(size=(count, 2))
    corners = [tuple(map(float, cloud[k])) for k in shapes.hull_of(cloud)]
    return corners, list(zip(corners, corners[1:] + corners[:1], strict=True))


@pytest.mark.parametrize("seed", range(4))
def test_a_hull_lists_its_corners_counter_clockwise(seed):
    cloud = np.random.default_rng(seed).normal(size=(9, 2))
    corners = cloud[shapes.hull_of(cloud)]
    found, best = shapely.Polygon(corners), shapely.MultiPoint(cloud).convex_hull
    assert found.equals(best)
    assert found.exterior.is_ccw
    assert len(corners) == len(best.exterior.coords) - 1


def test_hulls_of_two_points_and_of_one_are_those():
    assert sorted(shapes.hull_of(np.array([[0.0, 0.0], [1.0, 2.0]]))) == [0, 1]
    assert shapes.hull_of(np.array([[3.0, 1.0]])) == [0]
    assert sorted(shapes.hull_of(np.array([[0.0, 0], [1, 1], [2, 2]]))) == [0, 2]


@pytest.mark.parametrize("seed", range(3))
def test_distance_of_a_point_from_a_polygon_is_shapelys(seed):
    corners, sides = polygon(seed)
    solid = shapely.Polygon(corners)
    for point in POINTS:
        spot = shapely.Point(point)
        out, inside = solid.distance(spot), solid.exterior.distance(spot)
        best = out if out > 0 else -inside
        assert float(shapes.distance(tuple(point), sides)) == pytest.approx(
            best, abs=2e-6
        )
        near = float(shapes.apart(tuple(point), sides))
        assert near == pytest.approx(inside, abs=2e-6)


def test_a_side_has_its_outside_to_its_right_and_no_end_as_a_line():
    begin, end = (1.0, 1.0), (4.0, 5.0)  # 5 long
    assert shapes.outward(begin, end, (4.0, 1.0)) == pytest.approx(12 / 5)
    assert shapes.outward(begin, end, (1.0, 5.0)) == pytest.approx(-12 / 5)
    beyond_the_end = (4.0 + 3 + 4, 5.0 + 4 - 3)
    assert shapes.outward(begin, end, beyond_the_end) == pytest.approx(5.0)
    both = [(begin, end), ((0.0, 0.0), (0.0, 1.0))]
    assert float(shapes.beyond((9.0, 5.0), both)) == pytest.approx(9.0)


def test_the_soft_least_is_a_little_below_the_least():
    values = [0.3, 0.3004, 0.31]
    best = -shapes.SMOOTHED * np.log(
        np.sum(np.exp(-np.array(values) / shapes.SMOOTHED))
    )
    found = float(shapes._soft_least(values))
    assert found == pytest.approx(best, abs=1e-12)
    assert 0.3 - shapes.SMOOTHED * np.log(3) <= found < 0.3


def part(corners, radius, leg=0, by_cos=None, by_sin=None):
    one = np.array(corners, dtype=float)
    none = np.zeros_like(one)
    terms = np.stack(
        [one, none if by_cos is None else by_cos, none if by_sin is None else by_sin]
    )
    return shapes.MovingPart(leg, terms, radius)


def test_corners_swing_with_their_leg_and_not_with_the_body():
    by_cos, by_sin = np.array([[2.0, 0.5]]), np.array([[-1.0, 3.0]])
    limb = part([[0.1, 0.2]], 0.01, 0, by_cos, by_sin)
    ((x, y),) = limb.corners(0.6, 0.8)
    assert (x, y) == pytest.approx((0.1 + 1.2 - 0.8, 0.2 + 0.3 + 2.4))
    body = part([[0.1, 0.2]], 0.01, shapes.BODY, by_cos, by_sin)
    assert body.corners(0.6, 0.8) == [pytest.approx((2.1, 0.7))]
    for swing, (place,) in zip(shapes.SWINGS, limb.sampled, strict=True):
        ((x, y),) = limb.corners(np.cos(swing), np.sin(swing))
        assert place == pytest.approx([x, y])


def test_discs_are_those_that_make_up_the_hull():
    wide, narrow = part([[0.0, 0.0], [1.0, 0.0]], 0.2), part([[0.5, 0.0]], 0.2)
    within, out = part([[0.05, 0.0]], 0.1), part([[0.5, 0.4]], 0.1)
    found = shapes.discs([narrow, within, wide, out])
    places = sorted((*one.terms[0, 0].tolist(), one.radius) for one in found)
    assert places == [(0.0, 0.0, 0.2), (0.5, 0.4, 0.1), (1.0, 0.0, 0.2)]


@pytest.mark.parametrize(
    ("place", "radius", "covered"),
    [((0.1, 0.0), 0.1, True), ((0.1, 0.0), 0.11, False), ((0.0, 0.0), 0.2, True)],
)
def test_a_disc_covers_those_that_lie_within_it(place, radius, covered):
    assert shapes._covers(part([[0.0, 0.0]], 0.2), part([place], radius)) is covered


@pytest.mark.parametrize(
    ("place", "radius", "between"),
    [
        ((0.5, 0.0), 0.15, True),  # the hull is 0.15 wide there
        ((0.5, 0.0), 0.151, False),
        ((0.5, 0.04), 0.11, True),
        ((0.5, 0.04), 0.112, False),
        ((0.25, 0.0), 0.175, True),
        ((0.25, 0.0), 0.176, False),
        ((-0.05, 0.0), 0.05, False),  # before the first
        ((1.05, 0.0), 0.01, False),
    ],
)
def test_a_disc_lies_between_two_where_their_hull_is_as_wide(place, radius, between):
    one, other = part([[0.0, 0.0]], 0.2), part([[1.0, 0.0]], 0.1)
    assert shapes._between(part([place], radius), one, other) is between
    assert not shapes._between(one, one, other)


def test_a_point_of_a_leg_is_a_sum_of_products_of_its_swing_and_lift():
    terms, swing, lift = RNG.normal(size=(3, 3, 3)), 0.3, -0.4
    basis = [np.array([1.0, np.cos(a), np.sin(a)]) for a in (swing, lift)]
    best = np.einsum("a,b,abi->i", *basis, terms)[:2]
    assert [*map(float, shapes.place_of(terms, swing, lift))] == pytest.approx(best)


@pytest.mark.parametrize(
    ("robot", "stratum"),
    [("hexapod", "1"), ("hexapod", "12"), ("hexapod-classroom", "2")],
)
def test_parts_of_legs_are_where_the_outline_has_them(robot, stratum):
    setup = prepare(load_scenario("corridor", {"robot": robot}))
    robot, outline = setup.robot, shapes.Outline(setup.robot, setup.model)
    parts = shapes.moving_parts(setup, stratum)
    assert {one.leg for one in parts} == {shapes.BODY, *range(6)}
    angle = 0.27
    swing = np.full((1, len(robot.groups)), angle)
    lift = (
        np.array([[g not in stratum for g in robot.groups]]) * setup.limits.lift_angle
    )
    qpos = outline.configurations(np.zeros((1, 3)), swing, lift)
    exact = shapely.union_all(
        [
            shapely.MultiPoint(core[0]).convex_hull.buffer(one.radius)
            for one, core in zip(
                outline.solids.parts, outline.solids.cores(qpos), strict=True
            )
        ]
    )
    found = []
    for one in parts:
        gain = 1.0 if one.leg == shapes.BODY else float(robot.swing_gain[one.leg])
        corners = one.corners(np.cos(gain * angle), np.sin(gain * angle))
        found.append(shapely.MultiPoint(corners).convex_hull.buffer(one.radius))
    assert shapely.union_all(found).symmetric_difference(exact).area < 1e-6 * exact.area


def test_every_part_belongs_to_the_leg_whose_joints_move_it():
    setup = prepare(load_scenario("corridor"))
    model, robot = setup.model, setup.robot
    for geom in range(model.ngeom):
        body, joints = int(model.geom_bodyid[geom]), set()
        while body:
            start, count = model.body_jntadr[body], model.body_jntnum[body]
            joints |= {model.joint(j).name for j in range(start, start + count)}
            body = int(model.body_parentid[body])
        legs = [
            k
            for k, card in enumerate(robot.leg_cards)
            if {card.swing, card.lift} & joints
        ]
        assert shapes._leg_of(robot, model, geom) == (legs[0] if legs else shapes.BODY)


@pytest.mark.parametrize("within", [0.02, 0.08, 1e9])
def test_pieces_are_near_if_the_body_can_come_to_them(within):
    """The robot's reach, what it may depart and what it keeps clear, from its path."""
    setup = prepare(load_scenario("corridor"))
    around = shapes.surroundings(setup).outline
    low, high = np.array(list(setup.equations.limits.values())).T
    angles = np.array([low, high, 0 * low])
    still = around.configurations(np.zeros((3, 3)), angles, 0 * angles)
    reach = max(map(around.radius, still)) + min(within, shapes.ENDLESS)
    reach += setup.scenario.min_clearance
    path = shapely.LineString(
        setup.scenario.path.curve.at(np.linspace(0, 1, 201))[:, :2]
    )
    near = {
        tuple(np.round(corner, 9))
        for obstacle in setup.scenario.obstacles
        for piece in obstacle.pieces
        for corner in piece.corners
        if path.distance(shapely.Point(corner)) < reach
    }
    found = [c for piece in shapes.near_pieces(setup, within) for c in piece.corners]
    assert {tuple(np.round(c, 9)) for c in found} == {
        tuple(np.round(c, 9)) for c in near
    }
    seen = list(shapes.near_pieces(setup, within))
    for piece in seen:
        for begin, end in piece.sides:
            assert shapely.LineString([begin, end]).distance(path) < reach
