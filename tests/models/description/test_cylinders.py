"""Cylinders that stand upright, which lean a little before the engine sees them."""

import mujoco
import numpy as np
import pytest

from models.description.compiled import LEAN, lean_cylinders

ORIENTATIONS = {
    "none": "",
    "in degrees": 'euler="7 20 30.123"',
    "about an axis": 'axisangle="0 0 1 33"',
    "by two axes": 'xyaxes="0 1 0 -1 0 0"',
    "by its own axis": 'zaxis="0 1 3"',
    "a quaternion": 'quat=".3 .1 .2 .9"',
    "from end to end": 'fromto="0 0 0 0 0 .3"',
    "from end to end, aslant": 'fromto="0 0 0 .1 .2 .3"',
}
MODEL = """
<mujoco><compiler eulerseq="ZYX"/>
 <default><geom type="cylinder" size=".1 .1"/></default>
 <worldbody><geom type="plane" size="1 1 1" conaffinity="2"/>
  <body pos="0 0 .08"><freejoint/><frame {frame}><geom {how}/></frame></body>
 </worldbody></mujoco>
"""


def axis_and_place(spec):
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data.geom_xmat[1].reshape(3, 3)[:, 2], data.geom_xpos[1]


@pytest.mark.parametrize("frame", ["", 'euler="10 0 0"'])
@pytest.mark.parametrize("how", ORIENTATIONS.values(), ids=ORIENTATIONS)
def test_a_cylinder_leans_however_it_is_oriented(frame, how):
    text = MODEL.format(how=how, frame=frame)
    before, after = mujoco.MjSpec.from_string(text), mujoco.MjSpec.from_string(text)
    lean_cylinders(after)
    (axis, place), (turned, moved) = map(axis_and_place, (before, after))
    # frames of geoms that are nearly that of their body are rounded to it, 2e-6
    assert np.linalg.norm(turned - axis) == pytest.approx(LEAN, rel=0.5)
    assert np.linalg.norm(moved - place) <= LEAN  # times half of a length below 1 m


def test_a_cylinder_of_an_attached_model_has_the_units_of_its_own_file():
    text = MODEL.format(how='axisangle="1 0 0 1.5"', frame="")
    turned = []
    for lean in (lambda spec: None, lean_cylinders):
        radians = text.replace("eulerseq", 'angle="radian" eulerseq')
        child = mujoco.MjSpec.from_string(radians)
        main = mujoco.MjSpec.from_string("<mujoco><worldbody/></mujoco>")
        main.worldbody.add_frame().attach_body(child.bodies[1], "leg_", "")
        lean(main)
        data = mujoco.MjData(model := main.compile())
        mujoco.mj_forward(model, data)
        turned.append(data.geom_xmat[-1])
    assert np.abs(np.subtract(*turned)).max() < 2 * LEAN


def test_a_cylinder_that_leans_meets_no_floor_below_it():
    """In a pose in which the engine finds the rim of an upright one in the floor."""
    rounded = [0.9999999999999953, 3.2941447427957083e-18, 1.987228746488959e-18]
    text = MODEL.format(how='size=".1 .015"', frame="").replace('conaffinity="2"', "")
    depths = []
    for lean in (lambda spec: None, lean_cylinders):
        spec = mujoco.MjSpec.from_string(text)
        lean(spec)
        model = spec.compile()
        data = mujoco.MjData(model)
        data.qpos[3:7] = [*rounded, 9.374921944087831e-08]
        mujoco.mj_forward(model, data)
        depths.append([contact.dist for contact in data.contact])
    assert min(depths[0]) < -0.03  # [m], of a body 65 mm above the floor
    assert depths[1] == []
