"""Borders that numbers of files reach exactly: the last taken, the first refused."""

from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace

import mujoco
import pytest

from models.checks import _part_problems
from models.description import inspection
from models.description.table import Table, _is_number
from models.errors import ModelError
from models.morphology.mjcf import Leg
from models.morphology.shipped import SHAPES, reshaped
from models.systems.problem import configuration
from models.systems.smooth import chained
from planner import StratifiedSystem

LARGEST_NUMBER = 1e12  # numbers beyond it overflow somewhere
OVERFLOWING = 1e100  # of a coordinate; derivatives at larger ones overflow
LONGEST_CHAIN = 8  # likewise

PLANE = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")


def test_numbers_up_to_the_largest_are_taken_from_files():
    assert _is_number(LARGEST_NUMBER)
    assert _is_number(-LARGEST_NUMBER)
    assert not _is_number(LARGEST_NUMBER * 1.001)
    assert not _is_number(-LARGEST_NUMBER * 1.001)


def test_chains_have_three_to_eight_coordinates():
    assert [chained(n).system.dimension for n in (3, LONGEST_CHAIN)] == [3, 8]
    for size in (2, LONGEST_CHAIN + 1):
        with pytest.raises(ValueError, match="a chain has 3 to 8"):
            chained(size)


def test_coordinates_stay_below_what_overflows():
    assert configuration(PLANE, "start", {"y": 0.99 * OVERFLOWING})[1] > 1
    for value in (OVERFLOWING, -OVERFLOWING):
        with pytest.raises(ValueError, match="give one below"):
            configuration(PLANE, "start", {"y": value})


def test_legs_and_shapes_have_a_size():
    with pytest.raises(ValueError, match="leg of length 0"):
        Leg((0.1, 0.2), (0.1, 0.2))
    with pytest.raises(ValueError, match=r"stiffness = 0\.0 is not above 0"):
        reshaped("hexapod", {"stiffness": 0.0})


@pytest.mark.parametrize(
    ("angle", "found"), [(-0.5, []), (0.25, []), (0.26, ["held_outside"])]
)
def test_a_joint_may_be_held_at_an_end_of_its_range(angle, found):
    text = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="a"
    range="-.5 .25" limited="true"/><geom size=".1"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    leg = SimpleNamespace(joints=["a"], hold={"a": angle}, foot=[])
    assert [what for what, _ in _part_problems(model, leg)] == found


@pytest.mark.parametrize(
    ("count", "more"), [(3, ""), (4, " and 1 more"), (9, " and 6 more")]
)
def test_files_from_elsewhere_are_named_up_to_three(count, more, monkeypatch):
    taken = [Path(f"/far/{number}.stl") for number in range(count)]
    monkeypatch.setattr(inspection, "_tried", lambda _: [])
    monkeypatch.setattr(inspection, "outside", lambda *_: taken)
    with pytest.raises(ModelError) as caught:
        inspection.inspect_model(Path("/here/robot.xml"))
    assert f"/far/2.stl{more}" in str(caught.value)
    assert ("more" in str(caught.value)) == bool(more)


def test_that_numbers_are_too_large_is_told_of_finite_ones_beyond_the_largest():
    for value, told in ((2 * LARGEST_NUMBER, True), (inf, False), (-inf, False)):
        with pytest.raises(ValueError, match="must be a number") as caught:
            Table({"a": value}).number("a")
        assert ("none beyond 1e+12" in str(caught.value)) == told
    with pytest.raises(ValueError, match="must be a text") as caught:
        Table({"a": LARGEST_NUMBER}).text("a")
    assert "beyond" not in str(caught.value)


@pytest.mark.parametrize("name", ["stiffness", "hip_height", "leg_mass"])
def test_what_a_shape_weighs_and_measures_is_positive(name):
    with pytest.raises(ValueError, match=f"{name} must be positive, got 0"):
        replace(SHAPES["hexapod"], **{name: 0.0})
