"""Leg repositioning between strokes: only strokes move the body, and it never tips."""

from dataclasses import replace

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.contact.loads import StaticStability, static_loads
from models.library import load
from models.morphology.shipped import SHAPES
from models.motion.robot_equations import equations
from planner.errors import StratumError
from planner.execution.execution import Execution
from planner.execution.stepping import stepped
from planner.extension.extended import extend
from planner.planning.algorithm import follow_path
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.systems.flows import Flow
from planner.systems.shape import ShapeCoordinates
from planner.systems.strata import StratifiedSystem

GOAL = np.array([0.02, 0.01, 0.3, *np.zeros(8)])


@pytest.fixture(scope="module")
def quadruped():
    return load("quadruped")


@pytest.fixture(scope="module")
def described(quadruped):
    return equations(quadruped)


def limits(robot):
    return {f"phi_{group}": span for group, span in robot.swing_range.items()}


@pytest.fixture(scope="module")
def extended(described):
    return extend(described.system, described.elements)


@pytest.fixture(scope="module")
def plan(quadruped, described, extended):
    return planned(quadruped, described, extended)


def planned(robot, described, extended, **changes):
    options = {
        "stance": "stepped",
        "limits": limits(robot),
        "static_stability": described.static_stability,
    }
    execution = Execution(**options | changes)
    return follow_path(extended, line(0 * GOAL, GOAL), 2, execution)


def under_load(plan):
    """Flows on all feet, those of one field and stretch joined."""
    totals = []
    for flow in plan.flows:
        if flow.stratum != plan.system.bottom:
            continue
        if totals and totals[-1][0] == flow.field:
            totals[-1][1] += flow.duration
        else:
            totals.append([flow.field, flow.duration])
    return totals


def test_body_moves_as_by_the_plan_without_steps(quadruped, described, extended, plan):
    options = {"stance": "paper", "limits": {}, "static_stability": None}
    plain = planned(quadruped, described, extended, **options)
    ends = [rollout(plan)[-1], rollout(plain)[-1]]
    assert ends[0][:3] == pytest.approx(ends[1][:3], abs=1e-12)
    assert ends[0][3:] == pytest.approx(np.zeros(8), abs=1e-12)


def test_strokes_are_centred_on_zero(plan):
    states = rollout(plan)
    loaded = [flow.stratum == plan.system.bottom for flow in plan.flows]
    angles = (states[:-1] + states[1:])[loaded, 3:7] / 2
    assert np.abs(angles).max() < 1e-12


def test_every_foot_bears_its_share_whenever_a_leg_is_in_the_air(quadruped, plan):
    kinematics, states = Kinematics(quadruped), rollout(plan)
    aloft = [k for k, f in enumerate(plan.flows) if f.stratum != plan.system.bottom]
    assert len(aloft) > 20
    for k in aloft:
        on = quadruped.planted(plan.flows[k].stratum)
        stance = kinematics.stance(states[k : k + 2, 3:7])
        loads = static_loads(stance.feet[:, on], stance.center_of_mass)
        assert loads.min() >= quadruped.card.least_load - 1e-9


def test_legs_keep_their_range(quadruped, plan):
    low, high = quadruped.swing_range["1"]
    angles = rollout(plan)[:, 3:7]
    assert low - 1e-9 <= angles.min() <= angles.max() <= high + 1e-9


def test_without_a_condition_no_leg_steps_aside(quadruped, described, extended, plan):
    free = planned(quadruped, described, extended, static_stability=None)
    fields = [[field for field, _ in under_load(p)] for p in (free, plan)]
    assert fields[0] == fields[1]
    assert len(free.flows) < len(plan.flows)


def test_weight_on_the_line_between_two_feet_is_refused(quadruped, tmp_path):
    """The same body with its feet around its middle cannot lift any leg."""
    shifted = {
        n: replace(
            leg,
            hip=(leg.hip[0] - 0.015, leg.hip[1]),
            foot=(leg.foot[0] - 0.015, leg.foot[1]),
        )
        for n, leg in SHAPES["quadruped"].legs.items()
    }
    robot = _written(replace(SHAPES["quadruped"], legs=shifted), quadruped, tmp_path)
    assert StaticStability(robot).least_loads(["234"], [np.zeros(1)] * 4).max() < 1e-9
    described = equations(robot)
    extended = extend(described.system, described.elements)
    with pytest.raises(StratumError, match="the robot would tip; put the weight"):
        planned(robot, described, extended)


def _written(shape, like, folder):
    """A robot of another shape with the card of a shipped one."""
    from models.morphology.mjcf import write_mjcf

    gains = [group.legs for group in like.card.groups.values()]
    (folder / "robot.xml").write_text(write_mjcf(shape, gains))
    for file in ("scene.xml", "quadruped.toml"):
        text = (like.path.parent / file).read_text()
        (folder / file.replace("quadruped", "robot")).write_text(text)
    return load(str(folder / "robot.xml"))


def test_a_range_beside_zero_leaves_no_room_for_strokes_around_it(
    quadruped, described, extended
):
    narrow = limits(quadruped) | {"phi_1": (0.0, 0.5)}
    with pytest.raises(StratumError, match="phi_1 around zero, which is not inside"):
        planned(quadruped, described, extended, limits=narrow)


@pytest.mark.parametrize("span", [(-0.1, 0.4), (-0.4, 0.1)], ids=["back", "front"])
def test_the_nearer_end_of_a_range_bounds_strokes_around_zero(span):
    """A way of 0.5 around zero in a range of 0.1 to one side takes three parts."""
    strata = {"1": {"push": [1, 0.5]}, "0": {"swing": [0, 1]}}
    shape = ShapeCoordinates(StratifiedSystem("x p", strata, "1"))
    (flows,) = stepped(
        shape, [[Flow("1", "push", 1.0)]], np.zeros(2), None, {"p": span}, None
    )
    assert [flow.duration for flow in flows if flow.field == "push"] == (
        pytest.approx([1 / 3] * 3)
    )
    angle = shape.trajectory(1, flows, 0.0)
    assert np.abs(angle).max() == pytest.approx(0.5 / 3 / 2, abs=1e-12)
