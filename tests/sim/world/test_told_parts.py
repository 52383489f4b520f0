"""Servos, springs and soles of a file that are not what they look like are told."""

import pytest

from sim.preparation.setup import prepare
from sim.world.changes import changes
from tests.sim.world.test_changes import FOOT, SERVO

PLUGIN = """<extension><plugin plugin="mujoco.pid"><instance name="p">
  <config key="kp" value="600"/></instance></plugin></extension>
  <actuator>"""
SWING = '<position class="swing" name="swing_1" joint="swing_1"/>'
JOINT = '<joint class="lift" name="lift_2"/>'


def told(robot, scenario, word):
    return [line for line in changes(robot, scenario()) if word in line]


def test_plugins_that_look_like_servos_are_replaced(edited, scenario):
    """The gain that its default class leaves beside a plugin is not in force."""
    law = '<plugin class="swing" joint="swing_1" plugin="mujoco.pid" instance="p"/>'
    robot = edited("<actuator>", PLUGIN, SWING, law, "[gait]", SERVO)
    assert told(robot, scenario, "motors") == [
        "servos replace the motors of joints 'swing_1'"
    ]
    model = prepare(scenario(), robot).model
    assert (model.nu, model.nplugin) == (12, 0)
    assert (model.actuator_plugin == -1).all()


def test_constant_forces_of_servos_are_left_out_and_told(edited, scenario):
    law = (
        '<general joint="swing_1" biastype="affine" gainprm="60" biasprm="10 -60 -2"/>'
    )
    robot = edited(SWING, law)
    assert told(robot, scenario, "constant force") == [
        "the servos of joints 'swing_1' have a constant force beside that of their "
        "error; it is left out"
    ]
    assert not prepare(scenario(), robot).model.actuator_biasprm[:, 0].any()


@pytest.mark.parametrize("law", ["1", "0 0 30"])
def test_springs_of_leg_joints_are_told_since_servos_work_against_them(
    edited, scenario, law
):
    robot = edited(JOINT, JOINT.replace("/>", f' stiffness="{law}" springref="0.5"/>'))
    (line,) = told(robot, scenario, "springs")
    assert line.startswith("leg joints 'lift_2' have springs; these stay in force")


HEAD = '<body><joint name="pan" {}/><geom size="0.01"/></body><body name="leg_1"'


@pytest.mark.parametrize("law", ['stiffness="0 0 3"', 'damping="0 1"', ""])
def test_a_joint_is_held_by_springs_and_dampers_of_whatever_law(edited, scenario, law):
    robot = edited('<body name="leg_1"', HEAD.format(law))
    assert len(told(robot, scenario, "joints 'pan' are held by no")) == (not law)


@pytest.mark.parametrize("own", ['adhesion="3"', 'surfacevel="0.01 0 0 0 0 0"'])
def test_feet_and_floors_that_stick_or_move_do_neither_and_are_told(
    own, edited, scenario
):
    floor = '<geom name="floor" '
    robot = edited(FOOT, FOOT.replace("/>", f" {own}/>"), floor, f"{floor}{own} ")
    (line,) = told(robot, scenario, "adhesion")
    assert line.startswith("contacts of 'floor', 'foot_1', 'foot_2', ... stick")
    model = prepare(scenario(), robot).model
    assert not model.geom_adhesion.any()
    assert not model.geom_surfacevel.any()


@pytest.mark.parametrize(
    "own", ['condim="1"', 'priority="2"', 'solref="0.1 1"', 'solimp="0.5 0.6 0.01"']
)
def test_soles_of_their_own_kind_give_way_to_the_floor_and_are_told(
    own, edited, scenario
):
    robot = edited(FOOT, FOOT.replace("/>", f" {own}/>"))
    (line,) = told(robot, scenario, "of their own")
    assert line.startswith("feet 'foot_1', 'foot_2', 'foot_3', ... have a condim, ")
    model = prepare(scenario(), robot).model
    feet = [model.geom(f"foot_{number}").priority[0] for number in range(1, 7)]
    assert model.geom("floor").priority[0] > max(feet)
