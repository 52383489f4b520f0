"""The outline of a body in films is that of all that is fixed to it."""

import mujoco
import numpy as np
import pytest

from models.description import fixed_to
from sim.pictures.ghost import body_corners

BOX = '<geom name="box" type="box" size="0.1 0.05 0.02" rgba="1 1 1 {alpha}"/>'
TURNED = 'pos="0.01 0 0.02" euler="0 0 90"'
LEGS = "".join(
    f'<body pos="{x} {y} 0"><joint/><geom size="0.01" mass="1"/></body>'
    for x, y in ((0.1, 0.1), (0.1, -0.1), (-0.1, 0.0))
)


def corners_of(torso):
    body = f'<body name="torso" pos="3 2 1" euler="0 0 30"><freejoint/>{torso}</body>'
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody><geom size='1'/>{body}</worldbody></mujoco>"
    )
    root = model.body("torso").id
    return body_corners(model, root), [
        model.geom(n).name for n in fixed_to(model, root)
    ]


@pytest.mark.parametrize("turned", ["", TURNED])
def test_a_trunk_that_is_fixed_to_the_body_is_the_body(turned):
    seen = BOX.format(alpha=1)
    alone, _ = corners_of(seen.replace("/>", f" {turned}/>") + LEGS)
    fixed, geoms = corners_of(f"<body {turned}>{seen}</body>{LEGS}")
    assert geoms == ["box"]
    assert fixed == pytest.approx(alone, abs=1e-12)
    half = np.array([0.05, 0.1, 0.02] if turned else [0.1, 0.05, 0.02])
    middle = np.array([0.01, 0, 0.02] if turned else np.zeros(3))
    assert fixed.min(axis=0) == pytest.approx(middle - half)
    assert fixed.max(axis=0) == pytest.approx(middle + half)


def test_a_body_of_which_nothing_is_seen_reaches_from_leg_to_leg():
    corners, _ = corners_of(BOX.format(alpha=0) + LEGS)
    assert corners == pytest.approx(
        np.array([[0.1, 0.1, 0], [0.1, -0.1, 0], [-0.1, 0, 0]]), abs=1e-12
    )


def test_a_payload_is_no_part_of_the_outline():
    seen = BOX.format(alpha=1)
    load = '<body pos="0 0 0.3"><geom name="payload" size="0.005"/></body>'
    assert np.array_equal(corners_of(seen + load + LEGS)[0], corners_of(seen + LEGS)[0])
