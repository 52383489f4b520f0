"""How exactly commands come, and where motions begin."""

from inspect import signature
from types import SimpleNamespace

import numpy as np
import pytest

from sim.errors import UsageError
from sim.experiments.identification import follows_commands
from sim.motion.prediction import Predictor
from sim.motion.schedule import Scheduler, command_at, step_of
from sim.preparation.scheduling import check_distance
from sim.preparation.setup import Setup
from sim.preparation.shared import Shared


@pytest.mark.parametrize(("off", "number"), [(0.9e-9, 3), (1.1e-9, 2)])
def test_a_command_is_in_force_at_its_step_but_for_rounding(off, number):
    assert command_at(np.array([3]), 1 - off / 3)[0] == number
    late = step_of(np.array([3]), 1 / (1 + off / 3))[0]
    assert late == (3 if number == 3 else 4)


def test_schedules_begin_with_the_first_segment_at_the_first_step():
    scheduler = Scheduler(None, SimpleNamespace(swing=(0.0,), stratum="12"))
    assert scheduler.segment == 0
    assert scheduler._step == 0


@pytest.mark.parametrize(
    ("made", "name"), [(Predictor, "start_pose"), (Setup, "goal_offset")]
)
def test_robots_start_at_the_origin_and_plans_end_at_their_goals(made, name):
    assert signature(made).parameters[name].default == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(("strokes", "planned"), [(249_900, True), (250_100, False)])
@pytest.mark.parametrize("goal", [(1.0, 0.0), (0.0, 2.0)])
def test_a_quarter_of_a_million_radians_of_strokes_are_planned(strokes, planned, goal):
    way, turn = goal
    path = SimpleNamespace(length=way, goal=(way, 0.0, turn))
    twist = (0.6 * way / strokes, 0.8 * way / strokes, -turn / strokes)
    setup = SimpleNamespace(
        scenario=SimpleNamespace(path=path, name="it"),
        equations=SimpleNamespace(twists={"a": twist, "b": (0.0, 0.0, 0.0)}),
    )
    if planned:
        check_distance(setup)
    else:
        with pytest.raises(UsageError, match="at most 250,000 rad are planned"):
            check_distance(setup)


def test_thirty_two_things_of_a_kind_are_kept():
    shared, built = Shared(), []
    for key in (*range(33), 1, 0):
        shared.cached("kind", key, lambda key=key: built.append(key))
    assert built == [*range(33), 0]


@pytest.mark.parametrize(("feet", "same"), [(3, True), (4, False)])
def test_loads_of_three_feet_follow_from_the_weight_alone(feet, same):
    robot = SimpleNamespace(planted=lambda on: np.arange(6) < feet)
    setup = SimpleNamespace(robot=robot)
    assert follows_commands(setup, "quasi_static", ["12"]) == same
    assert follows_commands(setup, "ideal", ["12"])
    assert not follows_commands(setup, "identified", ["12"])
