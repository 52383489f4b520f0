"""Contact and slip from sensors, against independent computations."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from sim.measure import (
    Readings,
    Sensors,
    bridge,
    count_bounces,
    decided,
    last_touched,
)
from sim.physics import Engine
from sim.world.channels import Channels
from sim.world.model import build, load


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


@pytest.mark.physics
def test_slip_speed_is_that_of_the_material_under_the_contact_point(hexapod, scenario):
    """Contact force, point and slip of every foot, again from the engine's contacts."""
    model = load(build(hexapod, scenario()))
    time = np.arange(600)[:, None] * model.opt.timestep
    swing = 0.15 * np.sin(4 * time) * np.array([1.0, -1.0])
    ctrl = Channels(hexapod, model).ctrl(swing, np.zeros_like(swing))
    record = Engine(model).advance(ctrl)
    found = Sensors(model, hexapod).read(record.sensordata)

    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    feet = {model.geom(f"foot_{leg}").id: i for i, leg in enumerate(hexapod.legs)}
    worst = 0.0
    for k, row in enumerate(ctrl):
        data.ctrl[:] = row
        mujoco.mj_forward(model, data)
        for c, contact in enumerate(data.contact):
            foot = feet[contact.geom2]
            wrench = np.zeros(6)
            mujoco.mj_contactForce(model, data, c, wrench)
            body = model.geom_bodyid[contact.geom2]
            jacobian = np.zeros((3, model.nv))
            mujoco.mj_jac(model, data, jacobian, None, contact.pos, body)
            speed = np.hypot(*(jacobian @ data.qvel)[:2])
            worst = max(
                worst,
                abs(found.force[k, foot] - wrench[0]),
                abs(found.speed[k, foot] - speed),
                *abs(found.point[k, foot] - contact.pos[:2]),
            )
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
