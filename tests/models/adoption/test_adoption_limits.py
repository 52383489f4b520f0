"""What drafts take of robots that say little, and what they aim at."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.adoption import card_text, crawl, draft
from models.adoption.anatomy import _within
from models.adoption.card_text import drafted_lift
from models.adoption.crawl import Crawl, _postures, find_crawl
from models.errors import ModelError
from tests.models.adoption.test_rowing import BODY


@pytest.mark.parametrize("count", range(2, 9))
def test_crawls_are_searched_for_robots_of_four_to_six_legs(count, monkeypatch):
    monkeypatch.setattr(crawl, "_postures", lambda *_: [])
    monkeypatch.setattr(crawl._Body, "of", classmethod(lambda *_: None))
    monkeypatch.setattr(
        crawl, "refusal", lambda key, *_, **facts: ModelError(str(facts))
    )
    limbs = [None] * count
    with pytest.raises(ModelError) as refused:
        find_crawl(None, limbs, np.zeros((count, 2)), "x")
    assert ("count" in str(refused.value)) == (count not in (4, 5, 6))


def test_a_posture_unlike_left_and_right_is_worth_seven_tenths():
    even, skewed = (Crawl(np.zeros(4), None, None, 0.3, side) for side in (False, True))
    assert skewed.worth == pytest.approx(0.7 * even.worth)


@pytest.mark.parametrize(("room", "lift"), [(0.2, 0.19), (0.31, 0.2945), (1.0, 0.3)])
def test_feet_are_lifted_by_0_3_rad_or_95_percent_of_the_room(room, lift, monkeypatch):
    monkeypatch.setattr(card_text, "lift_room", lambda pose, limbs: room)
    assert drafted_lift(None, []) == pytest.approx(lift)


def test_joints_keep_15_percent_of_their_range_from_its_ends_on_forty_steps():
    tried = _within(SimpleNamespace(span=lambda joint: (-0.5, 1.5)), "hip")
    assert tried[[0, -1]] == pytest.approx([-0.2, 1.2])
    assert np.diff(tried) == pytest.approx(np.full(40, 1.4 / 40))


def test_postures_are_nine_by_nine_places_of_feet_and_five_turns_of_legs():
    """By up to 0.8 rad, as far as legs can be turned."""
    every = [*_postures(BODY, np.tile([-9.0, 9.0], (4, 1)))]
    assert len(every) == 9 * 9 * 5
    alike = {round(float(one.turns[0]), 9) for one in every if not np.ptp(one.turns)}
    assert alike == {0.0, 0.4, -0.4, 0.8, -0.8}


@pytest.mark.parametrize(("length", "taken"), [(0.051, True), (0.049, False)])
def test_legs_are_a_twentieth_of_the_longest_at_least(length, taken, monkeypatch):
    monkeypatch.setattr(
        draft, "refusal", lambda key, *_, **facts: ModelError(str(facts))
    )
    limbs = [
        SimpleNamespace(hip=np.zeros(2), toe=np.array([arm, 0.0, 0.0]), foot="toe")
        for arm in (1.0, length)
    ]
    pose = SimpleNamespace(center_of_mass=None)  # which is what is needed next
    with pytest.raises(
        TypeError if taken else ModelError, match="None" if taken else "toe"
    ):
        draft._gait(pose, limbs, "x")
