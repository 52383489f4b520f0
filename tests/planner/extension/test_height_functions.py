"""Stratified panels: areas of two leg angles against brackets and flows."""

from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from models.library import load
from models.motion.robot_equations import equations
from models.systems.catalogue import shipped_system
from planner.extension.height_functions import _angles, stratified_panels
from planner.planning.rollouts import play
from planner.systems.fields import lie_bracket
from planner.systems.strata import StratifiedSystem
from tests.systems import hexapod

TRIPODS = ("g1_1", "g2_2")
EXACT = 1e-12  # quadrature and flows both round in the last digits


def system_of(name):
    if name == "robot":
        return equations(load("hexapod")).system
    return shipped_system(name).system


@pytest.mark.parametrize(
    ("name", "strokes"),
    [
        ("biped", TRIPODS),
        ("paper-hexapod", TRIPODS),
        ("paper-hexapod", ("g12_1", "g12_2")),
        ("robot", TRIPODS),
        ("quadruped-crawl", ("g1234_1", "g1234_4")),
        ("octopod-pairs", ("g14_1", "g23_3")),
    ],
)
def test_a_loop_changes_the_pose_by_the_integral_over_its_area(name, strokes):
    system = system_of(name)
    panels = stratified_panels(system, strokes)
    rng = np.random.default_rng(0)
    for by in rng.uniform(-1.5, 1.5, size=(6, 2)):
        end = play(system, panels.loop(by), np.zeros(system.dimension))[-1]
        change = [panels.change(c, (0, 0), by) for c in ("x", "y", "theta")]
        assert change == pytest.approx(end[:3], abs=EXACT)
        assert end[3:] == pytest.approx(0.0, abs=EXACT)


def test_a_loop_may_start_with_legs_and_heading_anywhere():
    system = hexapod(heights=True)
    angles, heading = (-0.4, 0.3), 0.7
    at_zero = heading - (angles[0] - angles[1])
    panels = stratified_panels(system, TRIPODS, {"theta": at_zero})
    start = np.array([0.0, 0.0, heading, *angles, 0.0, 0.0])
    end = play(system, panels.loop((0.9, 0.5)), start)[-1]
    change = [panels.change(c, angles, (0.9, 0.5)) for c in ("x", "y")]
    assert change == pytest.approx(end[:2], abs=EXACT)


def test_where_a_loop_starts_the_height_is_the_bracket():
    system = hexapod(stride=0.3, yaw_gain=0.7)
    bracket = lie_bracket(*(system.fields[f] for f in TRIPODS), system.state)
    panels = stratified_panels(system, TRIPODS)
    at_start = bracket.subs(dict.fromkeys(system.state, 0))
    heights = [float(panels.at(c, 0.0, 0.0)) for c in ("x", "y", "theta")]
    assert heights == pytest.approx([float(e) for e in at_start[:3]], abs=EXACT)
    assert heights[1] == pytest.approx(2 * 0.3 * 0.7)


def test_strokes_of_any_rate_go_around_the_same_loop():
    """A leg that turns by two radians per unit of its field."""
    x, a, b = state = sp.symbols("x a b")
    system = StratifiedSystem(
        state,
        {"12": {}, "1": {"f": [0, 2, 0]}, "2": {"g": [a, 0, -1]}},
        "12",
    )
    panels = stratified_panels(system, ("f", "g"))
    end = play(system, panels.loop((0.5, 0.25)), np.zeros(3))[-1]
    assert panels.change("x", (0, 0), (0.5, 0.25)) == pytest.approx(end[0], abs=EXACT)
    assert end[0] == pytest.approx(-0.125)


@pytest.mark.parametrize(
    ("name", "strokes", "why"),
    [
        ("biped", ("g1_1", "g9_9"), "field g9_9 .*g1_1"),
        ("unicycle", ("drive", "turn"), "drive moves no shape coordinate"),
        ("biped", ("g1_1", "g1_1"), "g1_1 moves no shape coordinate"),
        ("hexapod-trailer", TRIPODS, "the rates of psi depend on more than phi_1"),
    ],
)
def test_strokes_without_a_height_function_are_refused(name, strokes, why):
    with pytest.raises(ValueError, match=why):
        stratified_panels(system_of(name), strokes)


def test_python_functions_have_no_height_function():
    system = StratifiedSystem(
        ("x", "a", "b"),
        {"0": {"f": lambda x: np.array([x[2], 1, 0]), "g": lambda x: np.eye(3)[2]}},
        "0",
    )
    with pytest.raises(ValueError, match="field f is a Python function"):
        stratified_panels(system, ("f", "g"))


def test_a_panel_that_is_not_there_is_refused():
    panels = stratified_panels(hexapod(), TRIPODS)
    with pytest.raises(ValueError, match="panel phi_1 .*theta"):
        panels.at("phi_1", 0.0, 0.0)


def test_of_coordinates_that_a_stroke_moves_one_that_bends_no_field_is_its_angle():
    """A heading is in the fields, and is none; of angles alike the first one is."""
    state = sp.symbols("heading a b c")
    fields = {"f": sp.Matrix([1, sp.cos(state[0]), 0, 0])}
    shape = SimpleNamespace(
        system=SimpleNamespace(state=state, fields=fields),
        coordinates=(0, 1, 2, 3),
        rates={"f": [1.0, 4.0, 5.0, 0.0], "g": [0.0, 0.0, 0.0, 2.0]},
    )
    assert _angles(shape, ("f", "g")) == ((1, 3), (4.0, 2.0))
    assert _angles(shape, ("g", "f")) == ((3, 1), (2.0, 4.0))


def test_a_start_of_unknown_coordinates_is_refused():
    with pytest.raises(ValueError, match="coordinate nope is unknown"):
        stratified_panels(hexapod(), TRIPODS, {"nope": 1.0})
