"""What a walk asks of its servos, torque, pace and gentle steps, and which makes do."""

import re
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models import load
from models.description.servos import SERVO_KINDS
from planner.systems.flows import Flow
from sim.drive.drive import Drive
from sim.drive.feed_forward import FeedForward
from sim.drive.rehearsal import Rehearsal
from sim.errors import SimulationError, StratawalkError, UsageError
from sim.logs.log import Log
from sim.logs.playing import scenario_of, within_reach
from sim.preparation.inspection import inspected
from sim.preparation.setup import prepare
from sim.walking.walks import Walker
from tests.sim.drive.test_drive import swung


@pytest.mark.physics
@pytest.mark.parametrize("robot", ["hexapod", "hexapod-classroom"])
def test_a_robot_s_facts_tell_the_torques_of_a_walk(scenario, robot):
    setup = prepare(scenario(robot=robot))
    servos = inspected(setup.scenario, setup.robot)["servos"]
    walked = np.abs(Rehearsal(setup).torques(swung(setup)).values).max()
    assert servos["standing"] < walked < servos["sliding"]  # 0.78, 0.91 and 1.25 N m
    enough = {n for n in SERVO_KINDS if SERVO_KINDS[n].stall_torque > walked}
    assert {*servos["makes"]} <= enough <= {*servos["makes"], *servos["some"]}


def test_a_make_that_carries_a_walk_is_told_though_not_every_walk(scenario):
    """0.78 N m to stand, 1.2 N m as feet slide, and 1.08 N m of an MG996R."""
    setup = prepare(scenario(robot="hexapod", servo="mg996r"))
    servos = inspected(setup.scenario, setup.robot)["servos"]
    assert servos["some"] == ["mg996r"]
    assert "mg996r" not in servos["makes"]
    torques = Rehearsal(setup).torques(schedule := swung(setup, 0.1))
    Drive(setup).require_strength(schedule, torques)


def test_stiff_servos_on_few_commands_a_second_are_refused(scenario):
    with pytest.raises(UsageError, match="by 10 N m, and friction") as refusal:
        Walker(prepare(scenario(command_rate=50.0)))
    assert "raise command_rate to 3" in refusal.value.remedy
    slower = re.search(r"--set swing_speed=([\d.]+)", refusal.value.remedy)
    Walker(prepare(scenario(command_rate=50.0, swing_speed=float(slower[1]))))


def test_a_motion_that_is_played_is_as_fast_as_it_is(scenario):
    """Whatever `swing_speed` is, which no log has."""
    robot = load("hexapod")
    time = np.linspace(0.0, 1.0, 11)
    still = np.zeros((11, len(robot.card.joints)))
    log = within_reach(Log(time, robot.card.joints, still), robot)
    asked = scenario_of(robot, Path("still.csv"), {"command_rate": 40.0})
    Drive(prepare(asked, robot, log=log)).require_gentleness()


def test_a_servo_too_weak_is_refused_with_joint_phase_and_torque(scenario):
    setup = prepare(scenario(servo="mg90"))  # for a robot three times as heavy
    walker = Walker(setup)
    with pytest.raises(SimulationError, match=r"servo 'lift_\d' would need .* N m in"):
        walker.go([[Flow("1", "g1_1", 0.1)]])


def test_makes_that_are_strong_enough_are_named_and_no_others(scenario):
    def walk(servo):
        setup = prepare(scenario(servo=servo))
        Drive(setup).require_gentleness()
        Drive(setup).require_strength(schedule, torques)

    weak = prepare(scenario(servo="mg90"))
    schedule = swung(weak, 0.1)
    torques = Rehearsal(weak).torques(schedule)
    with pytest.raises(SimulationError) as refusal:
        Drive(weak).require_strength(schedule, torques)
    named = re.search(r"servo=([-\w]+(?: or [-\w]+)*)", refusal.value.remedy)
    makes = named[1].split(" or ")
    assert "swing_speed" not in refusal.value.remedy  # the load is there at rest
    assert refusal.value.setting == f"servo={makes[0]}"
    assert makes
    for servo in SERVO_KINDS:
        with nullcontext() if servo in makes else pytest.raises(StratawalkError):
            walk(servo)


def test_a_lower_speed_is_advised_where_speed_takes_the_torque(scenario):
    fast = {"swing_speed": 15.0, "swing_acceleration": 3000.0}
    setup = prepare(scenario(robot="hexapod-classroom", **fast))
    nothing = FeedForward(np.zeros((1000, setup.model.nu)), 10)
    schedule = swung(setup)
    with pytest.raises(SimulationError, match="or lower swing_speed") as refusal:
        Drive(setup).require_strength(schedule, nothing)
    assert ", 0 N m of it even at rest" in str(refusal.value)


def test_a_servo_set_to_go_slowly_is_refused_with_its_register(scenario):
    sts = {"robot": "hexapod-classroom", "servo": "sts3215"}
    setup = prepare(scenario(**sts))
    drive, schedule = Drive(setup), swung(setup)
    nothing = FeedForward(np.zeros((2, setup.model.nu)), 1000)
    # 400 counts a second are 0.61 rad/s, and legs lift faster than that
    said = r"go at 0.61 rad/s: servo = 'sts3215'; write \d+ into their speed register"
    with pytest.raises(UsageError, match=said):
        drive.require_strength(schedule, nothing)
    faster = prepare(scenario(**sts, servo_data={"profile_speed": 5.0}))
    Drive(faster).require_strength(schedule, nothing)


@pytest.mark.parametrize(
    ("fast", "advised"),
    [(0.4, ["lift_height"]), (1.5, ["swing_speed", "lift_height"])],
)
def test_slower_motion_that_is_advised_is_slow_enough_at_once(scenario, fast, advised):
    sts = {"robot": "hexapod-classroom", "servo": "sts3215", "swing_speed": fast}
    with pytest.raises(UsageError, match="are delivered go at 0.61") as refusal:
        require_strength(prepare(scenario(**sts)))
    named = re.findall(r"--set (\w+)=([\d.]+)", refusal.value.remedy)
    assert [name for name, _ in named] == advised
    slower = {name: float(value) for name, value in named}
    require_strength(prepare(scenario(**sts | slower)))


def test_motion_from_elsewhere_is_not_advised_to_be_planned_otherwise(scenario):
    setup = prepare(scenario(robot="hexapod-classroom", servo="sts3215"))
    played = replace(setup, motion=object())
    with pytest.raises(UsageError, match="are delivered go at 0.61") as refusal:
        require_strength(played)
    assert re.fullmatch(
        r"write \d+ into .* --set servo_data.profile_speed=[\d.]+", refusal.value.remedy
    )


def require_strength(setup):
    """Of a stroke that takes no torque."""
    schedule = swung(setup, 0.3)
    nothing = FeedForward(np.zeros((schedule.stop // 10, setup.model.nu)), 10)
    Drive(setup).require_strength(schedule, nothing)


def test_a_run_leaves_open_what_follows_from_a_make_so_that_another_may_be_named(
    scenario,
):
    for robot, left_open in (("hexapod-classroom", True), ("hexapod", False)):
        setup = prepare(asked := scenario(robot=robot))
        kept = setup.resolved(asked, robot)
        assert (kept.servo_stiffness is None, kept.servo_damping is None) == (
            left_open,
            left_open,
        )
