"""Fields as measured in the physics, and steering on them."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models.description.robot import FOLDER
from models.errors import MeasurementError
from models.motion.twists import IdentifiedTwists, MeasuredField
from sim.commands.robots import fields
from sim.evaluation.quantities import describe
from sim.experiments.identification import confirmed, identify, measure, twist_model
from sim.folder import RunFolder
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.progress import silent
from sim.run_folder import run
from sim.scenarios.file import load_scenario

pytestmark = pytest.mark.physics
MIDDLE = np.zeros((1, 2))


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


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


def test_fields_of_the_hexapod_are_confirmed_over_the_whole_joint_range(identified):
    reaches = [field.reach for field in identified.fields.values()]
    assert reaches == pytest.approx([0.45] * 4, abs=0.01)


def test_a_field_that_a_stroke_back_does_not_follow_is_refused(setup, identified):
    field = identified.fields["g1_1"]
    half = replace(field, twist=tuple(part / 2 for part in field.twist))
    with pytest.raises(
        MeasurementError, match="a stroke in the opposite direction departs"
    ):
        confirmed(setup, "g1_1", half)


def test_a_swing_beyond_what_was_confirmed_is_refused():
    fields = {"a": replace(constant("1", (1.0, 0.0), (0.1, 0.0, 0.5)), reach=0.3)}
    twists, rates = IdentifiedTwists(fields), np.array([[1.0, 0.0]])
    assert twists("1", np.array([[0.3, 0.9]]), rates).shape == (1, 3)
    with pytest.raises(MeasurementError, match="field a swings to 0.35 rad"):
        twists("1", np.array([[-0.35, 0.0]]), rates)


@pytest.fixture(scope="module")
def faller(tmp_path_factory):
    """A hexapod whose card claims that it stands on its front legs alone."""
    folder = tmp_path_factory.mktemp("faller")
    for name in ("scene.xml", "hexapod.xml"):
        (folder / name).write_text((FOLDER / name).read_text())
    card = (FOLDER / "hexapod.toml").read_text()
    for old, new in (
        ("4 = -1, 5 = -1 }", "2 = -1, 3 = -1 }\ntwist = [0.04, 0, 1]"),
        ("{ 2 = 1, 3 = 1, 6 = 1 }", "{ 4 = 1, 5 = 1, 6 = 1 }\ntwist = [0.04, 0, -1]"),
    ):
        assert old in card
        card = card.replace(old, new)
    (folder / "hexapod.toml").write_text(card)
    overrides = {"robot": str(folder / "hexapod.xml"), "segments": 1}
    tips = {"path.goal": [0.01, 0.0, 0.0], "allow_unstable": True}
    return load_scenario("line", overrides | tips)


def test_a_field_on_which_the_robot_falls_is_null_with_the_reason(faller):
    found = {field["field"]: field for field in fields(prepare(faller), silent)}
    assert found["g12_1"]["reason"] is None
    for name in ("g1_1", "g2_2"):
        assert found[name]["twists"] is found[name]["slip"] is None
        assert re.fullmatch(
            r"on S[12] the robot tilts by 7.* degrees", found[name]["reason"]
        )


def test_a_walk_on_such_a_field_has_no_identified_prediction(faller, tmp_path):
    summary = run(faller, RunFolder(tmp_path), without=("compliant", "creep_floor"))
    kept = json.loads((tmp_path / "summary.json").read_text())
    for of in (summary, kept):
        assert of["predicted"]["identified"] is of["error"]["identified"] is None
        assert "tilts by" in of["unpredicted"]["identified"]
        assert of["predicted"]["quasi_static"]["pose"]
    assert "field g1_1 could not be measured: on S1" in describe(summary)
    assert "identified_pose" not in np.load(tmp_path / "trajectory.npz")


def test_steering_on_such_a_field_is_refused(faller):
    steered = prepare(replace(faller, steer="identified"))
    with pytest.raises(MeasurementError, match="g1_1 could not be measured: on S1"):
        plan_open_loop(steered)


def test_a_slow_walk_costs_no_longer_experiments(identified):
    slow = {"swing_speed": 1e-4, "swing_acceleration": 1e-3, "hold": 60.0}
    field = measure(prepare(load_scenario("line", slow)), "1", "g1_1")
    middle, same = np.zeros(1), identified.fields["g1_1"]
    # the same experiment to the last bit
    assert (field(middle) == same(middle)).all()
