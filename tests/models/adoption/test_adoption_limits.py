"""What drafts take of robots that say little, and what they aim at."""

from types import SimpleNamespace

import numpy as np
import pytest

from models.adoption import anatomy, card_text, crawl
from models.adoption.anatomy import fitting_rotor
from models.adoption.card_text import drafted_lift
from models.adoption.crawl import Crawl, find_crawl
from models.errors import ModelError


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


def test_a_motor_turns_its_rotor_at_700_rad_a_second_on_its_spring(monkeypatch):
    servo = SimpleNamespace(stiffness=49.0)
    monkeypatch.setattr(anatomy, "servo_for", lambda robot: servo)
    assert fitting_rotor(None) == pytest.approx(49.0 / 700.0**2)
