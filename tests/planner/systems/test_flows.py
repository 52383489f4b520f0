"""Flows of strata: merging, contact switches, lifts and landings (eqs. 12 to 14)."""

import numpy as np
import pytest

from planner.planning.rollouts import play
from planner.systems.flows import (
    Flow,
    contact_switches,
    flow_map,
    merged,
    visits,
)
from tests.systems import LIFTS, hexapod, with_lifts

START = np.array([0.2, -0.1, 0.4, 0.1, -0.2, 0.0, 0.0])
SWINGS = (Flow("1", "g1_2", 0.7), Flow("2", "g2_1", -0.4))  # eq. (14)
ROUNDING = 1e-14


def test_consecutive_flows_of_one_field_are_merged():
    flows = [Flow("1", "g1_1", 0.5), Flow("1", "g1_1", -0.2), Flow("1", "g1_2", 1.0)]
    assert merged(flows) == (Flow("1", "g1_1", 0.3), Flow("1", "g1_2", 1.0))


def test_flows_that_cancel_bring_their_neighbours_together():
    flows = [Flow("1", n, t) for n, t in (("a", 1), ("b", 1), ("b", -1), ("a", 2))]
    assert merged(flows) == (Flow("1", "a", 3),)


def test_one_field_on_two_strata_is_not_merged():
    assert len(merged([Flow("1", "g", 1.0), Flow("2", "g", 1.0)])) == 2


def test_visits_are_runs_on_one_stratum():
    flows = [Flow(s, "g", 1.0) for s in "112"]
    assert [len(visit) for visit in visits(flows)] == [2, 1]


def test_first_lift_and_final_landing_are_counted():
    robot = hexapod()
    assert contact_switches(robot, SWINGS[:1]) == 2
    assert contact_switches(robot, SWINGS) == 4
    assert contact_switches(robot, SWINGS, start="1", goal="2") == 2
    assert contact_switches(robot, ()) == 0


def test_flow_map_of_a_tripod_is_an_arc():
    # the tripod's pivot is at (0, stride / yaw gain) in the body
    end = flow_map(hexapod(2.0, 0.5), "g1_1", np.zeros(5), 0.8)
    radius, angle = 4.0, 0.4
    arc = [radius * np.sin(angle), radius * (1 - np.cos(angle)), angle, 0.8, 0]
    assert end == pytest.approx(arc, abs=ROUNDING)


def test_lifts_and_landings_reach_the_same_state_as_the_flows_alone():
    # eq. (12) = eq. (14): lifting commutes with swinging
    robot = hexapod(heights=True)
    lifted = with_lifts(SWINGS, 0.03, LIFTS)
    assert [flow.field for flow in lifted] == [
        "g1_3", "g1_2", "g1_3", "g2_3", "g2_1", "g2_3",
    ]  # fmt: skip
    end = play(robot, lifted, START)[-1]
    assert end == pytest.approx(play(robot, SWINGS, START)[-1], abs=ROUNDING)


def test_lifting_a_tripod_does_not_move_the_body():
    robot = hexapod(heights=True)
    states = play(robot, with_lifts(SWINGS, 0.03, LIFTS), START)
    assert np.ptp(states[:, :3], axis=0).max() == 0.0
    assert states[:, 5:].max() == pytest.approx(0.03)
    assert states[-1, 5:] == pytest.approx([0, 0], abs=ROUNDING)


def test_a_foot_is_on_the_ground_before_another_lifts():
    robot = hexapod(heights=True)
    states = play(robot, with_lifts(SWINGS, 0.03, LIFTS), START)
    assert (states[:, 5:].min(axis=1) == 0.0).all()


def test_a_flow_from_a_configuration_of_another_length_is_refused():
    with pytest.raises(ValueError, match=r"x has shape \(1,\); give 5 coordinates"):
        flow_map(hexapod(), "g1_1", [0.0], 1.0)
