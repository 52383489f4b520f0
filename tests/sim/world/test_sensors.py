"""Sensors measure what they are made for, whatever a robot's file says of them."""

import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.library import load as load_robot
from sim.physics.engine import Engine
from sim.world.changes import changes
from sim.world.model import build, load
from sim.world.sensors import SELF_CONTACT, Touches

FOOT, MIDDLE = 'name="contact_foot_1"', 'name="center_of_mass"'
WORLD = "<worldbody>"
ODD = {
    "no sensors": (
        "<worldbody>",
        '<option><flag sensor="disable"/></option><worldbody>',
    ),
    "sleep": ("<worldbody>", '<option><flag sleep="enable"/></option><worldbody>'),
    "contacts of its own": (
        "<worldbody>",
        '<option o_friction="9 9 9 9 9"><flag override="enable"/></option><worldbody>',
    ),
    "a delay": (FOOT, f'{FOOT} delay="0.5" nsample="600"'),
    "an interval": (FOOT, f'{FOOT} interval="0.7" nsample="10"'),
    "a late centre of mass": (MIDDLE, f'{MIDDLE} delay="0.1" nsample="200"'),
    "a cut-off": (MIDDLE, f'{MIDDLE} cutoff="0.00001"'),
}


@pytest.fixture
def robot(tmp_path):
    """Write the hexapod with something replaced in its MJCF; the robot."""

    def write(old, new):
        text = (FOLDER / "hexapod.xml").read_text()
        assert text.count(old) == 1
        (tmp_path / "mine.xml").write_text(text.replace(old, new))
        for part in ("scene.xml", "hexapod.toml"):
            own = part.replace("hexapod", "mine")
            (tmp_path / own).write_text((FOLDER / part).read_text())
        return load_robot(str(tmp_path / "mine.xml"))

    return write


@pytest.mark.parametrize(("old", "new"), ODD.values(), ids=ODD)
def test_what_is_measured_does_not_depend_on_a_robots_own_sensors_and_flags(
    robot, hexapod, scenario, old, new
):
    odd, plain = (load(build(own, scenario())) for own in (robot(old, new), hexapod))
    assert odd.opt.enableflags == plain.opt.enableflags
    assert odd.opt.disableflags == plain.opt.disableflags
    for part in ("delay", "cutoff", "interval", "type", "intprm", "objid", "refid"):
        mine, usual = (getattr(model, f"sensor_{part}") for model in (odd, plain))
        for i in range(plain.nsensor):
            at = odd.sensor(plain.sensor(i).name).id
            assert np.array_equal(mine[at], usual[i])
    readings = [Engine(model).sense() for model in (odd, plain)]
    assert np.sort(readings[0]).tolist() == np.sort(readings[1]).tolist()


def test_a_files_own_contacts_of_feet_with_the_floor_give_way_to_those_of_the_scenario(
    robot, hexapod, scenario
):
    feet = ("foot_1", "foot_2", "foot_3", "foot_4")
    pairs = "".join(f'<pair geom1="{foot}" geom2="floor"/>' for foot in feet)
    legs = '<pair geom1="foot_5" geom2="foot_6"/>'
    own = robot(WORLD, f"<contact>{pairs}{legs}</contact>{WORLD}")
    asked = scenario(friction=0.4, floor_stiffness=1000.0)
    found, plain = (load(build(each, asked)) for each in (own, hexapod))
    ends = [found.geom(int(g)).name for g in (*found.pair_geom1, *found.pair_geom2)]
    assert sorted(ends) == ["foot_5", "foot_6"]
    for name in ("floor", *feet):
        for part in ("friction", "solref", "solimp", "priority"):
            settled = (getattr(model.geom(name), part) for model in (found, plain))
            assert np.array_equal(*settled)
    (said,) = changes(own, asked)
    assert said.startswith("<contact> has pairs of 'floor', 'foot_1', 'foot_2', ...")


def test_only_the_sensor_of_the_whole_robot_counts_what_it_touches_of_itself(
    hexapod, scenario
):
    spec = mujoco.MjSpec.from_string(build(hexapod, scenario()).text)
    for name in ("self_contacts", "my_self_contact"):  # which reads 1 after a second
        spec.add_sensor(name=name, type=mujoco.mjtSensor.mjSENS_CLOCK)
    model = spec.compile()
    touches = Touches(model, SELF_CONTACT)
    readings = np.zeros((3, model.nsensordata))
    for name in ("self_contacts", "my_self_contact"):
        readings[1:, model.sensor(name).adr[0]] = 1.0
    touches.read(readings)
    assert touches.count == 0
    readings[2, model.sensor(SELF_CONTACT).adr[0]] = 1.0
    touches.read(readings)
    assert touches.count == 1
