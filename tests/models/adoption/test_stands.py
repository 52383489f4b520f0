"""Groups of legs turned to a pivot: without slip, within their ranges, in step."""

from math import exp, pi

import numpy as np
import pytest

from models.adoption.anatomy import Limb
from models.adoption.groups import Stand, _Legs, _surety, _worth, posed, two_groups
from models.errors import ModelError

LEAST_LOAD = 0.06  # share of the weight on each foot of a group that stands
LEAST_SWING = 0.1  # [rad] either way, of a group
MOST_SWING = 0.45  # [rad] either way, of the leg that swings farthest
PLACES = 25  # along each side of the field in which pivots are looked for

HIPS = np.array([(0.1, 0.06), (0.0, -0.09), (-0.1, 0.07)])
ARMS = np.array([(0.01, 0.1), (0.005, -0.12), (-0.02, 0.09)])
FREE = np.tile([-1.5, 1.5], (3, 1))
WEIGHT = np.array([0.0, 0.02])


def legs(ranges=FREE, weight=WEIGHT, arms=ARMS):
    return _Legs((0, 3, 4), HIPS, arms, np.asarray(ranges, dtype=float), weight)


def limbs(feet, hips=None):
    hips = 0.5 * np.asarray(feet) if hips is None else hips
    return [
        Limb("s", "l", (), "f", (), np.array(hip), np.array([*foot, 0.0]), 1.0, 1.0)
        for hip, foot in zip(hips, feet, strict=True)
    ]


PIVOTS = [(0.0, -0.06), (0.02, 0.01), (-0.03, 0.01), (0.01, -0.04)]


@pytest.mark.parametrize("pivot", PIVOTS)
def test_legs_that_turn_the_body_about_their_pivot_do_not_slip(pivot):
    lengths = np.linalg.norm(ARMS, axis=1)
    out = HIPS - pivot
    feet = HIPS + out * (lengths / np.linalg.norm(out, axis=1))[:, None]
    ranges = np.tile([-9.0, 9.0], (3, 1))
    stand = legs(ranges, weight=feet.mean(axis=0)).turned(np.array(pivot))
    assert stand.feet == pytest.approx(feet)
    spokes = stand.feet - pivot
    # a foot goes sideways as far as its leg swings it, and as the body's turn does
    assert stand.yaw * np.linalg.norm(spokes, axis=1) == pytest.approx(
        stand.gains * lengths
    )
    assert max(stand.gains) == 1.0
    away = stand.feet - HIPS
    assert np.linalg.norm(away, axis=1) == pytest.approx(lengths)
    across = away[:, 0] * spokes[:, 1] - away[:, 1] * spokes[:, 0]
    assert across == pytest.approx(np.zeros(3), abs=1e-15)
    assert ((away * (HIPS - pivot)).sum(axis=1) > 0).all()  # outward
    c, s = np.cos(stand.turns), np.sin(stand.turns)
    turned = np.stack(
        [c * ARMS[:, 0] - s * ARMS[:, 1], s * ARMS[:, 0] + c * ARMS[:, 1]]
    )
    assert pytest.approx(away) == turned.T
    assert (np.abs(stand.turns) <= pi).all()
    assert (stand.legs, stand.pivot.tolist()) == ((0, 3, 4), list(pivot))


def test_swings_end_where_the_first_leg_s_range_does():
    weight = np.mean(HIPS + ARMS, axis=0)
    free = legs(weight=weight).turned(np.array(PIVOTS[0]))
    assert free.swing == pytest.approx(MOST_SWING)  # of the leg that swings farthest
    for leg in range(3):
        for side, sign in ((0, -1), (1, 1)):
            room, ranges = 0.2, FREE.copy()
            ranges[leg, side] = free.turns[leg] + sign * room
            found = legs(ranges, weight).turned(np.array(PIVOTS[0]))
            assert found.swing == pytest.approx(min(MOST_SWING, room / free.gains[leg]))


