"""Shots and aims: goals met to any accuracy on systems that are not nilpotent."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from planner.errors import ConvergenceError, PlannerError, RangeError
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.paths import ellipse, line
from planner.planning.rollouts import play, rollout
from planner.planning.shooting import aim, steer
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, PAPER, THETA, X, Y, chained, hexapod

AT_REST = np.zeros(5)
BACKWARD = Execution(coordinates="backward")
SHORTEST = Execution(coordinates="shortest")


@pytest.fixture(scope="module")
def paper():
    return extend(hexapod(), PAPER)


@pytest.fixture(scope="module")
def robot():
    return extend(hexapod(**METRES), LIFTED)


def travel(planned):
    """Sum of sweeps under load."""
    loaded = ("g12_1", "g12_2", "g1_1", "g2_2")
    return sum(abs(flow.duration) for flow in planned.flows if flow.field in loaded)


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


def test_step_too_fast_to_be_followed_is_cut_like_one_too_long():
    fields = {"roll": [sp.cos(THETA), sp.sin(THETA), 0], "turn": [0, 0, 1]}
    wheel = extend(
        StratifiedSystem((X, Y, THETA), {"0": fields}, "0"),
        ["roll", "turn", "[roll,turn]"],
    )
    goal = [100, 50, 30]  # nearly five turns, of which nine nodes show nothing
    with pytest.raises(PlannerError, match="or the path turns too fast to be followed"):
        plan(wheel, line(np.zeros(3), goal), 1, nodes=9)
    steered = steer(wheel, np.zeros(3), goal, BACKWARD)
    assert rollout(steered.plan)[-1] == pytest.approx(goal, abs=1e-9)


def test_goal_already_met_needs_no_shot(paper):
    steered = steer(paper, AT_REST, AT_REST, BACKWARD)
    assert steered.plan.flows == ()
    assert steered.distances == (0.0,)


def test_a_goal_within_the_tolerance_needs_no_shot_either(paper):
    steered = steer(paper, AT_REST, [1e-10, 0, 0, 0, 0], BACKWARD)
    assert steered.plan.flows == ()
    assert steered.distances == pytest.approx((1e-10,))


def test_shots_that_run_out_are_refused(paper):
    with pytest.raises(ConvergenceError, match=r"2 shots end 0\.00014.* from the goal"):
        steer(paper, AT_REST, [1, 1, 0, 0, 0], BACKWARD, max_shots=2)


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ([np.nan, 1, 0, 0, 0], "point 2 is not finite"),
        ([1, 1, 0], r"point 2 has shape \(3,\), the first \(5,\)"),
    ],
)
def test_goal_that_is_no_configuration_is_refused(paper, goal, message):
    with pytest.raises(ValueError, match=message):
        steer(paper, AT_REST, goal, BACKWARD)


def test_no_segments_to_aim_are_refused(paper):
    with pytest.raises(ValueError, match="segments is 0; a whole number from 1 to"):
        aim(paper, line(AT_REST, [1, 1, 0, 0, 0]), 0, BACKWARD)


def test_choice_of_coordinates_must_be_made_for_shots(paper):
    with pytest.raises(ValueError, match="choose backward, forward or sh"):
        steer(paper, AT_REST, [1, 1, 0, 0, 0], Execution())


@pytest.mark.parametrize("stance", ["paper", "centred"])
@pytest.mark.parametrize("coordinates", ["backward", "forward", "shortest"])
def test_aimed_plan_meets_every_segments_end_open_loop(robot, coordinates, stance):
    execution = Execution(coordinates=coordinates, stance=stance)
    path = ellipse(AT_REST, (0.10, 0.06))
    planned = aim(robot, path, 12, execution)
    here = planned.start
    for k, flows in enumerate(planned.segments(), start=1):
        here = play(robot.system, flows, here)[-1]
        assert here[:3] == pytest.approx(path(k / 12)[:3], abs=1e-9)


def test_aimed_plan_has_no_more_segments_than_asked_for(paper):
    planned = aim(paper, line(AT_REST, [1, 1, 0, 0, 0]), 1, BACKWARD)
    assert len(planned.segment_ends) == 1
    assert rollout(planned)[-1] == pytest.approx([1, 1, 0, 0, 0], abs=1e-9)


def test_segment_that_cannot_be_aimed_is_refused(paper):
    with pytest.raises(ConvergenceError, match="segment 1 of 1 cannot be aimed"):
        aim(paper, line(AT_REST, [20, 20, 0, 0, 0]), 1, BACKWARD)


def test_aimed_plan_out_of_range_names_more_segments_and_they_do(robot):
    path = line(AT_REST, [0.15, 0.15, 0, 0, 0])
    within = replace(SHORTEST, stance="centred", limits={"phi_1": (-0.45, 0.45)})
    with pytest.raises(RangeError, match="plan at least") as refused:
        aim(robot, path, 5, within)
    enough = refused.value.segments
    assert enough > 5
    assert len(aim(robot, path, enough, within).segment_ends) == enough


def test_shortest_words_reach_the_same_hall_coordinates(robot):
    # so they err by the third order only, as the printed words do
    goal = 1e-3 * np.array([1, 2, 0.5, 0, 0])
    for scale in (1.0, 0.1):
        path = line(AT_REST, scale * goal)
        planned = plan(robot, path, 1, execution=Execution(coordinates="shortest"))
        # 0.0378 m and 0.56 rad a radian; sweeps of the root of the way, cubed
        miss = np.linalg.norm(rollout(planned)[-1] - scale * goal)
        assert miss < travel(planned) ** 3 * METRES["stride"] * METRES["yaw_gain"] ** 2


def test_single_shot_travels_a_third_less_by_short_words(paper):
    path = line(AT_REST, [1, 1, 0, 0, 0])
    printed, short = (aim(paper, path, 1, how) for how in (BACKWARD, SHORTEST))
    # 4 sqrt(5/8) against 4 sqrt(5/8) - 1 before the aim is corrected
    assert travel(short) < 0.75 * travel(printed)


def test_words_of_higher_degree_are_the_shorter_of_the_two():
    extended = extend(chained(4), ["g1", "g2", "[g1,g2]", "[g1,[g1,g2]]"])
    path = line(np.zeros(4), [0.4, -0.7, 0.9, -0.3])
    printed = [
        plan(extended, path, 1, execution=Execution(coordinates=o))
        for o in ("backward", "forward")
    ]
    short = plan(extended, path, 1, execution=Execution(coordinates="shortest"))
    lengths = [sum(abs(flow.duration) for flow in p.flows) for p in (*printed, short)]
    assert lengths[2] == min(lengths)
