"""A plan that is walked has settled what would have changed it."""

from copy import deepcopy

import pytest

from models import equations, load
from planner import line, load_plan, plan, save_plan
from sim.errors import UsageError
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from sim.simulation import play
from sim.walking.walks import walk


@pytest.fixture(scope="module")
def planned():
    robot = load("hexapod")
    return robot, plan(equations(robot), line((0, 0, 0), (0.004, 0.004, 0)), 1)


@pytest.mark.parametrize(
    "changes",
    [
        {"segments": 3}, {"optimise": "time"}, {"fields": "paper"}, {"replan": True},
        {"steer": "compliant"}, {"friction": 0.5, "words": "shortest"},
    ],
    ids=str,
)  # fmt: skip
def test_settings_of_which_a_plan_is_made_are_refused(planned, changes):
    name = [*changes][-1]
    with pytest.raises(UsageError) as refusal:
        walk(*planned, **changes)
    assert str(refusal.value) == (
        f"the plan has settled {name} already: sim.walk; leave it out, or plan with it"
    )


@pytest.mark.parametrize("name", ["quadruped", "hexapod-classroom"])
def test_the_plan_of_another_robot_is_refused(planned, name):
    _, plan = planned
    with pytest.raises(UsageError, match=f"the plan is not one of {name}: sim.walk;"):
        walk(load(name), plan)


def test_a_setting_that_does_not_exist_is_refused_with_the_nearest(planned):
    with pytest.raises(UsageError, match="'friktion': sim.walk; did you mean"):
        walk(*planned, friktion=1)


@pytest.mark.physics
def test_settings_of_the_world_and_the_drive_are_those_of_the_walk(planned):
    given = {"friction": 0.5, "swing_speed": 1.0, "servo": "ideal", "timestep": 0.002}
    scenario = walk(*planned, **given).setup.scenario
    assert {name: getattr(scenario, name) for name in given} == given


@pytest.mark.physics
def test_a_plan_that_was_saved_or_copied_is_walked_as_it_was(planned, tmp_path):
    robot, plan = planned
    save_plan(plan, tmp_path / "plan.json")
    ends = [
        walk(robot, each).recording.moments.qpos[-1].tolist()
        for each in (plan, load_plan(tmp_path / "plan.json"), deepcopy(plan))
    ]
    assert ends[0] == ends[1] == ends[2]


def test_plans_that_start_with_legs_turned_are_refused(planned):
    robot, _ = planned
    path = line((0, 0, 0, 0.2, 0, 0, 0), (0.004, 0.004, 0, 0.2, 0, 0, 0))
    turned = plan(equations(robot), path, 1)
    with pytest.raises(UsageError, match="starts at .*0.2.*, and walks start with all"):
        walk(robot, turned)


@pytest.mark.physics
def test_a_robot_of_another_shape_is_walked_and_played_in_that_shape(planned):
    own = {"kappa": 0.4}
    robot = load("hexapod", geometry=own)
    path = line((0, 0, 0), (0.004, 0.004, 0))
    walked = walk(robot, plan(equations(robot), path, 1)).setup
    short = load_scenario("line", {"segments": 1, "path.goal": [0.004, 0.004, 0.0]})
    played = play(robot, lambda t: {"lift_1": 0.1 * t}, 0.3).walk.setup
    for setup in (walked, prepare(short, robot), played):
        assert setup.robot.geometry == own
        assert setup.scenario.geometry == own
    assert prepare(short).robot.geometry == {}
    with pytest.raises(UsageError, match="the plan is not one of hexapod"):
        walk(robot, planned[1])


@pytest.mark.physics
@pytest.mark.parametrize(
    "free", [{"allow_unstable": True}, {"plan_time": 5.0}], ids=str
)
def test_what_a_walk_may_be_refused_for_is_not_settled_by_its_plan(planned, free):
    """A plan carries none of it, and `walk` itself looks whether robots tip over."""
    assert walk(*planned, **free).phases