def ranged(swing):
    """Legs turned to a pivot, with so much room either way for each."""
    weight = np.mean(HIPS + ARMS, axis=0)
    free = legs(weight=weight).turned(np.array(PIVOTS[0]))
    room = swing * free.gains[:, None] * [-1, 1]
    return legs(free.turns[:, None] + room, weight).turned(np.array(PIVOTS[0]))


@pytest.mark.parametrize(("share", "kept"), [(0.999, False), (1.001, True)])
def test_groups_that_hardly_swing_or_bear_hardly_anything_are_left_out(share, kept):
    assert (ranged(share * LEAST_SWING) is not None) == kept
    free = legs(weight=np.mean(HIPS + ARMS, axis=0)).turned(np.array(PIVOTS[0]))
    load = share * LEAST_LOAD  # of one foot, the others bear alike
    weight = np.array([load, (1 - load) / 2, (1 - load) / 2]) @ free.feet
    found = legs(weight=weight).turned(np.array(PIVOTS[0]))
    assert (found is not None) == kept
    if kept:
        assert found.load == pytest.approx(load)


@pytest.mark.parametrize(("share", "kept"), [(0.049, False), (0.051, True)])
def test_no_pivot_is_at_a_hip(share, kept):
    lengths = np.linalg.norm(ARMS, axis=1)
    way = HIPS[0] - HIPS.mean(axis=0)
    pivot = HIPS[0] - share * lengths.min() * way / np.linalg.norm(way)
    ranges = np.tile([-9.0, 9.0], (3, 1))
    feet = HIPS - pivot
    feet = HIPS + feet * (lengths / np.linalg.norm(feet, axis=1))[:, None]
    found = legs(ranges, feet.mean(axis=0)).turned(pivot)
    assert (found is not None) == kept


@pytest.mark.parametrize(
    ("feet", "weight", "least"),
    [
        ([(0, 0), (1, 0), (0, 1)], (0.2, 0.3), 0.2),
        ([(0, 0), (1, 0), (0, 1)], (0.6, 0.6), 0.0),
        ([(0, 0), (1, 0)], (0.3, 0.0), 0.3),
        ([(0, 0), (1, 0)], (0.3, 1e-5), 0.0),  # beside their line
    ],
)
def test_the_surety_of_a_stand_is_the_least_share_on_a_foot(feet, weight, least):
    found = _surety(np.array(feet, dtype=float), np.array(weight))
    assert found == pytest.approx(least, abs=1e-9)


SIX = [(0.2, 0.2), (0.2, -0.2), (0.0, 0.25), (0.0, -0.25), (-0.2, 0.2), (-0.2, -0.2)]


def test_of_all_pairs_of_groups_those_that_stand_surest_come_first():
    ways = two_groups(limbs(SIX), np.zeros(2), "x")
    assert ways[0] == ((0, 3, 4), (1, 2, 5))
    sure = []
    for one, other in ways:
        assert one[0] == 0
        assert sorted(one + other) == list(range(6))
        feet = np.array(SIX)
        sure.append(min(_surety(feet[list(g)], np.zeros(2)) for g in (one, other)))
    assert sure == sorted(sure, reverse=True)
    assert min(sure) >= LEAST_LOAD


def test_the_twelve_surest_pairs_of_groups_are_tried():
    angles = 2 * pi * np.arange(8) / 8 + 0.1
    feet = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    assert len(two_groups(limbs(feet), np.zeros(2), "x")) == 12


@pytest.mark.parametrize(("count", "sizes"), [(6, {3}), (7, {3, 4}), (8, {3, 4, 5})])
def test_groups_have_three_legs_at_least(count, sizes, monkeypatch):
    monkeypatch.setattr("models.adoption.groups.MOST_WAYS", 1000)
    angles = 2 * pi * np.arange(count) / count + 0.1
    feet = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ways = two_groups(limbs(feet), np.zeros(2), "x")
    assert {len(group) for way in ways for group in way} == sizes
    with pytest.raises(ModelError, match="5"):
        two_groups(limbs(feet[:5]), np.zeros(2), "x")


