"""Replanning makes good what an imperfect robot misses, before it misses it."""

from math import radians

import numpy as np
import pytest

from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.simulation import simulate
from sim.walking.walker import Walker, carry_out

BENT = {"zero_offset": radians(1.0), "slope": [0.03, 1.0], "draw": 2}


def test_it_learns_of_itself_on_imperfect_robots_alone(scenario):
    found = [
        prepare(scenario(replan=True, **changes)).learns
        for changes in ({}, BENT, {"learn": True}, BENT | {"learn": False})
    ]
    assert found == [False, True, True, False]
    assert not prepare(scenario(**BENT)).learns  # open loop


@pytest.mark.physics
def test_a_bent_robot_on_a_slope_arrives_once_it_has_learned_what_it_misses(scenario):
    def off(learn):
        way = {"path": line((0.02, 0.0, 0.0)), "segments": 5, "replan": True}
        summary = simulate(scenario(learn=learn, **way, **BENT)).summary
        return summary["error"]["goal"]["position"]

    # 4 mm a segment; measured 0.015 mm with and 0.30 mm without what was learned
    learned = off(learn=True)
    assert learned < 0.1e-3
    assert off(learn=False) > 2 * learned


@pytest.mark.physics
def test_a_segment_is_aimed_aside_by_what_segments_before_missed(scenario):
    """The first stroke is planned as ever; the next segments are not."""

    def swings(learn):
        setup = prepare(scenario(replan=True, segments=3, learn=learn, **BENT))
        walker = Walker(setup)
        walk = carry_out(walker, None)
        return [
            np.array([p.amount for p in stretch.schedule.phases if p.kind == "swing"])
            for stretch in walk.stretches[1:]
        ]

    plain, learned = swings(learn=False), swings(learn=True)
    assert plain[0][0] == learned[0][0]
    assert len(plain[1]) != len(learned[1]) or (plain[1] != learned[1]).any()
