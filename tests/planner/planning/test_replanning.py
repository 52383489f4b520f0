"""Planning again from a state reached, within the range of the legs."""

import numpy as np
import pytest

from planner.errors import RangeError
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.extension.steering import Steering
from planner.planning.algorithm import follow_path
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.planning.shooting import plan_step
from tests.systems import LIFTED, METRES, hexapod

AT_REST = np.zeros(5)
RANGE = {"phi_1": (-0.2, 0.2), "phi_2": (-0.2, 0.2)}


@pytest.fixture(scope="module")
def robot():
    return extend(hexapod(**METRES), LIFTED)


def test_step_within_the_range_goes_the_whole_way(robot):
    execution = Execution(stance="centred", limits=RANGE, finish=False)
    step = plan_step(robot, AT_REST, [0.002, 0.001, 0, 0, 0], execution)
    assert step.fraction == 1.0


def test_step_beyond_the_range_is_scaled_down_to_it(robot):
    execution = Execution(stance="centred", limits=RANGE, finish=False)
    step = plan_step(robot, AT_REST, [0.02, 0.02, 0.1, 0, 0], execution)
    assert 0 < step.fraction < 1
    angles = np.abs(rollout(step.plan)[:, 3:]).max()
    # the fraction is found to a thousandth; angles grow with its root at least
    assert 0.999 * 0.2 <= angles <= 0.2 + 1e-9
    assert step.plan.goal[:3] == pytest.approx(
        step.fraction * np.array([0.02, 0.02, 0.1])
    )


def test_step_from_beyond_the_range_is_refused(robot):
    execution = Execution(limits=RANGE)
    with pytest.raises(RangeError, match=r"phi_1 would reach 0\.5, outside its range"):
        plan_step(robot, [0, 0, 0, 0.5, 0], [0.01, 0, 0, 0.5, 0], execution)


def test_words_are_spelled_once_for_all_choices_among_them(robot, monkeypatch):
    spelled, spell = [], Steering.scaled_words

    def counted(steering, coordinates, order, *scales):
        spelled.append(order)
        return spell(steering, coordinates, order, *scales)

    monkeypatch.setattr(Steering, "scaled_words", counted)
    away = np.array([0, 0, 0, 0.5, 0.5])  # which the limits refuse in any words
    with pytest.raises(RangeError):
        follow_path(robot, line(away, away + 0.01), 1, Execution(limits=RANGE))
    assert spelled == ["backward", "forward"]  # and not again for each alone
