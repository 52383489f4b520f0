"""Pivots of drafts: near where a robot goes farthest, with even loads and counts."""

import numpy as np

from models.adoption import groups
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.contact.kinematics import Kinematics
from models.contact.loads import static_loads
from models.library import load
from models.motion.robot_equations import equations, mobility_of
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


ROUND = """
<mujoco><worldbody><body name="b" pos="0 0 .1"><freejoint/>
 <geom type="cylinder" size=".1 .015" mass="1"/>
 <replicate count="6" euler="0 0 60"><frame pos=".1 0 0" euler="0 0 20">
  <body name="coxa"><joint name="hip" range="-40 40"/>
   <geom type="capsule" fromto="0 0 0 .03 0 0" size=".008" mass=".02"/>
   <body name="femur" pos=".03 0 0"><joint name="knee" axis="0 -1 0" range="-30 50"/>
    <geom type="capsule" fromto="0 0 0 .05 0 .02" size=".007" mass=".02"/>
    <geom name="foot" type="sphere" pos=".12 0 -.07" size=".01" mass=".01"/>
   </body></body></frame></replicate></body></worldbody></mujoco>
"""


def test_pivots_that_legs_in_step_would_bring_together_stay_apart(tmp_path):
    """Equal legs around a body, turned aside, whose gains are all nearly 1."""
    path = tmp_path / "round.xml"
    path.write_text(ROUND)
    drafted = draft_card(source_of(str(path)))
    path.with_suffix(".toml").write_text(drafted.card)
    robot = load(str(path))
    assert mobility_of(robot, equations(robot)).lacking == ()
