"""Postures from which legs row: kinematics, rooms and worth, on bodies made up."""

from dataclasses import replace
from math import exp

import numpy as np
import pytest

from models.adoption import crawl
from models.adoption.crawl import (
    PUSHED,
    Crawl,
    _Body,
    _moves,
    _postures,
    _pushes,
    find_crawl,
)
from models.contact.loads import least_load
from models.errors import ModelError

IDLE = 0.05  # of the fastest leg's swing: legs slower than that are left out
SHARES = (1.0, 0.75, 0.5, 0.35, 0.25, 0.15)  # of the longest stroke
LEAST_LOAD = 0.06  # share of the weight on each foot of a group that stands
MOST_SWING = 0.45  # [rad] either way, of the leg that swings farthest

HIPS = np.array([(0.1, 0.06), (0.1, -0.06), (-0.1, 0.06), (-0.1, -0.06)])
ARMS = np.array([(0.02, 0.1), (0.03, -0.09), (-0.02, 0.1), (-0.01, -0.11)])
BODY = _Body(
    HIPS, ARMS, np.array([0.012, 0.004]), np.array([0.05, 0.06, 0.04, 0.03]), 0.4 * ARMS
)
RANGES = np.array([(-0.9, 1.0), (-1.1, 0.8), (-1.0, 1.0), (-0.7, 1.2)])
TURNS = np.array([0.1, -0.2, 0.15, 0.05])


def test_legs_turn_about_their_hips_and_take_their_masses_along():
    feet, weight = BODY.placed(TURNS)
    for leg, angle in enumerate(TURNS):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([(c, -s), (s, c)])
        assert feet[leg] == pytest.approx(HIPS[leg] + turn @ ARMS[leg])
    moved = BODY.weight.copy()
    for leg, angle in enumerate(TURNS):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([(c, -s), (s, c)])
        moved += BODY.shares[leg] * (turn - np.eye(2)) @ BODY.leans[leg]
    assert weight == pytest.approx(moved)
    many = BODY.placed(np.stack([TURNS, 0 * TURNS]))
    assert many[0][0] == pytest.approx(feet)
    assert many[1] == pytest.approx(np.stack([weight, BODY.weight]))


def test_sweeps_are_the_velocities_of_feet():
    d = 1e-6
    ahead, back = (BODY.placed(TURNS + way)[0] for way in (d, -d))
    assert BODY.sweeps(TURNS) == pytest.approx((ahead - back) / (2 * d), abs=1e-8)


def test_patterns_move_feet_as_the_body_s_motion_would():
    """Each along what its leg can do, in proportion to the fastest leg."""
    (feet, weight), sweeps = BODY.placed(TURNS), BODY.sweeps(TURNS)
    ways = np.tile([-1.0, 0.0], (4, 1)), -(feet - weight) @ [(0, 1.0), (-1.0, 0)]
    for gains, way in zip(BODY.patterns(TURNS), ways, strict=True):
        best = [np.linalg.lstsq(s[:, None], w, rcond=None)[0][0] for s, w in
                zip(sweeps, way, strict=True)]  # fmt: skip
        best = np.array(best) / np.abs(best).max()
        assert gains == pytest.approx(np.where(np.abs(best) < IDLE, 0.0, best))
        assert np.abs(gains).max() == 1.0


@pytest.mark.parametrize(("share", "idle"), [(0.049, True), (0.051, False)])
def test_legs_that_hardly_move_are_left_out_of_a_pattern(share, idle):
    """The first leg points ahead, but for a little."""
    angle = np.arcsin(share)
    arms = 0.1 * np.array(
        [(np.cos(angle), np.sin(angle)), (0, -1), (0, 1), (0, -1)], dtype=float
    )
    body = replace(BODY, arms=arms)
    forward, _ = body.patterns(np.zeros(4))
    assert (forward[0] == 0) == idle
    assert np.abs(forward[1:]) == pytest.approx(np.ones(3))


