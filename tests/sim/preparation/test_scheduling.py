"""Flows become phases; recoveries take place during strokes where that is asked for."""

from itertools import groupby

import numpy as np
import pytest

from planner.systems.flows import Flow
from sim.motion.prediction import Predictor
from sim.motion.schedule import Scheduler
from sim.optimisation.judging import real_twists
from sim.planning.open_loop import plan_open_loop
from sim.preparation.scheduling import overlapped, schedule_flows
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

GROUPS = ("1", "2")
STROKE, RECOVERY = (1.0, 0.0), (0.0, 1.0)
FLOWS = [
    Flow("1", "g1_2", -0.2),
    Flow("1", "g1_1", 0.4),
    Flow("2", "g2_1", -0.5),
    Flow("2", "g2_2", 0.4),
    Flow("1", "g1_2", -0.2),
    Flow("1", "g1_1", 0.1),
]


def moves(*given):
    return [(0, flow, direction) for flow, direction in given]


def changes(moved):
    return sum(np.multiply(flow.duration, direction) for _, flow, direction in moved)


def test_a_recovery_goes_along_with_the_stroke_of_its_stay():
    stay = moves((Flow("1", "g1_2", -0.2), RECOVERY), (Flow("1", "g1_1", 0.4), STROKE))
    ((_, flow, direction),) = overlapped(stay, GROUPS)
    assert flow == Flow("1", "g1_1", 0.4)
    assert direction == pytest.approx((1.0, -0.5))


def test_a_recovery_is_shared_out_among_the_strokes_of_a_stay():
    stay = moves(
        (Flow("1", "g1_1", 0.3), STROKE),
        (Flow("1", "g1_2", 0.2), RECOVERY),
        (Flow("1", "other", -0.1), STROKE),
    )
    shared = overlapped(stay, GROUPS)
    assert [d[1] * f.duration for _, f, d in shared] == pytest.approx([0.15, 0.05])
    assert changes(shared) == pytest.approx(changes(stay))


def test_other_stays_are_left_alone():
    apart = moves(
        (Flow("1", "g1_2", 0.2), RECOVERY), (Flow("2", "g2_2", 0.4), RECOVERY)
    )
    assert overlapped(apart, GROUPS) == apart


@pytest.fixture(scope="module")
def schedules():
    found = []
    for asked in (False, True):
        setup = prepare(load_scenario("line", {"overlap_recovery": asked}))
        scheduler = Scheduler(setup.limits, setup.at_rest)
        schedule_flows(setup, scheduler, [FLOWS])
        found.append((setup, scheduler.finish()))
    return found


def test_a_stay_lasts_as_long_as_its_longest_part(schedules):
    (_, apart), (_, overlapping) = schedules
    longest = [p.steps for p in overlapping.phases if p.kind == "swing"]
    timestep = overlapping.limits.timestep
    assert longest == pytest.approx(
        [(x / 0.5 + 0.15) / timestep for x in (0.4, 0.5, 0.2)]
    )
    assert overlapping.stop < apart.stop
    assert overlapping.end.swing == pytest.approx(apart.end.swing)


def test_the_body_goes_where_it_would_have_gone(schedules):
    ends = []
    for setup, schedule in schedules:
        predict = Predictor(schedule, real_twists(setup), setup.kinematics)
        ends.append(predict(np.array([schedule.stop - 1])).pose[0])
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)


def visited(phases):
    """Strata that phases stand on in turn, those passed while a foot moves included."""
    on = [phase.stratum for phase in phases if phase.kind == "swing"]
    return [name for name, _ in groupby(on)]


def contacts(phases):
    """Groups lifted and set down in turn."""
    moved = [phase for phase in phases if phase.kind in ("lift", "land")]
    return [(phase.kind, GROUPS[phase.moving[0]]) for phase in moved]


def scheduled(flows, gait=None):
    changes = {"segments": 1} | ({"gait": gait} if gait else {})
    setup = prepare(load_scenario("line", changes))
    scheduler = Scheduler(setup.limits, setup.at_rest)
    schedule_flows(setup, scheduler, [flows])
    return scheduler.finish().phases


UP_1, DOWN_1, UP_2, DOWN_2 = (
    (kind, group) for group in GROUPS for kind in ("lift", "land")
)


def test_a_gait_is_walked_in_full_also_where_nothing_flows():
    """S1, S2 and again S1, between which the gait comes back to S12 and S1."""
    twice = ["12", "1", "12", "1", "12", "2", "12"]
    flows = [Flow("1", "g1_1", 0.2), Flow("2", "g2_2", 0.1), Flow("1", "g1_1", -0.2)]
    assert contacts(scheduled(flows)) == [UP_2, DOWN_2, UP_1, DOWN_1, UP_2, DOWN_2]
    half_way = contacts(scheduled(flows, twice))  # where it enters the gait
    assert half_way == contacts(scheduled(flows))
    back = [*flows, Flow("2", "g2_2", -0.1)]
    once = [UP_2, DOWN_2, UP_1, DOWN_1]
    assert contacts(scheduled(back, twice)) == [*once, UP_2, DOWN_2, *once]
    assert visited(scheduled(back, twice)) == ["1", "2", "1", "2"]


def test_between_two_strokes_on_a_stratum_the_gait_goes_around():
    """S2, S1 and again S2, with S12 in between; the second stay on S1 is skipped."""
    flows = [Flow("2", "g2_2", 0.2), Flow("1", "g1_1", 0.1), Flow("2", "g2_2", -0.2)]
    thrice = ["12", "1", "12", "1", "12", "1", "12", "2", "12"]
    turn = [UP_2, DOWN_2]
    assert contacts(scheduled(flows, thrice)) == [UP_1, DOWN_1, *turn * 3, UP_1, DOWN_1]


def test_the_gait_of_the_card_changes_nothing_for_tripods():
    plain, ordered = (
        plan_open_loop(prepare(load_scenario("line", {"segments": 4} | changes)))
        for changes in ({}, {"gait": ["12", "1", "12", "2", "12"]})
    )
    assert plain.flows == ordered.flows
    assert plain.contact_switches == ordered.contact_switches
