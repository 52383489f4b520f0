"""What a foreign file would do to a walk: handled, or told in words."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.errors import ModelError
from models.library import load
from sim import cli, palette
from sim.pictures.drawing import Mark, ribbon
from sim.pictures.offscreen import LOOKS, PREFIX, build as build_scene, floor_height
from sim.preparation.inspection import inspected
from sim.preparation.setup import prepare
from sim.world.changes import changes

BODY = (FOLDER / "hexapod.xml").read_text()
ACTUATORS = BODY[BODY.index("  <actuator>") : BODY.index("  <sensor>")]
DEFAULTS = '<default>\n    <default class="robot">'
FOOT = '<geom type="sphere" size="0.008"/>'
START = 'qpos="0 0 0.06 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0"'
TENDON = """<tendon><fixed name="strap">
  <joint joint="lift_1" coef="1"/><joint joint="lift_4" coef="1"/></fixed></tendon>
<sensor><actuatorfrc actuator="pull"/>"""
PULL = '<position tendon="strap" name="pull" kp="300"/></actuator>'
SERVO = "[servo]\nstiffness = 1000.0\ndamping = 2.8\n\n[gait]"


def sinks(setup):
    """How far the robot sinks while it stands for a tenth of a second [m]."""
    data = mujoco.MjData(setup.model)
    mujoco.mj_resetDataKeyframe(setup.model, data, setup.model.key("start").id)
    height = data.qpos[2]
    mujoco.mj_step(setup.model, data, nstep=round(0.1 / setup.model.opt.timestep))
    return abs(float(height - data.qpos[2]))


def test_added_servos_take_nothing_from_the_file_s_defaults(edited, scenario):
    limits = '<motor ctrllimited="true" forcelimited="true" gear="7"/>'
    robot = edited(
        ACTUATORS, "", "[gait]", SERVO, DEFAULTS, DEFAULTS.replace(">", f">{limits}", 1)
    )
    model = prepare(scenario(), robot).model
    assert not model.actuator_ctrllimited.any()
    assert not model.actuator_forcelimited.any()
    assert (model.actuator_gear[:, 0] == 1).all()
    assert (model.actuator_gainprm[:, 0] == 1000).all()


def test_actuators_on_tendons_of_legs_are_left_out_and_told(edited, scenario):
    key = f'{START} ctrl="{"0 " * 12}0.5"'
    robot = edited("<sensor>", TENDON, "</actuator>", PULL, START, key)
    setup = prepare(scenario(), robot)
    assert setup.model.nu == 12
    assert sinks(setup) < 1e-3
    (told,) = changes(robot, scenario())
    assert "actuators 'pull' move leg joints by tendons" in told


COUPLED = {
    "joints": '<equality><joint joint1="lift_1" joint2="lift_4"/></equality>',
    "a tendon": TENDON.partition("<sensor>")[0]
    + '<equality><tendon name="rope" tendon1="strap"/></equality>',
}


@pytest.mark.parametrize("more", ['<velocity kv="5"', '<position kp="200"', "<motor"])
def test_further_actuators_of_a_joint_are_left_out_and_told(edited, scenario, more):
    robot = edited("</actuator>", f'{more} joint="swing_2"/></actuator>')
    told = [line for line in changes(robot, scenario()) if "further" in line]
    assert told == [
        "joints 'swing_2' have further actuators beside their servos; these are left "
        "out; servo_stiffness and servo_damping set other servos"
    ]
    assert prepare(scenario(), robot).model.nu == 12


HOLDS = "stiffness='5'", "range='-1 1'", "frictionloss='2'", "damping='0 9'", ""


@pytest.mark.parametrize("holds", HOLDS)
def test_tendons_that_hold_legs_stay_and_are_told(edited, scenario, holds):
    strap = TENDON.partition("<sensor>")[0].replace(
        'name="strap"', f'name="strap" {holds}'
    )
    robot = edited("</actuator>", "</actuator>" + strap)
    told = [
        line for line in changes(robot, scenario()) if "tendons 'strap' pull" in line
    ]
    assert len(told) == bool(holds)


@pytest.mark.parametrize("kind", COUPLED)
def test_equations_between_leg_joints_no_longer_hold_and_are_told(
    kind, edited, scenario
):
    robot = edited("<sensor>", f"{COUPLED[kind]}<sensor>")
    assert robot.model.eq_active0.all()
    assert not prepare(scenario(), robot).model.eq_active0.any()
    (told,) = changes(robot, scenario())
    name = "rope" if kind == "a tendon" else "number 1"
    assert f"equations '{name}' couple leg joints, or hold the robot in" in told


PINS = {
    "a foot": '<connect body1="leg_1" anchor="0.1 0 -0.05"/>',
    "the body": '<weld body1="torso"/>',
    "by sites": '<weld site1="on_robot" site2="in_world"/>',
    "a gantry": '<weld body1="torso" body2="hook"/>',
}
GANTRY = """<site name="in_world" pos="0 0 0.06"/>
<body name="gantry" mocap="true" pos="0 0 1"><body name="hook"/></body>
"""


@pytest.mark.parametrize("kind", PINS)
def test_a_robot_that_is_held_in_the_world_is_let_go_and_that_is_told(
    kind, edited, scenario
):
    """What ties its own parts to each other stays; what is not active is not told."""
    own = '<connect body1="leg_2" body2="torso" anchor="0 0 0"/>'
    idle = '<weld name="idle" body1="torso" active="false"/>'
    robot = edited(
        "<sensor>", f"<equality>{PINS[kind]}{own}{idle}</equality><sensor>",
        "<freejoint", '<site name="on_robot"/><freejoint',
        '<body name="torso"', f'{GANTRY}<body name="torso"',
    )  # fmt: skip
    assert robot.model.eq_active0.tolist() == [1, 1, 0]
    assert prepare(scenario(), robot).model.eq_active0.tolist() == [0, 1, 0]
    (told,) = changes(robot, scenario())
    assert "equations 'number 1' couple leg joints, or hold the robot in" in told


OWN = {
    "iterations": 'iterations="1" ls_iterations="5"',
    "tolerance": 'tolerance="1e-2"',
    "solver": 'solver="PGS"',
    "disableactuator": 'actuatorgroupdisable="0"',
}


@pytest.mark.parametrize("name", OWN)
def test_how_the_physics_is_computed_is_not_for_a_robot_to_say(
    name, edited, scenario, hexapod
):
    robot = edited("<worldbody>\n", f"<option {OWN[name]}/><worldbody>\n")
    (ours, theirs) = (prepare(scenario(), r).model.opt for r in (hexapod, robot))
    assert getattr(theirs, name) == getattr(ours, name)
    told = list(changes(robot, scenario()))
    assert any(f"its <option> sets '{name}'" in line for line in told)


@pytest.mark.parametrize("flag", ["contact", "constraint", "actuation", "filterparent"])
def test_flags_that_no_walk_survives_are_not_in_force(flag, edited, scenario):
    off = f'<option><flag {flag}="disable"/></option>'
    robot = edited("<worldbody>\n", f"{off}<worldbody>\n")
    assert prepare(scenario(), robot).model.opt.disableflags == 0
    assert "sets 'disableflags'" in next(changes(robot, scenario()))


def test_room_for_more_keyframes_than_there_are_is_given_back(edited, scenario):
    robot = edited("<worldbody>\n", '<size nkey="3"/><worldbody>\n')
    assert robot.model.nkey == 3
    assert prepare(scenario(), robot).model.nkey == 1


def test_servos_whose_states_have_a_range_follow_at_once(edited, scenario):
    """MuJoCo refuses a range of states where there are none any more."""
    servo = '<position class="swing" name="swing_2" joint="swing_2"/>'
    state = '<intvelocity name="swing_2" joint="swing_2" kp="300" actrange="-1 1"/>'
    robot = edited(servo, state)
    assert robot.model.na == 1
    assert prepare(scenario(), robot).model.na == 0


def test_servos_behind_a_filter_follow_at_once_and_are_told(edited, scenario):
    slow = 'joint="swing_2" timeconst="0.1"'
    robot = edited(
        'joint="swing_2"/>\n    <position class="lift"',
        slow + ('/>\n    <position class="lift"'),
    )
    assert robot.model.na == 1
    assert prepare(scenario(), robot).model.na == 0
    (told,) = changes(robot, scenario())
    assert "servos of joints 'swing_2' follow commands through a filter or" in told


def test_margins_of_feet_throw_nothing_up(edited, scenario):
    robot = edited(FOOT, FOOT.replace("/>", ' margin="0.01"/>'))
    assert sinks(prepare(scenario(), robot)) < 1e-3
    (told,) = changes(robot, scenario())
    assert "'foot_1', 'foot_2', 'foot_3', ... have a contact margin" in told


def test_friction_of_feet_that_gives_way_is_told(edited, scenario):
    robot = edited(FOOT, FOOT.replace("/>", ' friction="0.3" priority="3"/>'))
    _, told = changes(robot, scenario())
    assert "the friction of its feet, 0.3, gives way to friction = 1" in told
    assert len([*changes(robot, scenario(friction=0.3))]) == 1


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        ([START, START.replace("1 0 0 0 0", "1 0 0 0 0.6")], "'swing_1' starts at 0.6"),
        (['"-0.1 0.6" limited', '"0.05 0.6" limited'], "'lift_1' starts at 0 rad"),
    ],
    ids=["swing", "lift"],
)
def test_start_outside_a_joint_s_range_is_called_that(edit, said, edited):
    with pytest.raises(ModelError, match=f"joint {said}.*outside the range of it"):
        edited(*edit)


def test_borrowed_card_is_noticed_and_blamed_where_it_does_not_fit(tmp_path, capsys):
    for name in ("hexapod.xml", "scene.xml"):
        (tmp_path / name).write_text((FOLDER / name).read_text())
    path = (tmp_path / "hexapod.xml").rename(tmp_path / "mine.xml")
    assert cli.main(["robots", str(path)]) == 0
    assert "mine.xml has no card; that of the shipped robot 'hexapod'" in (
        capsys.readouterr().err
    )
    path.write_text(BODY.replace('"swing_1"', '"hip_1"'))
    with pytest.raises(ModelError, match="no robot card: .*'hexapod'.* does not fit"):
        load(str(path))


def test_soles_that_overlap_are_told(edited, scenario):
    robot = edited(FOOT, '<geom type="box" size="0.075 0.075 0.008"/>')
    assert any(
        "feet 'foot_1' and 'foot_3' overlap by 16.0 mm" in told
        for told in inspected(scenario(), robot)["lacks"]
    )


def test_marks_of_films_keep_their_colours_and_lie_on_the_floor(
    edited, tmp_path, scenario
):
    grey = '><geom rgba="0.5 0.1 0.1 1" group="4"/><light active="false"/>'
    dark = '<headlight active="0" ambient'
    low = '<geom name="floor" pos="0 0 -0.05"'
    edits = "<headlight ambient", dark, '<geom name="floor"', low
    robot = edited(DEFAULTS, DEFAULTS.replace(">", grey, 1), *edits)
    file, given = tmp_path / "hexapod.xml", scenario(bumps=0.004)
    model = prepare(given, load(str(file))).model
    walk = SimpleNamespace(
        model_file=file, model=model, reach=0.2, card=robot.card, scenario=given
    )
    assert floor_height(walk) == pytest.approx(-0.05)  # where the bumps' tops are
    line = np.array([[0.0, 0.0], [0.1, 0.0]])
    mark = Mark("path", ribbon(line, np.zeros(2, int), 0.01), palette.ACHIEVED.colour)
    shown = build_scene(walk, [mark], LOOKS["draft"])
    assert (model.vis.headlight.active, bool(shown.vis.headlight.active)) == (0, True)
    assert shown.light_active.all()
    geom = shown.geom(PREFIX + mark.pieces[0][0])
    assert geom.rgba == pytest.approx(palette.ACHIEVED.colour.rgba(1.0))
    assert geom.group == 0


def test_servos_that_are_delayed_follow_at_once_and_are_told(edited, scenario):
    """Those that are added take no delay from the defaults of the file either."""
    servo = '<position class="swing" name="swing_2" joint="swing_2"'
    robot = edited(servo, f'{servo} delay="0.3" nsample="400"')
    assert robot.model.actuator_delay.max() == 0.3
    assert not prepare(scenario(), robot).model.actuator_delay.any()
    (told,) = changes(robot, scenario())
    assert "servos of joints 'swing_2' follow commands through a filter or aft" in told
    assert "command_delay sets one" in told


def test_equations_behind_a_flag_that_is_not_in_force_are_switched_off(
    edited, scenario
):
    off = '<option><flag equality="disable"/></option>'
    tie = '<equality><joint name="tie" joint1="swing_1"/></equality>'
    robot = edited("<worldbody>\n", f"{off}<worldbody>\n", "<sensor>", f"{tie}<sensor>")
    assert not prepare(scenario(), robot).model.eq_active0.any()
    assert any("equations 'tie'" in line for line in changes(robot, scenario()))


TOLD = {
    "gravcomp": ('<body name="torso"', "bodies 'torso' have gravcomp"),
    "gravity": ("<worldbody>\n", "has a 'gravity' that leans"),
}


@pytest.mark.parametrize("what", TOLD)
def test_weight_that_is_not_as_usual_stays_and_is_told(what, edited, scenario):
    place, words = TOLD[what]
    edits = {
        "gravcomp": f'{place} gravcomp="0.5"',
        "gravity": f'<option gravity="0.5 0 -9.8"/>{place}',
    }
    robot = edited(place, edits[what])
    model = prepare(scenario(), robot).model
    assert model.body_gravcomp.any() == (what == "gravcomp")
    assert (model.opt.gravity[0] > 0) == (what == "gravity")
    assert words in next(changes(robot, scenario()))
