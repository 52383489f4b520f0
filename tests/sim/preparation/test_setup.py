"""What is decided before the first step."""

import numpy as np
import pytest

from planner.systems.flows import Flow
from sim.experiments.identification import twist_model
from sim.motion.schedule import Scheduler
from sim.optimisation.judging import task_of
from sim.preparation.scheduling import schedule_flows
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line", {"segments": 2}))


def test_what_was_measured_in_a_world_holds_for_any_path_in_it(setup):
    finer = setup.recut(np.linspace(0, 1, 5))
    assert finer.scenario.segments == 4
    assert finer == setup
    assert twist_model(finer, "quasi_static") is twist_model(setup, "quasi_static")
    assert prepare(setup.scenario) != setup


def test_commands_are_those_of_the_whole_schedule_piece_by_piece(setup):
    scheduler = Scheduler(setup.limits, setup.at_rest)
    flows = 2 * [Flow("1", "g1_1", 0.4), Flow("2", "g2_2", -0.4)]
    schedule_flows(setup, scheduler, [flows])
    schedule = scheduler.finish()
    rows = np.arange(schedule.stop - schedule.start)
    whole = setup.channels.ctrl(schedule.targets(setup.robot, rows))
    pieces = list(setup.commands(schedule))
    assert len(pieces) > 1
    assert np.array_equal(np.concatenate(pieces), whole)
    assert np.array_equal(np.concatenate(list(setup.commands(schedule, 7))), whole[:7])


def test_speeds_of_a_walk_are_those_of_the_joints_that_swing_farthest(edited):
    """Whose legs may swing twice as far as their group; strokes then last as long."""
    legs = "legs = {{ 1 = -{0}, 4 = -1, 5 = -{0} }}"
    plain, made = (
        prepare(load_scenario("line"), edited(legs.format(1), legs.format(gain)))
        for gain in (1, 2)
    )
    assert made.limits.gains == (2.0, 1.0)
    one, two = (task_of(setup, (0.01, 0.1)).price for setup in (plain, made))
    assert {name: two[name] / one[name] for name in ("g1_1", "g2_2")} == {
        "g1_1": pytest.approx(2.0), "g2_2": pytest.approx(1.0)
    }  # fmt: skip
