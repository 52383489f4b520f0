"""Which servos are soft, which motors are undamped, and how fine floors are."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.errors import ModelError
from sim.scenarios.body_path import line
from sim.world import floor, motors
from sim.world.servos import ServoSettings

PLAIN = ServoSettings(
    name="ideal", stiffness=None, damping=None, rate=0.0, resolution=0.0,
    feed_forward=None,
)  # fmt: skip


@pytest.mark.parametrize(("stiffness", "leads"), [(299.0, True), (300.0, False)])
def test_commands_make_up_for_loads_on_servos_below_300_newton_metres_a_radian(
    stiffness, leads
):
    assert PLAIN.feeds_forward(stiffness) == leads


@pytest.mark.parametrize(
    ("ratio", "rotor", "undamped"),
    [(0.49, True, True), (0.51, True, False), (0.9e-3, False, True),
     (1.1e-3, False, False)],
)  # fmt: skip
def test_servos_swing_for_long_below_half_of_critical_damping_with_a_new_rotor(
    ratio, rotor, undamped, monkeypatch
):
    """And one without a new rotor only if it is not damped at all."""
    stiffness, inertia = 4.0, 0.01
    model = SimpleNamespace(
        joint=lambda name: SimpleNamespace(dofadr=[0]),
        dof_M0=np.array([0.0 if rotor else inertia]),
        dof_damping=np.zeros(1),
        actuator_damping=np.zeros(1),
        actuator_gear=np.ones((1, 6)),
        actuator_gainprm=np.array([[stiffness]]),
        actuator_biasprm=np.array([[0, 0, -2 * ratio * np.sqrt(stiffness * inertia)]]),
    )
    robot = SimpleNamespace(model=model, card=SimpleNamespace(joints=["hip"]))
    monkeypatch.setattr(motors, "position_servos_of", lambda *_: [0])
    added = {"hip": inertia} if rotor else {}
    monkeypatch.setattr(motors, "added_rotors", lambda *_: added)
    assert motors.undamped_joints(robot, PLAIN) == (("hip",) if undamped else ())


@pytest.mark.parametrize(("far", "cells"), [(0.5, 150), (2.0, 300), (50.0, 400)])
def test_bumps_lie_a_centimetre_apart_but_are_400_a_side_at_most(far, cells):
    """On a floor of half a metre around the path, five centimetres thick."""
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1] * 3
    )
    scenario = SimpleNamespace(path=line([far, 0.0, 0.0]), draw=1, bumps=0.01)
    plane = SimpleNamespace(name="floor", height=0.0)
    floor.add_bumps(spec, plane, scenario)
    (field,) = spec.hfields
    assert (field.ncol, field.nrow) == (cells, 100)
    assert field.size == pytest.approx([far / 2 + 0.5, 0.5, 0.01, 0.05])


@pytest.mark.parametrize(("degrees", "wall"), [(44.9, False), (45.1, True)])
def test_planes_steeper_than_45_degrees_are_walls(degrees, wall):
    plane = SimpleNamespace(name="ramp", out_of_reach=[], tilt=np.deg2rad(degrees))
    robot = SimpleNamespace(card=SimpleNamespace(feet=["a", "b"]), path="x.xml")
    if wall:
        floor._refuse_half_a_floor(plane, robot)
    else:
        with pytest.raises(ModelError, match="44.9|45"):
            floor._refuse_half_a_floor(plane, robot)
