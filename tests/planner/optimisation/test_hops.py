"""Searches that hop from plan to plan, and tolerances that are rounded for them."""

import numpy as np
import pytest

from planner.planning.rollouts import rollout
from planner.support.stopping import limited
from tests.planner.optimisation.step import STEP, YAW, optimised, time_of, within


def test_hops_find_shorter_plans_the_same_ones_every_time():
    found = optimised().plan()
    first = optimised(hops=4).plan()
    with limited(1e6):  # in which all of them are made
        again = optimised(hops=4).plan()
    assert first.flows == again.flows
    assert time_of(first.flows) <= time_of(found.flows)
    assert rollout(first)[-1] == pytest.approx(STEP(1.0), abs=1e-6)


@pytest.mark.parametrize("most", [0.018, 0.0185, 0.01895, 0.019, 0.02])
def test_tolerances_are_rounded_down_to_sixteen_a_decade(most):
    task = optimised(tolerances=within(most)).task
    position, yaw = task.rounded.tolerances
    assert position.most == pytest.approx(10 ** (-28 / 16))  # 17.8 mm
    assert yaw.most == YAW
    rungs = [rung.tolerances[0].most for rung in task.rungs]
    assert rungs == sorted(rungs)
    assert most / 1.01 < rungs[-1] <= most
    assert task.rounded.rounded.tolerances[0].most == pytest.approx(position.most)


def test_stages_that_are_repeated_in_a_guess_recover_once():
    (solution,) = optimised()._solutions
    order = [0, 0, 1]
    guess = solution.rearranged(order, solution.strokes[order])
    assert guess.strokes.tolist() == solution.strokes[order].tolist()
    assert guess.recoveries[0].tolist() == solution.recoveries[0].tolist()
    assert not guess.recoveries[1].any()
    assert guess.states[-1].tolist() == solution.states[2].tolist()
    assert (np.diff(guess.places) >= 0).all()
