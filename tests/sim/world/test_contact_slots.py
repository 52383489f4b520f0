"""Sensors have room for all contacts of a foot that the engine finds."""

import mujoco
import numpy as np
import pytest

from sim.world.sensors import _FORCE, _FOUND, _PLACE, _SLOTS, _SPEED, CONTACT_FIELDS

LYING = """<mujoco><worldbody><geom type="plane" size="1 1 1"/>
<body pos="0 0 0.0099"><freejoint/><geom type="{kind}" size="0.01 0.03" euler="0 90 0"/>
</body></worldbody></mujoco>"""
KINDS = {
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_foot_has_as_many_slots_as_it_has_contacts_with_a_plane(kind):
    model = mujoco.MjModel.from_xml_string(LYING.format(kind=kind))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert _SLOTS[KINDS[kind]] == data.ncon


def test_a_contact_tells_whether_it_is_its_force_its_place_and_its_speed():
    sizes = {_FOUND: 1, _FORCE: 3, _PLACE: 3, _SPEED: 3}
    assert len(sizes) == 4
    assert sum(sizes.values()) == CONTACT_FIELDS
    assert all(np.log2(flag) % 1 == 0 for flag in sizes)
