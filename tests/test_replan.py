"""Planning again: single steps within the range, and shots to any accuracy."""

import numpy as np
import pytest

from planner.errors import ConvergenceError, RangeError
from planner.execution import Execution
from planner.extended import extend
from planner.replan import plan_step, steer
from planner.rollout import rollout
from tests.systems import LIFTED, METRES, PAPER, chained, hexapod

AT_REST = np.zeros(5)
BACKWARD = Execution(coordinates="backward")
RANGE = {"phi_1": (-0.2, 0.2), "phi_2": (-0.2, 0.2)}


@pytest.fixture(scope="module")
def paper():
    return extend(hexapod(), PAPER)


@pytest.fixture(scope="module")
def robot():
    return extend(hexapod(**METRES), LIFTED)


def test_three_shots_of_the_reference_reach_1e_9(paper):
    steered = steer(paper, AT_REST, [1, 1, 0, 0, 0], BACKWARD)
    assert len(steered.distances) == 4
    assert steered.distances[-1] < 1e-9
    end = rollout(steered.plan)[-1]
    assert end == pytest.approx([1, 1, 0, 0, 0], abs=1e-9)


def test_nilpotent_system_needs_one_shot():
    extended = extend(chained(4), ["g1", "g2", "[g1,g2]", "[g1,[g1,g2]]"])
    steered = steer(extended, np.zeros(4), [1, -1, 2, 0.5], BACKWARD)
    assert len(steered.distances) == 2
    assert steered.critical_step == np.inf


def test_every_shot_halves_the_distance_to_its_target(paper):
    # so the distance to the goal falls by a quarter or more even in the first half
    steered = steer(paper, AT_REST, [10, 10, 3, 0, 0], BACKWARD)
    ratios = np.divide(steered.distances[1:], steered.distances[:-1])
    assert ratios.max() <= 0.75
    assert steered.distances[-1] < 1e-9


def test_steps_beyond_the_critical_one_are_cut(paper):
    # where one step of 14 m and 3 rad does not halve the distance
    steered = steer(paper, AT_REST, [10, 10, 3, 0, 0], BACKWARD)
    assert 0 < steered.critical_step < np.linalg.norm([10, 10, 3])


def test_goal_already_met_needs_no_shot(paper):
    steered = steer(paper, AT_REST, AT_REST, BACKWARD)
    assert steered.plan.flows == ()
    assert steered.distances == (0.0,)


def test_shots_that_run_out_are_refused(paper):
    with pytest.raises(ConvergenceError, match=r"2 shots end 0\.00014.* from the goal"):
        steer(paper, AT_REST, [1, 1, 0, 0, 0], BACKWARD, max_shots=2)


def test_choice_of_coordinates_must_be_made_for_shots(paper):
    with pytest.raises(ValueError, match="choose backward or forward"):
        steer(paper, AT_REST, [1, 1, 0, 0, 0], Execution())


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
