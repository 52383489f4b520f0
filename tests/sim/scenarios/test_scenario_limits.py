"""How far and how small parts of scenarios may be, and what they are by default."""

import pytest

from sim.errors import UsageError
from sim.scenarios import body_path
from sim.scenarios.file import load_scenario
from sim.scenarios.obstacles import decode

BOX = {"kind": "box", "center": [0.5, 0.0], "size": [0.1, 0.2]}
WALL = {"kind": "wall", "points": [[0.2, -0.1], [0.2, 0.3]]}


@pytest.mark.parametrize(
    ("changes", "taken"),
    [
        ({"center": [1000.0, 0.0]}, True),
        ({"center": [1000.1, 0.0]}, False),
        ({"center": [0.0, -1000.1]}, False),
        ({"size": [1000.0, 1e-4]}, True),
        ({"size": [0.1, 0.9e-4]}, False),
        ({"size": [1000.1, 0.1]}, False),
    ],
)
def test_obstacles_are_within_a_kilometre_and_no_thinner_than_a_tenth_of_a_millimetre(
    changes, taken
):
    if taken:
        assert len(decode([BOX | changes])) == 1
    else:
        with pytest.raises(UsageError, match="1000"):
            decode([BOX | changes])


@pytest.mark.parametrize(("apart", "taken"), [(1.1e-4, True), (0.9e-4, False)])
def test_points_of_a_wall_are_a_tenth_of_a_millimetre_apart(apart, taken):
    points = {"points": [[0.2, 0.0], [0.2, apart]]}
    if taken:
        decode([WALL | points])
    else:
        with pytest.raises(UsageError, match="points that differ"):
            decode([WALL | points])


def test_obstacles_have_three_thousand_points_at_most():
    incomplete = {"kind": "box"}  # the first is refused once their number is not
    with pytest.raises(UsageError, match="obstacle 1"):
        decode([incomplete] * 3000)
    with pytest.raises(UsageError, match="3001 points of obstacles"):
        decode([incomplete] * 3001)


def test_walls_are_two_centimetres_thick_and_twelve_high_unless_they_say_otherwise():
    assert decode([WALL])[0].pieces == decode([WALL | {"thickness": 0.02}])[0].pieces
    assert decode([WALL])[0].height == 0.12
    assert decode([BOX])[0].pieces == decode([BOX | {"yaw": 0.0}])[0].pieces


@pytest.mark.parametrize(
    ("table", "least"), [(WALL, 2), ({"kind": "polygon", "points": []}, 3)]
)
def test_walls_have_two_points_and_polygons_three_at_least(table, least):
    corners = [[0.2, 0.0], [0.3, 0.0], [0.2, 0.1], [0.3, 0.2]]
    assert len(decode([table | {"points": corners[:least]}])) == 1
    with pytest.raises(UsageError, match=f"at least {least} points"):
        decode([table | {"points": corners[: least - 1]}])


def test_goals_are_within_a_thousand_kilometres():
    assert body_path.line([1e6, -1e6, 1e6]).goal == (1e6, -1e6, 1e6)
    for goal in ([1.1e6, 0, 0], [0, -1.1e6, 0], [0, 0, 1.1e6]):
        with pytest.raises(UsageError, match="beyond 1e\\+06"):
            body_path.line(goal)
    with pytest.raises(UsageError, match="beyond 1e\\+06"):
        body_path.formulas({"x": "1.1e6 * s"})


@pytest.mark.parametrize(("start", "taken"), [(0.9e-12, True), (1.1e-12, False)])
def test_formulas_begin_at_zero_but_for_rounding(start, taken):
    if taken:
        assert body_path.formulas({"x": f"{start} + s"}).goal[0] == pytest.approx(1)
    else:
        with pytest.raises(UsageError, match="the start pose"):
            body_path.formulas({"x": f"{start} + s"})


def test_lines_begin_where_the_robot_stands():
    assert body_path.line([0.1, 0.2, 0.3])(0.0).tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(("rows", "taken"), [(100_000, True), (100_001, False)])
def test_a_file_of_poses_has_a_hundred_thousand_rows_at_most(rows, taken):
    text = "x,y,yaw\n" + "0,0,0\n" * rows
    if taken:
        assert len(body_path._poses_in(text)) == rows
    else:
        with pytest.raises(ValueError, match="more than 100000 poses"):
            body_path._poses_in(text)


def test_a_list_of_poses_has_a_hundred_thousand_at_most():
    """Each is looked at by itself, which takes long for a million."""
    poses = [[0, 0, 0]] * 100_001
    assert body_path._poses("path.points", poses[1:])
    with pytest.raises(UsageError, match="two poses .*, at most 100000"):
        body_path._poses("path.points", poses)


@pytest.mark.parametrize("part", ["path.goal", "geometry.kappa"])
def test_a_part_and_the_whole_that_it_is_in_are_not_both_given(part):
    """One would replace the other, in silence."""
    whole = part.partition(".")[0]
    for keys in ((part, whole), (whole, part)):
        with pytest.raises(UsageError, match=f"{part} and {whole} are both given: "):
            load_scenario("line", dict.fromkeys(keys, {"kind": "line"}))
