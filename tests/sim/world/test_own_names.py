"""Robots with parts whose names the world of a walk gives are refused."""

import pytest

from models.errors import ModelError
from sim.preparation.setup import prepare
from sim.scenarios.obstacles import decode

GEOM = '<geom name="{}" size="0.01"/>'
LOADED = {"payload": (0.5, 0.0, 0.0, 0.0)}
WALL = {"kind": "box", "center": [2.0, 2.0], "size": [0.5, 0.5]}


@pytest.mark.parametrize(
    ("part", "given"),
    [
        (f'<body name="payload">{GEOM.format("")}</body>', LOADED),
        (GEOM.format("payload"), LOADED),
        (GEOM.format("obstacle_1_1"), {"obstacles": decode([WALL])}),
        (
            f'<body><joint name="backlash_lift_2"/>{GEOM.format("")}</body>',
            {"backlash": 0.01},
        ),
    ],
)
def test_the_part_is_named_with_the_way_out(part, given, edited, scenario):
    """A run's own model.xml has such parts, and its robot may be walked again."""
    robot = edited('<body name="leg_1"', f'{part}<body name="leg_1"')
    with pytest.raises(ModelError, match="repeated name '[a-z0-9_]+' in .*: rename it"):
        prepare(scenario(**given), robot)
