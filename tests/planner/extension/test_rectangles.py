"""Rectangles of words: chosen by the fields, so that signs and units do not matter."""

from itertools import product

import numpy as np
import pytest

from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.extension.rectangles import weights
from planner.lie.hall import degree, hall_basis
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.planning.shooting import steer
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, hexapod

GOAL = [0.15, 0.15, 0, 0, 0]
GAINS = [*product((1, -1), repeat=2), (0.5, 1), (-1, 3)]


def rescaled(system, gains):
    """The same robot, its groups' angles counted in other units or directions."""
    forward = dict(zip(("phi_1", "phi_2"), gains, strict=True))
    moved = {}
    for name, fields in system.strata.items():
        moved[name] = {}
        for field, column in fields.items():
            moving = [str(s) for s, rate in zip(system.state, column, strict=True)
                      if str(s) in forward and rate != 0]  # fmt: skip
            unit = forward[moving[0]] if moving else 1
            body = [e * unit for e in column[:3]]
            moved[name][field] = [*body, *column[3:]]
    return StratifiedSystem(system.state, moved, system.bottom, system.level_sets)


def ends(gains, segments, elements=LIFTED, coordinates="fewest"):
    system = rescaled(hexapod(**METRES), gains)
    way = line([0.0] * 5, GOAL)
    execution = Execution(coordinates=coordinates)
    planned = plan(extend(system, elements), way, segments, execution=execution)
    return planned, rollout(planned)[-1]


@pytest.mark.parametrize("gains", GAINS)
def test_error_and_switches_are_the_same_in_all_signs_and_units(gains):
    for segments in (10, 40):
        plain, end = ends((1, 1), segments)
        planned, reached = ends(gains, segments)
        # 4e-9 found: brackets beyond the third degree depend on the corner
        assert np.linalg.norm(reached - GOAL) == pytest.approx(
            np.linalg.norm(end - GOAL), abs=1e-7
        )
        assert planned.contact_switches == plain.contact_switches


@pytest.mark.parametrize("gains", GAINS)
def test_error_falls_as_the_number_of_segments_in_all_signs_and_units(gains):
    coarse, fine = (
        np.linalg.norm(ends(gains, segments)[1] - GOAL) for segments in (40, 160)
    )
    # four times as many segments: a fourth, where unlucky corners would give a half
    assert fine < 0.27 * coarse


def test_names_in_another_order_plan_as_well():
    turned = ("g2_2", "g1_1", "g1_2", "g2_1", "[g2_2,g1_1]")
    planned, end = ends((1, 1), 40, elements=turned)
    plain, reached = ends((1, 1), 40)
    assert np.linalg.norm(end - GOAL) < 1.2 * np.linalg.norm(reached - GOAL)
    assert planned.contact_switches == plain.contact_switches


def test_printed_words_are_kept_where_they_are_as_good():
    extended = extend(hexapod(**METRES), LIFTED)
    coordinates = np.array([[0.1, 0.2, 0.0, 0.0, 0.5], [0.1, 0.2, 0.0, 0.0, -0.5]])
    printed = extended.steering.words(coordinates, "backward")
    assert extended.steering.words(coordinates, "backward", np.zeros((2, 5))) == printed


def test_all_rectangles_reach_the_same_coordinates():
    extended = extend(rescaled(hexapod(**METRES), (-2, 1)), LIFTED)
    coordinates = np.array([[0.1, 0.2, 0.0, 0.0, 0.5]])
    (word,) = extended.steering.words(coordinates, "backward", np.zeros((1, 5)))
    (printed,) = extended.steering.words(coordinates, "backward")
    assert word.durations != pytest.approx(printed.durations)
    # A nilpotent system of degree 2 is moved to its coordinates by either word.
    for spelled in (word, printed):
        x = y = area = 0.0
        for field, duration in zip(spelled.fields, spelled.durations, strict=True):
            area += x * duration if field == "g2_2" else 0.0
            x += duration if field == "g1_1" else 0.0
            y += duration if field == "g2_2" else 0.0
        assert [x, y, area] == pytest.approx([0.1, 0.2, 0.5], abs=1e-12)


@pytest.mark.parametrize("gains", GAINS)
def test_shots_end_where_their_plan_does(gains):
    extended = extend(rescaled(hexapod(**METRES), gains), LIFTED)
    found = steer(extended, [0.0] * 5, GOAL, Execution(coordinates="backward"))
    assert rollout(found.plan)[-1] == pytest.approx(np.array(GOAL), abs=2e-9)


def test_brackets_are_weighed_by_the_scales_of_their_generators():
    assert weights(hall_basis(2, 3), np.array([2.0, -3.0])).tolist() == [
        2, -3, -6, -12, 18,
    ]  # fmt: skip


@pytest.mark.parametrize("scale", [0.5, 3.0])
def test_leading_errors_grow_with_the_next_degree_of_the_motion(scale):
    """Of brackets of two, which grow as an area, they are the third power of a side."""
    rectangles = extend(hexapod(**METRES), LIFTED).steering.rectangles
    rng = np.random.default_rng(8)
    degrees = np.array([degree(e) for e in rectangles.hall.elements])
    own = rng.normal(size=(4, 3, len(degrees))) * (degrees == 2)  # areas alone
    count = rectangles.fields.values(np.zeros((1, 5))).shape[-1] - len(degrees)
    beyond = rng.normal(size=(4, 3, count))
    h = rng.normal(size=(4, len(degrees)))
    errors = rectangles._errors(h, own, beyond)
    assert errors.min() > 0
    larger = rectangles._errors(scale**2 * h, own, beyond)
    assert larger == pytest.approx(scale**3 / scale**2 * errors)
    # of a motion by a generator, of which a side is a length, the second power
    own = rng.normal(size=(4, 3, len(degrees))) * (degrees == 1)
    errors = rectangles._errors(h, own, beyond)
    larger = rectangles._errors(scale**2 * h, own, beyond)
    assert larger == pytest.approx(scale**3 / scale * errors)
