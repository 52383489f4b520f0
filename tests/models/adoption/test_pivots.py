"""Pivots of drafts: near where a robot goes farthest, with even loads and counts."""

import numpy as np

from models.adoption import groups
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.contact.kinematics import Kinematics
from models.contact.loads import static_loads
from models.library import load
from scripts.adoptees import ADOPTEES


def written(name, folder):
    return next(a for a in ADOPTEES if a.name == name).write(folder)


def test_a_pivot_is_moved_by_millimetres_for_the_sake_of_counts(tmp_path, monkeypatch):
    source = source_of(str(written("scorpion", tmp_path)))
    moved = draft_card(source).gait.pivots
    monkeypatch.setattr("models.adoption.groups.MOST_CHANGE", 0.0)
    found = draft_card(source).gait.pivots
    # 4.1 mm each; 15 mm where feet are apart only once pivots are moved
    assert np.linalg.norm(np.subtract(moved, found), axis=1).max() < 0.005
    assert not np.allclose(moved, found, atol=1e-3)


def test_pivots_are_chosen_with_which_feet_bear_like_loads(tmp_path):
    source = source_of(str(written("octopus", tmp_path)))
    source.path.with_suffix(".toml").write_text(draft_card(source).card)
    robot = load(str(source.path))
    stance = Kinematics(robot).standing
    for name in "12":
        on = robot.planted(name)
        feet = stance.feet[on]
        loads = static_loads(feet[None], stance.center_of_mass[None])[0]
        # of an even one at least 0.95; 0.67 where only the way sideways counts
        assert loads.min() * len(feet) > 0.9


def test_equally_good_pivots_are_chosen_alike_however_a_processor_rounds(
    tmp_path, monkeypatch
):
    """The octopus has mirror images that differ in the last digit of their worth."""
    source = source_of(str(written("octopus", tmp_path)))
    found, worth, rng = draft_card(source).card, groups._worth, np.random.default_rng(1)

    def rounded(*sides):
        exact = worth(*sides)
        return exact * (1 + 1e-14 * rng.standard_normal(exact.shape))

    monkeypatch.setattr(groups, "_worth", rounded)
    assert [draft_card(source).card for _ in range(3)] == [found] * 3
