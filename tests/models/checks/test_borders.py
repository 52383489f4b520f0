"""What is just allowed of a robot's posture and parts, and what just is not."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models import checks
from models.checks import (
    _badly_standing,
    _cannot_lift,
    _cannot_swing,
    check_places,
)
from models.description.actuators import actuator_of, actuators_of, is_position_servo
from models.description.compiled import joints_above, levelled, named, root_body
from models.errors import ModelError

STEEP = np.deg2rad(20)  # largest angle between a swing axis and the vertical
UPRIGHT = np.deg2rad(3)  # smaller tilts change lengths by less than 0.2 %
BEYOND = 1e-6  # [rad] by which a start may be out of range
CLEAR = 2e-4  # [m]; least rise of a lifted foot, more than soft feet sink in
FARTHEST = 1e6  # [m] from the origin or frame; beyond, numbers lose millimetres
UNEVEN_FEET = 0.02  # of the stance's size; tolerance of the feet's heights

FEET = np.array([[0.1, 0.2], [0.1, -0.2], [-0.15, 0.0]])  # of a stance of 0.4 m


def standing(tilt=0.0, heights=(0, 0, 0), center=0.05, angle=0.2, span=(-0.3, 0.5)):
    """A robot of three legs as it stands, its root turned about an oblique axis."""
    half = np.sin(tilt / 2) * np.array([0.6, 0.8, 0.0])
    robot = SimpleNamespace(
        root_address_in=lambda model: 2, model=None, root="trunk", legs=(4, 5, 6),
        start_qpos=np.array([9, 9, 0, 0, 0, np.cos(tilt / 2), *half, 9.0]),
        card=SimpleNamespace(joints=("a",)), span=lambda joint: span,
        standing_angle=lambda joint: angle,
    )  # fmt: skip
    stance = SimpleNamespace(feet=FEET, height=np.array(heights, dtype=float))
    return SimpleNamespace(
        robot=robot, standing=stance, center_of_mass=np.array([0, 0, center])
    )


def problems(check, kinematics):
    return {name: facts for name, facts in check(kinematics)}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, {}),
        ({"tilt": 0.999 * UPRIGHT}, {}),
        ({"tilt": 1.001 * UPRIGHT}, {"tilted": {"down": "tilted", "tilt": 3.003}}),
        ({"tilt": np.deg2rad(99.9)}, {"tilted": {"down": "tilted", "tilt": 99.9}}),
        ({"tilt": np.deg2rad(101)}, {"tilted": {"down": "upside down", "tilt": 101}}),
        ({"tilt": np.pi}, {"tilted": {"down": "upside down", "tilt": 180.0}}),
        ({"angle": 0.5 + 0.9 * BEYOND}, {}),
        ({"angle": 0.5 + 1.1 * BEYOND}, {"outside": {"low": -0.3, "high": 0.5}}),
        ({"angle": -0.3 - 0.9 * BEYOND}, {}),
        ({"angle": -0.3 - 1.1 * BEYOND}, {"outside": {"low": -0.3, "joint": "a"}}),
        ({"heights": (0, 0.99 * UNEVEN_FEET * 0.4, 0)}, {}),
        (
            {"heights": (0.001, 0.011, 0.001)},
            {"uneven": {"apart": 10.0, "high": 5, "low": 4}},
        ),
        ({"heights": (0.06,) * 3, "center": 0.061}, {}),
        (
            {"heights": (0.06,) * 3, "center": 0.05},
            {"on_its_back": {"leg": 4, "above": 10.0}},
        ),
        ({"heights": (0.05,) * 3}, {"on_its_back": {"above": 0.0}}),
    ],
)
def test_a_robot_stands_upright_within_its_ranges_on_even_feet(changes, expected):
    found = problems(_badly_standing, standing(**changes))
    assert found.keys() == expected.keys()
    for name, facts in expected.items():
        for fact, value in facts.items():
            same = value if isinstance(value, str) else pytest.approx(value, abs=1e-3)
            assert found[name][fact] == same


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("share", "leans"), [(0.999, False), (1.001, True)])
def test_swing_axes_are_nearly_vertical_either_way(side, share, leans):
    axis = side * np.array([np.sin(share * STEEP), 0.0, np.cos(share * STEEP)])
    robot = SimpleNamespace(legs=(7,), swing_joints=("s",), swing_range={})
    kinematics = SimpleNamespace(robot=robot, hinge=lambda joint: (axis, None))
    found = problems(_cannot_swing, kinematics)
    assert (found != {}) == leans
    if leans:
        assert found["leaning"]["lean"] == pytest.approx(20.02)
        assert (found["leaning"]["leg"], found["leaning"]["joint"]) == (7, "s")


@pytest.mark.parametrize(
    ("span", "end"),
    [((-1e-9, 1e-9), False), ((0.0, 1.0), True), ((-1.0, 0.0), True), ((0.1, 1), True)],
)
def test_groups_swing_to_both_sides(span, end):
    robot = SimpleNamespace(legs=(), swing_joints=(), swing_range={"1": span})
    found = problems(_cannot_swing, SimpleNamespace(robot=robot))
    expected = {"at_end": {"group": "1", "low": span[0], "high": span[1]}}
    assert found == (expected if end else {})


@pytest.mark.parametrize(
    ("rise", "other", "wanted", "expected"),
    [
        (CLEAR, 1.0, 0.3, {}),
        (0.99 * CLEAR, 0.99 * CLEAR, 0.3, {"stays"}),
        (0.99 * CLEAR, CLEAR, 0.3, {"stays"}),
        (0.99 * CLEAR, 1.01 * CLEAR, 0.3, {"lowers", "stays"}),
        (-0.02, 0.02, 0.3, {"lowers", "stays"}),
        (0.02, 0.02, 0.5 + 0.9e-9, {}),
        (0.02, 0.02, 0.5 + 1.1e-9, {"too_far"}),
    ],
)
def test_feet_are_lifted_clear_of_the_floor_within_their_range(
    rise, other, wanted, expected
):
    leg = SimpleNamespace(lift="l", raise_sign=-1)
    card = SimpleNamespace(lift_angle=wanted, legs={3: leg})

    def rises(angles):
        assert angles.tolist() == [wanted, -wanted]
        return np.array([[rise], [other]])

    kinematics = SimpleNamespace(
        robot=SimpleNamespace(card=card, legs=(3,)),
        rise=rises, farthest_lift=0.5, highest=0.07,
    )  # fmt: skip
    found = problems(_cannot_lift, kinematics)
    assert set(found) == set(expected)
    if "lowers" in expected:
        assert found["lowers"] == {"leg": 3, "joint": "l", "sign": -1, "other": 1}
    if "stays" in expected:
        assert found["stays"]["rise"] == pytest.approx(1e3 * rise)
    if "too_far" in expected:
        assert found["too_far"] == {"wanted": wanted, "most": 0.5, "highest": 0.07}


def test_the_gravest_problem_is_told_first(monkeypatch):
    for name in ("_badly_standing", "_cannot_swing", "_cannot_lift"):
        monkeypatch.setattr(checks, name, lambda kinematics, name=name: [(name, {})])
    monkeypatch.setattr(checks, "Kinematics", lambda robot: None)
    told = {"_badly_standing": "it lies"}
    monkeypatch.setattr(checks, "_wrong", lambda key, _: ModelError(told[key]))
    with pytest.raises(ModelError, match="^it lies$"):
        checks.check_posture(SimpleNamespace(path="here"))


@pytest.mark.parametrize(("share", "far"), [(1.0, False), (1.001, True)])
def test_parts_are_within_a_million_metres_of_their_frames(share, far):
    away = share * FARTHEST
    for kind in ("body", "geom"):
        places = dict.fromkeys(("body_pos", "geom_pos"), np.zeros((3, 3)))
        places[f"{kind}_pos"] = np.array([[0, 0, 0], [0, -away, 1], [5.0, 0, 0]])
        part = lambda number: SimpleNamespace(name=f"part {number}")  # noqa: E731
        model = SimpleNamespace(**places, body=part, geom=part)
        if far:
            told = rf"{kind} 'part 1' is 1e\+06 m away from its frame: here; correct"
            with pytest.raises(ModelError, match=told):
                check_places(model, "here")
        else:
            check_places(model, "here")


ROBOT = """<mujoco><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body pos="1 2 3"><freejoint/><geom size="0.1"/><geom name="robot_geom_1" size="0.1"/>
    <body name="thigh"><joint name="h" axis="0 0 1"/><joint name="k" axis="0 1 0"/>
      <geom size="0.1"/><body name="shin"><joint name="a" axis="0 1 0"/>
        <geom size="0.1"/></body></body></body></worldbody>
  <actuator><position joint="h" kp="9"/><motor joint="k"/><position joint="h" kp="2"/>
    <general jointinparent="a"/></actuator></mujoco>"""


def test_what_has_no_name_is_named_after_its_body_and_number():
    spec = mujoco.MjSpec.from_string(ROBOT)
    named(spec)
    assert [body.name for body in spec.bodies] == [
        "world",
        "world_body_1",
        "thigh",
        "shin",
    ]
    assert [geom.name for geom in spec.geoms] == [
        "world_geom_0", "world_body_1_geom_1", "robot_geom_1", "thigh_geom_3",
        "shin_geom_4",
    ]  # fmt: skip
    assert [a.name for a in spec.actuators] == ["h", "k", "h_", "a"]
    spec.compile()


def test_actuators_and_joints_are_found_by_what_they_drive_and_carry():
    model = mujoco.MjModel.from_xml_string(ROBOT)
    assert [actuators_of(model, joint) for joint in "hka"] == [[0, 2], [1], [3]]
    assert actuator_of(model, "h") == 0
    shin = model.body("shin").id
    names = [model.joint(j).name for j in joints_above(model, shin)]
    assert names == ["a", "h", "k"]
    root = root_body(model, "here")
    assert joints_above(model, root) == []
    level = levelled(model, root, np.arange(1.0, 11.0))
    assert level.tolist() == [0, 0, 3, 1, 0, 0, 0, 8, 9, 10]
    bare = mujoco.MjModel.from_xml_string(
        ROBOT.partition("<actuator>")[0] + "</mujoco>"
    )
    with pytest.raises(
        ModelError, match="no actuator drives joint 'k': give it a servo"
    ):
        actuator_of(bare, "k")


@pytest.mark.parametrize(
    ("gain", "bias", "is_one"),
    [
        (5.0, -5.0, True), (5.0, -5.0 * (1 + 0.9e-5), True),
        (5.0, -5.0 * (1 - 0.9e-5), True), (5.0, -5.0 * (1 + 1.1e-5), False),
        (5.0, 5.0, False), (0.0, 0.0, False), (-5.0, 5.0, False),
    ],
)  # fmt: skip
def test_a_position_servo_pulls_by_what_is_left_to_its_command(gain, bias, is_one):
    law = np.array([gain, 0, 0]), np.array([0, bias, 0])
    affine, none = mujoco.mjtBias.mjBIAS_AFFINE, mujoco.mjtBias.mjBIAS_NONE
    assert is_position_servo(*law, affine) == is_one
    assert not is_position_servo(*law, none)  # a motor, whatever its numbers
    sloped = np.array([gain, 0.1, 0])
    assert not is_position_servo(sloped, law[1], affine)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "^0 free joints: here; a walking robot has exactly one"),
        ('<body name="x"><freejoint/><geom size="1"/></body>' * 2,
         "^2 free joints, of bodies 'x', 'y': here"),
    ],
)  # fmt: skip
def test_a_walking_robot_has_one_free_joint(text, told):
    text = text.replace('"x"', '"y"', 2).replace('"y"', '"x"', 1)
    whole = f"<mujoco><worldbody>{text}</worldbody></mujoco>"
    with pytest.raises(ModelError, match=told):
        root_body(mujoco.MjModel.from_xml_string(whole), "here")
