"""What a walk adds to a robot's file is as asked, whatever the file says of its own."""

from math import degrees

import numpy as np
import pytest

from models.description import compile_model
from models.library import load
from sim.preparation.setup import prepare
from sim.scenarios.obstacles import decode
from sim.world.changes import changes
from sim.world.imperfections import add_imperfections

DEFAULTS = '<default class="robot">'
OWN = """
  <joint damping="0.5" stiffness="2" springref="0.2" frictionloss="0.3" margin="0.01"
    armature="0.01" actuatorfrcrange="-1 1" solreffriction="0.1 1"/>
  <geom margin="0.0002" gap="0.0001" solref="0.1 1" condim="1" friction="0.3"
    priority="3"/>
  <mesh scale="0.001 0.001 0.001"/>
  <general delay="0.01" nsample="20" forcerange="-9 9"/>
"""
RANGES = (-0.45, 0.45), (-0.1, 0.6)  # of the hexapod's swings and lifts [rad]
ADDED = {
    "payload": (0.5, 0.0, 0.0, 0.02),
    "backlash": 0.02,
    "dead_band": 0.01,
    "obstacles": decode(
        [
            {"kind": "box", "center": [0.7, 0.3], "size": [0.1, 0.2]},
            {"kind": "polygon", "points": [[0.6, -0.2], [0.7, -0.2], [0.65, 0.2]]},
        ]
    ),
}


def added_parts(model):
    """All numbers of what a walk adds, by the name of the part."""
    joints = [model.joint(f"backlash_swing_{leg}") for leg in (1, 6)]
    geoms = [model.geom(f"obstacle_{i}_1") for i in (1, 2)]
    springs = [model.actuator("band_lift_2")]
    skipped = {"id", "bodyid", "weldid", "dofadr", "qposadr", "dataid", "trnid"}
    return {
        (part.name, name): np.asarray(getattr(part, name)).tolist()
        for part in (*joints, *geoms, *springs)
        for name in dir(part)
        if not name.startswith("_") and name not in skipped
    }


def test_what_is_added_takes_nothing_from_a_file_s_defaults(edited, hexapod, scenario):
    usual = added_parts(prepare(scenario(**ADDED), hexapod).model)
    own = prepare(scenario(**ADDED), edited(DEFAULTS, OWN + DEFAULTS)).model
    assert own.joint("swing_1").frictionloss == 0.3  # the file's own parts keep theirs
    assert added_parts(own) == usual
    assert usual["obstacle_2_1", "rbound"][0] > 0.2
    assert not own.actuator_delay[own.actuator("band_lift_2").id]
    assert own.geom("floor").condim == 3  # feet would slide on it as on ice


def in_degrees():
    radians = [f'range="{low} {high}" limited' for low, high in RANGES]
    turned = (f'range="{degrees(a)!r} {degrees(b)!r}" limited' for a, b in RANGES)
    edits = [text for pair in zip(radians, turned, strict=True) for text in pair]
    return ['<compiler angle="radian"/>', "<compiler/>", *edits]


FREE, END = '<freejoint name="root"/>', "</body>\n  </worldbody>"
PLANE = '<geom name="floor" type="plane"'
OTHER_WORDS = {
    "degrees": in_degrees(),
    "a frame": [FREE, f'{FREE}<frame euler="0 0 0">', END, f"</frame>{END}"],
    "a plane with a place": [PLANE, f'{PLANE} pos="1 2 0" euler="0 0 1"'],
    "defaults of meshes": [DEFAULTS, f'<mesh scale="0.001 1 1"/>{DEFAULTS}'],
    "the floor of a body": [
        PLANE,
        f'<body name="ground" pos="1 2 0">{PLANE}',
        'solimp="0.1 0.1 0.001"/>',
        'solimp="0.1 0.1 0.001"/></body>',
    ],
}


@pytest.mark.parametrize("words", OTHER_WORDS)
def test_a_robot_written_in_other_words_is_the_same_in_its_world(
    words, edited, hexapod, scenario
):
    given = scenario(bumps=0.003, **ADDED)
    usual = prepare(given, hexapod).model
    model = prepare(given, edited(*OTHER_WORDS[words])).model
    empty = int(words == "the floor of a body")  # body, which is left there
    assert model.nbody == usual.nbody + empty
    names = [n for n in dir(usual) if n.startswith(("geom_", "jnt_", "dof_", "actuat"))]
    for name in names:
        was, now = getattr(usual, name), getattr(model, name)
        if (
            isinstance(was, np.ndarray)
            and "bodyid" not in name
            and "plugin" not in name
        ):
            assert np.array_equal(was, now), name
    assert np.array_equal(model.body_mass[empty:], usual.body_mass)
    assert np.array_equal(model.key_qpos, usual.key_qpos)