def test_a_posture_shifts_all_feet_one_way_within_the_ranges():
    found = list(_postures(BODY, RANGES))
    assert len(found) > 20
    seen = set()
    for posture in found:
        room = np.minimum(RANGES[:, 1] - posture.turns, posture.turns - RANGES[:, 0])
        assert room.min() >= 0
        forward, turning = BODY.patterns(posture.turns)
        assert posture.forward.tolist() == forward.tolist()
        assert posture.turning.tolist() == turning.tolist()
        # the first leg that comes to an end in either pattern bounds the stroke
        used = np.maximum(np.abs(forward), np.abs(turning))
        rooms = [
            min(r, MOST_SWING) / u for r, u in zip(room, used, strict=True) if u > 0
        ]
        assert posture.stroke == pytest.approx(min(rooms))
        seen.add(posture.skewed)
    assert seen == {False, True}
    plain = [p for p in found if not p.skewed]
    lengths = np.linalg.norm(ARMS, axis=1)
    # feet are shifted along the body alone, by a quarter of the longest leg at a time
    shift = np.array([p.turns * lengths**2 / -ARMS[:, 1] for p in plain])
    assert shift == pytest.approx(np.tile(shift[:, :1], 4), abs=1e-12)
    steps = shift[:, 0] / (lengths.max() / 4)
    assert steps == pytest.approx(steps.round())
    assert 0.0 in steps.round()


def test_every_direction_and_spin_of_postures_is_tried():
    found = list(_postures(BODY, np.tile([-99.0, 99.0], (4, 1))))
    assert len(found) == 9 * 9 * 5
    spins = {round(p.turns.mean(), 3) for p in found[:5]}
    assert len(spins) == 5
    assert sum(not p.skewed for p in found) == 9
    alike = sorted(p.turns.mean() for p in found if np.ptp(p.turns) < 1e-9)
    assert len(alike) == 5
    assert np.array(alike) == pytest.approx(-np.array(alike[::-1]))  # both ways alike
    assert np.diff(alike) == pytest.approx(np.full(4, alike[-1] / 2))


def test_postures_much_turned_or_skewed_are_worth_less():
    flat = Crawl(np.zeros(4), ARMS, ARMS, 0.3, skewed=False)
    assert flat.worth == 0.3
    bent = replace(flat, turns=np.array([0.1, -0.5, 0.2, 0.0]))
    assert bent.worth == pytest.approx(0.3 * exp(-0.5))
    assert replace(bent, skewed=True).worth == pytest.approx(0.7 * bent.worth)


def straight(gains, turning=(1, -1, 1, -1)):
    """Legs square to the body, which swing in proportion to gains."""
    body = replace(BODY, arms=0.1 * np.array([(0, 1.0), (0, -1), (0, 1), (0, -1)]),
                   weight=np.zeros(2))  # fmt: skip
    rows = np.array(gains, dtype=float), np.array(turning, dtype=float)
    return body, Crawl(np.zeros(4), *rows, 0.3, skewed=False)


@pytest.mark.parametrize(
    ("gains", "turning", "pushes"),
    [
        ((1, -1, 1, -1), (1, 1, 1, 1), True),  # feet go back, the body ahead
        ((-1, 1, -1, 1), (1, 1, 1, 1), False),  # the other way
        ((1, 1, 1, 1), (1, 1, 1, 1), False),  # it only turns
        ((1, -1, 1, -1), (-1, -1, -1, -1), False),
        ((1, -1, 1, -1), (1, -1, 1, -1), False),
    ],
)
def test_a_pattern_pushes_the_body_ahead_and_around(gains, turning, pushes):
    back = -np.array(turning)  # clockwise swings of feet turn it anticlockwise
    assert _pushes(*straight(gains, back)) == pushes


def test_a_pattern_pushes_if_the_body_keeps_a_third_of_the_fastest_foot_s_way():
    """Here the body goes at the median of what its feet do, the others slide."""
    for middle, pushes in ((0.25, False), (0.35, True)):
        gains = (1.0, -middle, middle, -middle)
        assert _pushes(*straight(gains, (-1, -1, -1, -1))) == pushes
    assert 0.25 < PUSHED < 0.35


