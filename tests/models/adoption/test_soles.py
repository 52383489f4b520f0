"""Feet of several geoms, as a draft finds them."""

import mujoco
import pytest

from models.adoption.draft import draft_card
from models.adoption.source import source_of
from models.checks import check_posture
from models.library import load


@pytest.mark.parametrize("apart", [0.0, 2e-4])
def test_what_is_as_low_as_a_foot_on_its_body_is_foot_as_well(tmp_path, apart):
    """As a shank of the foot's own radius, which ends where the foot is."""
    spec = load("hexapod").read()
    foot = spec.geom("foot_1")
    end = foot.pos + [0.0, 0.0, apart]
    shank = foot.parent.add_geom(
        name="shank", type=mujoco.mjtGeom.mjGEOM_CAPSULE, contype=1, mass=0.001,
        fromto=[*(end + [-0.04, 0.0, 0.05]), *end], size=[foot.size[0], 0, 0],
    )  # fmt: skip
    shank.conaffinity = foot.conaffinity
    spec.compile()
    (tmp_path / "mine.xml").write_text(spec.to_xml())
    drafted = draft_card(source_of(str(tmp_path / "mine.xml")))
    soles = [limb.soles for limb in drafted.limbs]
    assert {*soles[0]} == ({"shank", "foot_1"} if apart < 1e-4 else {"foot_1"})
    assert soles[1:] == [(f"foot_{number}",) for number in range(2, 7)]
    (tmp_path / "mine.toml").write_text(drafted.card)
    robot = load(str(tmp_path / "mine.xml"))
    assert robot.card.legs[1].foot == soles[0]
    check_posture(robot)


def test_a_robot_with_two_soles_a_leg_stays_as_it_stands(tmp_path):
    spec = load("hexapod").read()
    for number in range(1, 7):
        foot = spec.geom(f"foot_{number}")
        foot.parent.add_geom(
            name=f"heel_{number}", type=foot.type, size=foot.size, mass=0.001,
            pos=foot.pos + [0.0, 0.015, 0.0], contype=1, conaffinity=foot.conaffinity,
        )  # fmt: skip
    spec.compile()
    (tmp_path / "mine.xml").write_text(spec.to_xml())
    drafted = draft_card(source_of(str(tmp_path / "mine.xml")))
    assert {len(limb.soles) for limb in drafted.limbs} == {2}
    bent = [guess for guess in drafted.guesses if "knees were bent" in guess]
    assert not bent
