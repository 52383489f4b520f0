"""Every number that Sec. 6 prints, and the errata where it prints another."""

import numpy as np
import pytest
import sympy as sp

from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import play, rollout
from planner.systems.fields import bracket
from planner.systems.flows import Flow, visits
from tests.systems import PAPER, THETA, hexapod

P = np.zeros(5)
Q = np.array([1.0, 1, 0, 0, 0])
ROUNDING = 1e-12
REFERENCE = 1e-9  # digits that the reference ends are known to


@pytest.fixture(scope="module")
def system():
    return hexapod()


@pytest.fixture(scope="module")
def extended(system):
    return extend(system, PAPER)


def from_p_to_q(extended, segments=1):
    return plan(
        extended, line(P, Q), segments, execution=Execution(coordinates="backward")
    )


def test_eq_16_has_two_columns_on_the_bottom_stratum(system):
    forward = [sp.cos(THETA), sp.sin(THETA)]
    assert system.strata["12"]["g12_1"] == sp.Matrix([*forward, 1, 1, 0])
    assert system.strata["12"]["g12_2"] == sp.Matrix([*forward, -1, 0, 1])


@pytest.mark.parametrize("length", [1.0, 0.3, 2.5])
def test_bracket_on_the_bottom_stratum_points_sideways(length):
    fields = hexapod(yaw_gain=length).fields
    state = hexapod().state
    sideways = [-2 * length * sp.sin(THETA), 2 * length * sp.cos(THETA), 0, 0, 0]
    found = bracket(fields["g12_1"], fields["g12_2"], state)
    assert sp.simplify(found - sp.Matrix(sideways)) == sp.zeros(5, 1)


@pytest.mark.parametrize("theta", np.linspace(0, 6, 7))
def test_elements_span_the_tangent_space_everywhere(extended, theta):
    assert np.linalg.matrix_rank(extended.columns([0, 0, theta, 0, 0])) == 5


def test_fictitious_inputs_are_those_printed(extended):
    theta, length = 0.4, 0.7
    other = extend(hexapod(yaw_gain=length), PAPER)
    x = np.array([0, 0, theta, 0, 0])
    along, across = np.cos(theta) + np.sin(theta), np.cos(theta) - np.sin(theta)
    printed = np.array([length, length, -length, -length, 0]) * along / (2 * length)
    printed[4] = across / (2 * length)
    assert other.fictitious_inputs(x, Q) == pytest.approx(printed, abs=ROUNDING)
    halves = np.array([1, 1, -1, -1, 1]) / 2
    assert extended.fictitious_inputs(P, Q) == pytest.approx(halves, abs=ROUNDING)


def test_first_four_hall_coordinates_are_those_printed(extended):
    printed = [1 / 2, 1 / 2, -1 / 2, -1 / 2]
    found = from_p_to_q(extended).hall_coordinates[0, :4]
    assert found == pytest.approx(printed, abs=ROUNDING)


def test_fifth_hall_coordinate_is_5_8_where_the_paper_prints_3_4(extended):
    # h5' = v5 + h1 v2 with h1 = t/2 integrates to 1/2 + 1/8
    assert from_p_to_q(extended).hall_coordinates[0, 4] == pytest.approx(5 / 8)


def test_control_sequence_is_the_one_displayed_with_5_8_for_3_4(extended):
    root = np.sqrt(5 / 8)
    flows = from_p_to_q(extended).flows
    on_bottom = [
        Flow("12", "g12_1", root),
        Flow("12", "g12_2", root),
        Flow("12", "g12_1", -root),
        Flow("12", "g12_2", 1 / 2 - root),  # back along the word, then on along u2
        Flow("12", "g12_1", 1 / 2),
    ]
    for flow, displayed in zip(flows, on_bottom, strict=False):
        assert flow[:2] == displayed[:2]
        assert flow.duration == pytest.approx(displayed.duration, abs=ROUNDING)


def test_higher_strata_swing_feet_by_g_12_where_the_text_prints_g_11(extended):
    # "to flow along g_{1,1}, u1 = -1" is g_{1,2}, u2 = -1, as the display has it
    above = {f.field: f.duration for f in from_p_to_q(extended).flows[5:]}
    assert above == pytest.approx({"g1_2": -1 / 2, "g2_1": -1 / 2}, abs=ROUNDING)


def test_each_higher_stratum_is_visited_once(extended):
    walk = [visit[0].stratum for visit in visits(from_p_to_q(extended).flows)]
    assert sorted(walk) == ["1", "12", "2"]


@pytest.mark.parametrize(
    ("segments", "end"),
    [(1, (0.958851077, 0.941402261)), (4, (0.997397867, 0.988373834))],
)
def test_reference_ends(extended, segments, end):
    reached = rollout(from_p_to_q(extended, segments))[-1]
    assert reached == pytest.approx([*end, 0, 0, 0], abs=REFERENCE)


def test_literal_3_4_ends_elsewhere(system):
    root = np.sqrt(3 / 4)
    word = [("g12_1", root), ("g12_2", root), ("g12_1", -root), ("g12_2", -root)]
    word += [("g12_2", 1 / 2), ("g12_1", 1 / 2)]
    end = play(system, [Flow("12", name, t) for name, t in word], P)[-1]
    assert end[:3] == pytest.approx([0.958851, 1.163728, 0], abs=1e-6)


def test_order_of_the_display_is_harmless_because_the_swings_commute(system, extended):
    # eq. (6) puts B3 and B4 before B2 and B1, the display puts them last
    flows = from_p_to_q(extended).flows
    swings = [flow for flow in flows if flow.stratum != "12"]
    loaded = [flow for flow in flows if flow.stratum == "12"]
    orders = (loaded + swings, loaded[:3] + swings + loaded[3:])
    first, second = (play(system, order, P)[-1] for order in orders)
    assert first == pytest.approx(second, abs=ROUNDING)


def test_legs_return_to_their_initial_position(extended):
    assert rollout(from_p_to_q(extended))[-1, 3:] == pytest.approx([0, 0], abs=ROUNDING)
