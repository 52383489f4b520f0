"""A plan that is walked has settled what would have changed it."""

import pytest

from models import equations, load
from planner import line, plan
from sim.errors import UsageError
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
