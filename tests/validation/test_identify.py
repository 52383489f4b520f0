"""Fields as measured in the physics, and steering on them."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models.identified import IdentifiedTwists, MeasuredField
from sim.identify import identify
from sim.scenario_file import load
from sim.setup import prepare
from sim.twist_models import twist_model

pytestmark = pytest.mark.physics
MIDDLE = np.zeros((1, 2))


@pytest.fixture(scope="module")
def setup():
    return prepare(load("line"))


@pytest.fixture(scope="module")
def identified(setup):
    return identify(setup)


def constant(stratum, direction, twist):
    parts = tuple(Polynomial([value]) for value in twist)
    return MeasuredField(stratum, direction, 0.2, parts, 0.0)


def test_every_loaded_field_is_measured(identified):
    assert set(identified.fields) == {"g12_1", "g12_2", "g1_1", "g2_2"}


@pytest.mark.parametrize("group", [0, 1])
def test_a_tripod_alone_turns_the_body_about_its_pivot(identified, group):
    rates = np.eye(2)[group][None]
    forward, left, yaw = identified("12"[group], MIDDLE, rates)[0]
    # stride 0.0378 m/rad and yaw gain 0.56; 0.3 % and 0.2 mm/rad off are measured
    assert forward == pytest.approx(0.0378, rel=0.01)
    assert abs(left) < 5e-4
    assert yaw == pytest.approx([0.56, -0.56][group], rel=0.01)


def test_the_quasi_static_model_knows_the_field_on_the_bottom_stratum(
    setup, identified
):
    rates = np.array([[1.0, 0.0]])
    measured = identified("12", MIDDLE, rates)[0]
    predicted = twist_model(setup, "quasi_static")("12", MIDDLE, rates)[0]
    # 0.5 % measured; the ideal field is twice to three times as large
    assert measured == pytest.approx(predicted, rel=0.05, abs=2e-4)


def test_fields_of_one_stratum_add_up():
    fields = {
        "a": constant("12", (1.0, 0.0), (0.1, 0.0, 0.5)),
        "b": constant("12", (0.0, 1.0), (0.2, 0.1, -0.5)),
        "c": constant("1", (1.0, 0.0), (9.0, 9.0, 9.0)),
    }
    twist = IdentifiedTwists(fields)("12", MIDDLE, np.array([[2.0, 1.0]]))
    assert twist[0] == pytest.approx([0.4, 0.1, 0.5])


def test_beyond_its_span_a_field_is_that_of_its_end():
    slope = (Polynomial([0.0, 1.0]),) * 3
    field = MeasuredField("1", (1.0, 0.0), 0.2, slope, 0.0)
    ends = field(np.array([-1.0, 0.1, 1.0]))[:, 0]
    assert ends == pytest.approx([-0.2, 0.1, 0.2])
