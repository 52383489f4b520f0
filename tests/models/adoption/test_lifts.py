"""How far lift joints go up, and feet on one floor, in poses made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.adoption import groups
from models.adoption.anatomy import Limb, stands
from models.adoption.card_text import drafted_lift, lift_room, rowing
from models.adoption.crawl import Crawl
from models.adoption.draft import _depth, _mid_range, _numbered
from models.adoption.groups import CLEARANCE, free_reach
from models.errors import ModelError

TRIED_ANGLES = 16  # angles that are tried, on each side
UNEVEN_FEET = 0.02  # of the stance's size; tolerance of the feet's heights


def limb(number, up=1.0, toe=(0.0, 0.0, 0.0), turn=1.0):
    names = f"s{number}", f"l{number}", (), f"f{number}"
    return Limb(*names, names[3:], np.zeros(2), np.array(toe, dtype=float), turn, up)


def pose_of(spans, angles=None):
    angles = angles or {}
    return SimpleNamespace(
        span=lambda joint: spans[joint], angle=lambda joint: angles.get(joint, 0.0)
    )


@pytest.mark.parametrize(
    ("spans", "angles", "room"),
    [
        ({"l1": (-0.5, 0.4), "l2": (-0.3, 0.9)}, {}, 0.3),
        ({"l1": (-0.5, 0.2), "l2": (-0.3, 0.9)}, {}, 0.2),
        ({"l1": (-0.5, 0.4), "l2": (-0.3, 0.9)}, {"l1": 0.3, "l2": 0.1}, 0.1),
    ],
)
def test_the_joint_with_least_room_upward_bounds_all_lifts(spans, angles, room):
    """The second raises its foot as it turns backward."""
    pose, limbs = pose_of(spans, angles), [limb(1), limb(2, up=-1.0)]
    assert lift_room(pose, limbs) == pytest.approx(room)
    assert drafted_lift(pose, limbs) == pytest.approx(min(0.3, 0.95 * room))


def test_a_drafted_lift_is_three_tenths_of_a_radian_at_most():
    assert drafted_lift(pose_of({"l1": (-9.0, 9.0)}), [limb(1)]) == 0.3


@pytest.mark.parametrize(
    ("angle", "middle"),
    [(0.0, None), (0.41, 0.1), (0.39, None), (-0.21, 0.1), (2.0, 0.1)],
)
def test_swing_joints_near_an_end_of_their_range_begin_in_its_middle(angle, middle):
    joints = {"s1": SimpleNamespace(id=0), "s2": SimpleNamespace(id=1)}
    model = SimpleNamespace(jnt_limited=[1, 0], joint=joints.get)
    pose = pose_of({"s1": (-0.3, 0.5)}, {"s1": angle, "s2": 9.0})
    pose.model = model
    found = _mid_range(pose, [limb(1), limb(2)])
    assert found == ({} if middle is None else {"s1": pytest.approx(middle)})


def test_legs_are_numbered_from_the_front_left_right_or_around():
    toes = [(-1, 1), (1, -1), (1, 1), (-1, -1), (0, -1), (0, 1)]
    found = _numbered([limb(k, toe=(*toe, 0)) for k, toe in enumerate(toes)])
    assert [leg.foot for leg in found] == ["f2", "f1", "f5", "f4", "f0", "f3"]
    toes = [(-1, 0.1), (1, 0.2), (0, 1), (0.1, -1), (-0.1, 1)]
    found = _numbered([limb(k, toe=(*toe, 0)) for k, toe in enumerate(toes)])
    angles = np.arctan2(*(np.array(toes) - np.mean(toes, axis=0)).T[::-1]) % (2 * np.pi)
    assert [leg.foot for leg in found] == [f"f{k}" for k in np.argsort(angles)]


def stood(bottoms, others=()):
    """A pose whose geoms have these lowest points, the feet first."""
    every = [*bottoms, *others]
    return SimpleNamespace(
        model=SimpleNamespace(geom=lambda name: SimpleNamespace(id=int(name[1:]))),
        bottom=lambda geom: np.array(every[geom], dtype=float),
        solid=lambda: range(len(every)),
    )


@pytest.mark.parametrize(
    ("height", "other", "stand"),
    [
        (0.0, 0.1, True),
        (0.99 * UNEVEN_FEET * 0.4, 0.1, True),
        (1.01 * UNEVEN_FEET * 0.4, 0.1, False),
        (-1.01 * UNEVEN_FEET * 0.4, 0.1, False),
        (0.001, 0.001, False),
        (0.001, 0.0011, True),
    ],
)
def test_a_robot_stands_if_its_feet_are_level_and_nothing_else_is_as_low(
    height, other, stand
):
    """Its stance is 0.4 m wide."""
    feet = [(0.1, 0.2, 0.0), (0.1, -0.2, height), (-0.1, 0.0, 0.0)]
    limbs = [limb(k) for k in range(3)]
    assert stands(stood(feet, [(0.0, 0.0, other)]), limbs) == stand
    assert stands(stood(feet), limbs) == (abs(height) <= UNEVEN_FEET * 0.4)


def test_the_steepest_leg_tells_how_deep_the_feet_are():
    pose = stood([(0.3, 0.4, -0.5), (1.0, 0.0, -0.2)])
    anchors = {"l0": (0.0, 0.0, 0.1), "l1": (0.0, 0.0, 0.2)}
    pose.data = SimpleNamespace(
        joint=lambda name: SimpleNamespace(xanchor=np.array(anchors[name]))
    )
    found = _depth(pose, [limb(0), limb(1)])
    assert found == pytest.approx(np.arctan2(0.6, 0.5))


def reached(monkeypatch, level, swings, spans, angles=None):
    limbs = [limb(0), limb(1)]
    pose = pose_of(spans, angles)

    class Known:
        def __init__(self, *_):
            pass

        def first_touching(self, farthest):
            self.farthest.append(farthest)
            return level and (level, ("shin", "belly"))

        farthest = []

    monkeypatch.setattr(groups, "_Trial", Known)
    return free_reach(pose, limbs, swings, 0.3, "here"), Known.farthest


SPANS = {"s0": (-0.5, 0.8), "s1": (-0.9, 0.4)}


@pytest.mark.parametrize(
    ("gains", "angles", "farthest", "first"),
    [
        ((1.0, -1.0), {}, 0.4, "s1"),
        ((1.0, 0.5), {}, 0.5, "s0"),
        ((-2.0, 1.0), {}, 0.25, "s0"),
        ((1.0, 1.0), {"s0": 0.7}, 0.1, "s0"),
        ((1.0, 0.8), {"s1": 0.0}, 0.5, "s0"),  # of equals the first
    ],
)
def test_groups_swing_until_the_first_joint_is_at_an_end(
    monkeypatch, gains, angles, farthest, first
):
    swings = [{0: gains[0]}, {1: gains[1]}]
    (reach, tried) = reached(monkeypatch, None, swings, SPANS, angles)
    assert (reach.swing, tried) == (pytest.approx(farthest), [pytest.approx(farthest)])
    assert not reach.touching
    told = f"where {first!r} is the first joint to reach an end of its range"
    stands_at = angles.get(first, 0.0)
    assert reach.reason == told + (
        f"; at the start it stands at {stands_at:.2f} rad" if stands_at else ""
    )


@pytest.mark.parametrize("level", [2, 9, TRIED_ANGLES])
def test_groups_swing_to_the_last_angle_at_which_nothing_touches(monkeypatch, level):
    reach, _ = reached(monkeypatch, level, [{0: 1.0}, {1: 1.0}], SPANS)
    assert reach.swing == pytest.approx(0.4 * (level - 1) / 16)
    assert reach.reason == "beyond which 'shin' and 'belly' would touch"
    assert reach.touching
    with pytest.raises(ModelError, match="'shin' and 'belly' touch"):
        reached(monkeypatch, 1, [{0: 1.0}, {1: 1.0}], SPANS)
    assert CLEARANCE == 1e-3


def test_a_crawl_s_card_names_legs_strata_and_patterns():
    crawl = Crawl(
        np.array([0.1, -0.2, 0.0, 0.0]), np.array([1.0, -0.5, 0.0, 1.0]),
        np.array([0.0, 1.0, 1.0, -1.0]), 0.3, False,
    )  # fmt: skip
    limbs = [limb(k, turn=1.0 if k % 2 else -1.0) for k in range(4)]
    lines = rowing(limbs, crawl).lines
    assert "1 = { legs = { 1 = -1 } }" in lines
    assert "2 = { legs = { 2 = 1 } }" in lines
    assert (
        'strata = ["1234", "234", "1234", "134", "1234", "124", "1234", "123", "1234"]'
        in lines
    )
    assert "groups = { 1 = 1, 2 = -0.5, 4 = 1 }" in lines
    assert "groups = { 2 = 1, 3 = 1, 4 = -1 }" in lines
    assert lines.count('strata = ["1234"]') == 2