def wide(swing):
    """A body whose legs stand wide, and strokes of all legs by as much."""
    hips = 2 * HIPS
    body = replace(BODY, hips=hips, weight=np.zeros(2), shares=np.zeros(4))
    return body, Crawl(np.zeros(4), *np.ones((2, 4)), swing, skewed=False)


@pytest.mark.parametrize("leg", range(4))
def test_a_leg_is_set_back_while_the_others_bear_enough(leg):
    body, posture = wide(0.3)
    feet, _ = body.placed(posture.turns)
    on = np.arange(4) != leg
    ends = np.where(on, 0.0, 0.2)
    for share, can in ((0.99 * LEAST_LOAD, False), (1.01 * LEAST_LOAD, True)):
        # of the weight on the least of the others, the foot beside the lifted one
        beside = np.argmin(np.linalg.norm(feet[on] - feet[leg], axis=1))
        loads = np.full(3, (1 - share) / 2)
        loads[beside] = share
        at = replace(body, weight=loads @ feet[on])
        assert least_load(feet[on], at.weight) == pytest.approx(share)
        assert _moves(at, posture, ends, RANGES) == can


def test_a_crawl_is_the_worthiest_posture_whose_legs_can_be_set_back(monkeypatch):
    tried = []

    def moves(body, draft, ends, ranges):
        tried.append((draft, ends))
        return len({id(d) for d, _ in tried}) > 5

    monkeypatch.setattr(crawl, "_moves", moves)
    monkeypatch.setattr(crawl, "_pushes", lambda body, draft: True)
    monkeypatch.setattr(crawl._Body, "of", classmethod(lambda cls, *_: BODY))
    found = find_crawl(None, [None] * 4, RANGES, "x")
    worths = [draft.worth for draft, _ in tried]
    assert worths == sorted(worths, reverse=True)
    strokes = {share * p.stroke for p in _postures(BODY, RANGES) for share in SHARES}
    assert {draft.stroke for draft, _ in tried} <= strokes
    best = max(_postures(BODY, RANGES), key=lambda p: p.worth)
    assert worths[0] == best.worth
    last = [ends for draft, ends in tried if draft is found]
    expected = [
        sign * found.stroke * gains
        for gains in (found.forward, found.turning)
        for sign in (-1, 1)
    ]
    assert np.array(last) == pytest.approx(np.array(expected))


def test_all_shares_of_strokes_are_tried_that_are_longer_than_0_04_rad(monkeypatch):
    tried = []
    monkeypatch.setattr(crawl, "_moves", lambda body, draft, *_: tried.append(draft))
    monkeypatch.setattr(crawl, "_pushes", lambda body, draft: True)
    monkeypatch.setattr(crawl._Body, "of", classmethod(lambda cls, *_: BODY))
    with pytest.raises(ModelError):
        find_crawl(None, [None] * 4, RANGES, "x")
    every = [share * p.stroke for p in _postures(BODY, RANGES) for share in SHARES]
    assert sorted(draft.stroke for draft in tried) == sorted(
        s for s in every if s > 0.04
    )


@pytest.mark.parametrize("count", [3, 7])
def test_crawls_are_for_four_to_six_legs(count):
    with pytest.raises(ModelError, match=rf"{count}.*4.*6|4.*6.*{count}"):
        find_crawl(None, [None] * count, RANGES, "x")


def test_strokes_that_are_hardly_any_are_refused(monkeypatch):
    monkeypatch.setattr(crawl._Body, "of", classmethod(lambda cls, *_: BODY))
    monkeypatch.setattr(crawl, "_pushes", lambda body, draft: True)
    monkeypatch.setattr(crawl, "_moves", lambda *_: True)
    for room, refused in ((0.039, True), (0.041, False)):
        narrow = np.tile([-room, room], (4, 1))
        if refused:
            with pytest.raises(ModelError):
                find_crawl(None, [None] * 4, narrow, "x")
        else:
            assert find_crawl(None, [None] * 4, narrow, "x").stroke > 0.04
