"""Contact and slip from sensors, against independent computations."""

import re
import shutil
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models.description.robot import FOLDER
from models.library import load as load_robot
from sim.physics.engine import Engine
from sim.physics.measure import (
    Readings,
    Sensors,
    bridge,
    count_bounces,
    decided,
    last_touched,
)
from sim.world.model import build, load
from sim.world.servos import Channels


def test_less_than_one_per_cent_of_the_weight_is_no_contact(hexapod, scenario):
    sensors = Sensors(load(build(hexapod, scenario())), hexapod)
    force = sensors.weight * np.array([[0.0099, 0.0101]])
    still = Readings(force, force * 0, np.zeros((1, 2, 2)), np.zeros((1, 3)))
    assert sensors.loaded(still).tolist() == [[False, True]]


def test_the_weight_is_the_robots_whatever_else_is_in_the_world(hexapod, scenario):
    world = build(hexapod, scenario())
    alone = Sensors(load(world), hexapod).weight
    rock = '<worldbody><body><geom size="1" mass="50"/></body>'
    more = replace(world, text=world.text.replace("<worldbody>", rock))
    assert Sensors(load(more), hexapod).weight == alone


FLAGS = np.array([1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0], bool)[:, None]


def test_short_interruptions_are_bridged_and_counted():
    contact = bridge(FLAGS, shortest=3)
    assert contact[:, 0].astype(int).tolist() == [1, 1, 1, 1, 1, 0, 0, 0, 1, 1, 0]
    assert count_bounces(FLAGS, contact) == 1


def test_a_contact_is_decided_when_no_later_step_can_make_a_bounce_of_its_end():
    decisions = [decided(FLAGS[:count], shortest=3) for count in range(1, 12)]
    assert decisions == [1, 2, 2, 2, 5, 5, 5, 8, 9, 10, 10]


def test_a_foot_in_the_air_keeps_the_point_it_last_touched():
    points = np.array([[0, 0], [1.0, 2.0], [0, 0], [3.0, 4.0]])[:, None]
    touching = np.array([0, 1, 0, 1], bool)[:, None]
    before = np.array([[[7.0, 8.0]]])
    kept = last_touched(points, touching, before)
    assert kept[:, 0].tolist() == [[7, 8], [1, 2], [1, 2], [3, 4]]


@pytest.fixture(params=["one geom", "two geoms"])
def walker(request, hexapod, tmp_path):
    """The hexapod, and one whose feet are pairs of spheres side by side."""
    if request.param == "one geom":
        return hexapod
    shutil.copy(FOLDER / "scene.xml", tmp_path)
    body, card = ((FOLDER / f"hexapod.{kind}").read_text() for kind in ("xml", "toml"))
    foot = r'(<geom class="foot" pos="\S+) 0 (.* name=")foot(_\d" mass="\S+"/>)'
    both = r"\1 0.012 \2foot\3\1 -0.012 \2heel\3"
    (tmp_path / "pairs.xml").write_text(re.sub(foot, both, body))
    pairs = re.sub(r'"foot_(\d)"', r'"foot_\1", "heel_\1"', card)
    (tmp_path / "pairs.toml").write_text(pairs)
    return load_robot(str(tmp_path / "pairs.xml"))


@pytest.mark.physics
def test_force_point_and_slip_of_a_foot_are_those_of_all_its_contacts(walker, scenario):
    """From the engine's own contacts: forces summed, the rest weighted by them."""
    model = load(build(walker, scenario()))
    time = np.arange(600)[:, None] * model.opt.timestep
    swing = 0.15 * np.sin(4 * time) * np.array([1.0, -1.0])
    ctrl = Channels(walker, model).ctrl(walker.targets(swing, np.zeros_like(swing)))
    record = Engine(model).advance(ctrl)
    found = Sensors(model, walker).read(record.sensordata)

    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    feet = {
        model.geom(geom).id: i
        for i, leg in enumerate(walker.legs)
        for geom in walker.card.legs[leg].foot
    }
    worst = 0.0
    for k, row in enumerate(ctrl):
        data.ctrl[:] = row
        mujoco.mj_forward(model, data)
        sums = np.zeros((len(walker.legs), 4))  # force, and speed and point times it
        for c, contact in enumerate(data.contact):
            wrench, jacobian = np.zeros(6), np.zeros((3, model.nv))
            mujoco.mj_contactForce(model, data, c, wrench)
            body = model.geom_bodyid[contact.geom2]
            mujoco.mj_jac(model, data, jacobian, None, contact.pos, body)
            speed = np.hypot(*(jacobian @ data.qvel)[:2])
            sums[feet[contact.geom2]] += wrench[0] * np.array(
                [1.0, speed, *contact.pos[:2]]
            )
        force = sums[:, :1]
        means = sums[:, 1:] / np.where(force > 0, force, 1.0)
        read = np.column_stack([found.force[k], found.speed[k], found.point[k]])
        worst = max(worst, np.abs(read - np.hstack([force, means])).max())
        mujoco.mj_step(model, data)
    # the two loops differ in warm starts: the solver's tolerance on forces
    assert worst < 1e-4


@pytest.mark.physics
def test_normal_forces_of_a_standing_robot_carry_its_weight(hexapod, scenario):
    model = load(build(hexapod, scenario()))
    record = Engine(model).advance(np.zeros((1200, model.nu)))
    sensors = Sensors(model, hexapod)
    found = sensors.read(record.sensordata[-1:])
    # still settling by micrometres after 0.6 s
    assert found.force.sum() == pytest.approx(sensors.weight, rel=1e-3)
