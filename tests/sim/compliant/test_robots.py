"""What the compliant prediction takes from a model: springs of soles, and slack."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from models.contact.sliding import Ground
from sim.compliant import anatomy as library, prediction
from sim.compliant.anatomy import anatomy_of, robots_of
from sim.compliant.phases import Phases
from sim.compliant.prediction import Leg
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

SAME_HEADING = 0.02  # [rad], where gravity leans


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


def test_points_of_a_sole_give_together_as_its_foot_gives(setup):
    robot, model = setup.robot, setup.model
    anatomy, feet = anatomy_of(robot, model), Ground.of(robot, model).contact
    for points in (1, 3):
        several = replace(anatomy, radius=np.repeat(anatomy.radius, points, axis=1))
        floor = robots_of(robot, model, several).floor[0]
        assert floor.shape == (6, points)
        assert 1 / (1 / floor).sum(axis=1) == pytest.approx(feet)


def test_a_joint_without_slack_rubs_as_it_is_damped_and_by_one_if_it_is_not(setup):
    joint = setup.robot.card.joints[0]
    assert library._slack(setup.model, joint, 0.0) == (0.0, 1.0)
    assert library._slack(setup.model, joint, 0.3) == (0.0, 0.3)


def test_a_sole_has_as_many_points_as_the_largest_and_what_it_lacks_is_absent(
    setup, monkeypatch
):
    soles = iter([
        SimpleNamespace(placed=lambda _, n=n: np.ones((n, 3)) * n, depth=0.01 * n)
        for n in (2, 1, 3)
    ])  # fmt: skip
    monkeypatch.setattr(library, "find_sole", lambda *_: next(soles))
    monkeypatch.setattr(library, "_outermost", lambda points: np.arange(len(points)))
    robot = SimpleNamespace(leg_cards=[SimpleNamespace(foot=())] * 3)
    places, radius = library._soles(robot, None, None)
    none = library.ABSENT
    assert radius.tolist() == [[0.02, 0.02, none], [0.01, none, none], [0.03] * 3]
    assert places.shape == (3, 3, 3)
    assert (places[radius != none] > 0).all()


@pytest.mark.parametrize(("leans", "turned", "same"), [
    (False, 9.0, True), (True, 9.0, False), (True, 0.9, True), (True, 1.1, False),
    (False, 0.9, True),
])  # fmt: skip
def test_a_heading_tells_phases_apart_where_the_floor_leans_alone(leans, turned, same):
    looks = np.zeros(3)
    one = SimpleNamespace(heading=0.0, looks=looks)
    other = SimpleNamespace(heading=turned * SAME_HEADING, looks=looks)
    unlike = SimpleNamespace(heading=0.0, looks=looks + 1.0)
    known = SimpleNamespace(leans=leans)
    assert Phases._same(known, one, other) == same
    assert not Phases._same(known, one, unlike)


def test_headings_of_a_leg_are_those_at_its_own_steps(setup, monkeypatch):
    """The ideal body turns by 1 mrad a step from the pose where the leg begins."""

    def predictor(schedule, twists, kinematics, pose):
        turning = lambda rows: pose[2] + 1e-3 * rows  # noqa: E731
        return lambda rows: SimpleNamespace(
            pose=np.stack([0 * rows, 0 * rows, turning(rows)], axis=1)
        )

    monkeypatch.setattr(prediction, "Predictor", predictor)
    legs = [
        Leg(
            SimpleNamespace(
                start=start, phases=[SimpleNamespace(start=start + k) for k in (0, 40)]
            ),
            np.array([0.0, 0.0, yaw]),
        )
        for start, yaw in ((0, 0.0), (700, 0.2))
    ]
    found = prediction._headings(setup, legs)
    assert found == pytest.approx([0.0, 0.04, 0.2, 0.24])