def stand(pivot, yaw, swing, load, turn):
    none = np.zeros(1)
    turns = np.array([0.1, -turn])
    return Stand((0,), np.array(pivot), turns, none, yaw, swing, none, load)


def test_the_worth_of_two_stands_is_how_far_they_go_sideways():
    first = [stand((0, 0.1), 0.5, 0.4, 0.3, 0.2), stand((0, 0.3), 0.6, 0.2, 0.1, 0.9)]
    other = [stand((0, -0.1), 0.7, 0.3, 0.2, 0.5)]
    expected = [
        0.2 * (0.5 * 0.4 * 0.3) * (0.7 * 0.3 * 0.2) * exp(-0.5),
        0.4 * (0.6 * 0.2 * 0.1) * (0.7 * 0.3 * 0.2) * exp(-0.9),
    ]
    assert _worth(first, other) == pytest.approx(np.array(expected)[:, None])


@pytest.mark.parametrize("arms", [ARMS, 3 * ARMS])
def test_pivots_are_looked_for_in_the_field_of_the_hips_or_of_a_leg(arms):
    tried = []

    class Noted(_Legs):
        def turned(self, pivot):
            tried.append(pivot)
            return "stand" if len(tried) % 2 else None

    hips = np.array([(0.1, 0.04), (-0.1, -0.06)])
    found = Noted((0, 1, 2), HIPS, arms, FREE, WEIGHT).stands(hips)
    assert set(found) == {"stand"}
    x, y = np.array(tried).T
    half = np.linalg.norm(arms, axis=1).mean() / 2
    assert (x.min(), x.max()) == pytest.approx((-max(0.1, half), max(0.1, half)))
    wide = max(0.05, half)
    assert (y.min(), y.max()) == pytest.approx((-0.01 - wide, -0.01 + wide))
    assert len(tried) == PLACES**2
    assert np.diff(np.unique(x.round(12))) == pytest.approx(2 * max(0.1, half) / 24)


def test_gains_are_brought_to_halves_thirds_or_quarters_by_a_pivot_nearby():
    moved = 0
    for x in np.linspace(-0.08, 0.08, 9):
        for y in np.linspace(-0.2, 0.0, 6):
            group = legs(weight=np.mean(HIPS + ARMS, axis=0))
            found = group.turned(np.array([x, y]))
            if found is None:
                continue
            near = group.in_step(found)
            parts = [k * near.gains for k in (1, 2, 3, 4)]
            even = [
                k for k, p in enumerate(parts, 1) if np.abs(p - p.round()).max() < 1e-8
            ]
            possible = [
                k for k in (1, 2, 3, 4)
                if np.abs((k * found.gains).round() / k - found.gains).max() < 0.1
                and (k * found.gains).round().min() > 0
            ]  # fmt: skip
            if near is found:
                continue
            moved += 1
            assert min(even) == min(possible)  # in as few parts as can be
            assert np.abs(near.gains - found.gains).max() < 0.1
    assert moved > 10


def test_turned_legs_keep_apart_and_ways_without_pivots_are_passed_over():
    feet = np.array(SIX)
    hips, free = 0.6 * feet, np.tile([-1.0, 1.0], (6, 1))
    good, bad = ((0, 3, 4), (1, 2, 5)), ((0, 1, 2), (3, 4, 5))
    pair = posed(limbs(feet, hips), [bad, good], np.zeros(2), free, "x")
    assert tuple(stand.legs for stand in pair) == good
    places = np.concatenate([stand.feet for stand in pair])
    apart = [np.linalg.norm(a - b) for i, a in enumerate(places) for b in places[:i]]
    before = [np.linalg.norm(a - b) for i, a in enumerate(feet) for b in feet[:i]]
    assert min(apart) > 0.6 * min(before)
    with pytest.raises(ModelError):
        posed(limbs(feet, hips), [good], np.zeros(2), 0.1 * free, "x")