@pytest.mark.parametrize("mass_of", ["bodies", "geoms", "a group", "the whole"])
def test_a_payload_weighs_what_is_asked_whatever_a_file_counts_as_mass(
    mass_of, scenario
):
    robot = load("hexapod")
    spec = robot.read()
    weighed = spec.compile().body_mass.sum()
    if mass_of == "bodies":
        for body in spec.bodies[1:]:
            body.inertia, body.ipos, body.explicitinertial = [0.01] * 3, [0, 0, 0], True
            body.mass = weighed / len(spec.bodies[1:])
        spec.compiler.inertiafromgeom = 0  # false
    elif mass_of == "geoms":
        spec.compiler.inertiafromgeom = 1  # true
    elif mass_of == "a group":
        spec.compiler.inertiagrouprange = [3, 4]
        for geom in spec.geoms:
            geom.group = 3
    else:
        spec.compiler.settotalmass = weighed = 3.5
    given = scenario(payload=(0.5, 0, 0, 0))
    add_imperfections(spec, robot, "floor", given)
    model = compile_model(spec, "hexapod.xml")
    assert model.body("payload").mass == pytest.approx(0.5, rel=1e-12)
    assert model.body_mass.sum() == pytest.approx(weighed + 0.5, rel=1e-12)
    sphere = 0.4 * 0.5 * 0.005**2  # of the radius by which it is seen
    assert model.body("payload").inertia == pytest.approx(sphere, rel=1e-12)


@pytest.mark.parametrize("way", ["body", "frame", "turned"])
def test_a_floor_in_a_body_or_a_frame_is_the_floor_of_the_world(way, edited, scenario):
    plane = '<geom name="floor" type="plane" size="0 0 0.05" priority="1"'
    place = 'pos="1 2 -0.05" euler="0 0 1"'
    ground = {
        "body": f'<body name="ground" {place}>{plane}/></body>',
        "frame": f"<frame {place}>{plane}/></frame>",
        "turned": f"{plane} {place}/>",
    }[way]
    pair = '<pair geom1="floor" geom2="foot_1" friction="0.05 0.05 0.1 0.1 0.1"/>'
    shipped = '<geom name="floor" type="plane" size="0 0 0.05" material="grid" '
    shipped += 'priority="1" solref="-100000 -100" solimp="0.1 0.1 0.001"/>'
    contact = f"<contact>{pair}</contact><actuator>"
    robot = edited(shipped, ground, "<actuator>", contact)
    setup = prepare(scenario(bumps=0.003), robot)
    model, floor = setup.model, setup.model.geom("floor")
    assert (int(floor.bodyid[0]), model.npair) == (0, 0)
    assert floor.pos == pytest.approx([0.005, 0.005, -0.053])  # the path's middle
    assert floor.quat.tolist() == [1, 0, 0, 0]
    assert any("'floor', 'foot_1'" in line for line in changes(robot, scenario()))


@pytest.mark.parametrize("own", ["damping", "frictionloss", "stiffness", "armature"])
def test_what_a_default_gives_to_the_body_s_own_joint_is_told(own, edited, scenario):
    free = '<joint type="free" name="root"/>'
    default = f'<joint {own}="0.01"/>{DEFAULTS}'
    robot = edited('<freejoint name="root"/>', free, DEFAULTS, default)
    (line,) = [line for line in changes(robot, scenario()) if "'torso'" in line]
    assert line.startswith("the joint of the body 'torso' has damping, friction, spr")


def test_states_of_other_drives_start_as_the_keyframe_says(edited, scenario):
    """Those of legs, which the keyframe counts as well, are gone."""
    head = '<body><joint name="neck" damping="1"/><geom size="0.01" mass="0.1"/></body>'
    muscle = '<general name="muscle" joint="neck" dyntype="filter" dynprm="1"/>'
    servo = '<position class="swing" name="swing_2" joint="swing_2"'
    robot = edited(
        f"{servo}/>",
        f'{servo} timeconst="0.1"/>{muscle}',
        'name="start" qpos="0 0 0.06 1 0 0 0',
        'name="start" act="0.2 0.6" qpos="0 0 0.06 1 0 0 0 0',
        '<body name="leg_1"',
        f'{head}<body name="leg_1"',
    )
    assert prepare(scenario(), robot).model.key_act == [[0.6]]
