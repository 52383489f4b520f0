"""Whether a robot stands: every foot bears some of the weight."""

import numpy as np
import pytest

from models.contact.kinematics import Kinematics
from models.contact.loads import StaticStability, static_loads
from models.description.card_file import parse_card
from models.description.robot import FOLDER
from models.errors import ModelError
from models.library import load

ANGLES = [np.linspace(-0.5, 0.5, n) for n in (3, 2, 4, 3)]


@pytest.mark.parametrize("stratum", ["234", "134", "124", "123", "1234"])
def test_loads_of_all_combinations_are_those_of_statics(stratum):
    robot = load("quadruped")
    swing = np.stack(np.meshgrid(*ANGLES, indexing="ij"), axis=-1).reshape(-1, 4)
    stance, on = Kinematics(robot).stance(swing), robot.planted(stratum)
    expected = static_loads(stance.feet[:, on], stance.center_of_mass).min(axis=1)
    (got,) = StaticStability(robot).least_loads([stratum], ANGLES)
    assert got.shape == (3, 2, 4, 3)
    # statics gives none where a foot would have to pull
    assert np.maximum(got.ravel(), 0) == pytest.approx(expected, abs=1e-9)


def test_groups_of_legs_stand_together():
    hexapod = StaticStability(load("hexapod"))
    # a tripod at rest bears 0.2, 0.6 and 0.2
    assert hexapod.least_loads(["1"], [np.zeros(1)] * 2) == pytest.approx(0.2, abs=0.01)


def test_quadruped_can_lift_front_legs_at_rest_and_hind_ones_elsewhere():
    robot = load("quadruped")
    found, asked = StaticStability(robot).at_rest_and_best(), robot.card.least_load
    assert set(found) == {"234", "134", "124", "123"}
    assert all(found[front][0] > asked for front in ("234", "134"))
    assert all(found[hind][0] < 0 for hind in ("124", "123"))
    assert all(best > asked for _, best in found.values())


@pytest.mark.parametrize("name", ["quadruped", "hexapod"])
def test_the_best_share_is_that_of_any_legs_at_zero_or_at_an_end_of_their_range(name):
    robot = load(name)
    places = [np.array([low, 0.0, high]) for low, high in robot.swing_range.values()]
    swing = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)
    swing = swing.reshape(-1, len(places))
    stance = Kinematics(robot).stance(swing)
    for stratum, (rest, best) in StaticStability(robot).at_rest_and_best().items():
        on = robot.planted(stratum)
        loads = static_loads(stance.feet[:, on], stance.center_of_mass).min(axis=1)
        assert best == pytest.approx(loads.max(), abs=1e-9)
        # statics gives none where a foot would have to pull
        assert max(rest, 0) == pytest.approx(loads[len(loads) // 2], abs=1e-9)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("least_load = 0.4", "least_load is a share of the weight below 1/3, got 0.4"),
        (
            "least_load = -0.1",
            "least_load is a share of the weight below 1/3, got -0.1",
        ),
        ("leest_load = 0.1", "gait has no key 'leest_load'; did you mean 'least_load'"),
    ],
)
def test_impossible_share_is_refused(line, message):
    text = (FOLDER / "quadruped.toml").read_text()
    changed = text.replace("least_load = 0.06", line)
    with pytest.raises(ModelError, match=message):
        parse_card(changed, "mine.toml")
    slow = text.replace("lift_time = 0.6", "lift_time = 0")
    with pytest.raises(ModelError, match="lift_time must be positive, got 0"):
        parse_card(slow, "mine.toml")
