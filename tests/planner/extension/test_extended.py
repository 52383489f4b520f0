"""The extended system: what it is made of, its inputs, and what it refuses."""

import numpy as np
import pytest
import sympy as sp

from planner.errors import DecouplingError, PlannerError, RankError
from planner.extension.extended import extend
from planner.extension.fields_on_bottom import tangent_field
from planner.planning.rollouts import play
from planner.systems.fields import NumericField
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, PAPER, X, Y, heisenberg, hexapod

RNG = np.random.default_rng(3)
ROUNDING = 1e-13


def test_columns_are_those_of_eq_19():
    theta, (c, s) = 0.7, (np.cos(0.7), np.sin(0.7))
    matrix = extend(hexapod(), PAPER).columns([0, 0, theta, 0, 0])
    assert matrix == pytest.approx(
        np.array(
            [
                [c, c, 0, 0, -2 * s],
                [s, s, 0, 0, 2 * c],
                [1, -1, 0, 0, 0],
                [1, 0, 0, 1, 0],
                [0, 1, 1, 0, 0],
            ]
        ),
        abs=ROUNDING,
    )


def test_lifted_fields_are_the_same_columns_as_the_papers():
    x = RNG.uniform(-1, 1, (4, 5))
    paper, lifted = (extend(hexapod(), names).columns(x) for names in (PAPER, LIFTED))
    assert lifted == pytest.approx(paper, abs=ROUNDING)


def test_inputs_give_the_velocity_asked_for_at_every_configuration():
    extended = extend(hexapod(0.04, 0.6, heights=True), LIFTED)
    x = RNG.uniform(-1, 1, (3, 4, 7)) * [1, 1, 1, 1, 1, 0, 0]
    velocity = RNG.uniform(-1, 1, (3, 4, 7)) * [1, 1, 1, 1, 1, 0, 0]
    inputs = extended.fictitious_inputs(x, velocity)
    reached = (extended.columns(x) @ inputs[..., None])[..., 0]
    assert inputs.shape == (3, 4, 5)
    assert reached == pytest.approx(velocity, abs=1e-12)


def test_too_many_elements_share_the_work_by_least_norm():
    plane = StratifiedSystem("x y", {"0": {"a": [1, 0], "b": [0, 1], "c": [2, 0]}}, "0")
    inputs = extend(plane, ["a", "b", "c"]).fictitious_inputs(
        np.zeros(2), np.array([5.0, 1.0])
    )
    assert inputs == pytest.approx([1, 1, 2], abs=ROUNDING)


def test_elements_may_be_generator_numbers():
    extended = extend(hexapod(), ["1", "2", "4", "5", "[1,2]"])
    assert extended.elements == PAPER


def test_brackets_outside_the_selection_are_kept_unless_they_vanish():
    # the swings in the air commute with everything, the loaded ones do not
    assert extend(hexapod(), PAPER).steering.basis == PAPER
    three = extend(heisenberg(), ["g1", "g2"])
    assert three.steering.basis == ("g1", "g2")
    chosen = extend(
        StratifiedSystem(
            sp.symbols("x y z w"),
            {"0": {"a": [1, 0, 0, 0], "b": [0, 1, X, 0], "c": [0, 0, 0, sp.exp(X)]}},
            "0",
        ),
        ["a", "b", "c", "[a,b]"],
    )
    assert chosen.steering.basis == ("a", "b", "c", "[a,b]", "[a,c]")


def test_numeric_fields_span_as_symbolic_ones_do():
    def tripod(sign):
        return NumericField(
            lambda x: np.array([np.cos(x[2]), np.sin(x[2]), sign, sign > 0, sign < 0])
        )

    symbolic = hexapod()
    strata = {s: dict(fields) for s, fields in symbolic.strata.items()}
    strata["12"] = {"g12_1": tripod(1.0), "g12_2": tripod(-1.0)}
    numeric = StratifiedSystem(symbolic.state, strata, "12")
    x = RNG.uniform(-1, 1, (3, 5))
    # extrapolated differences in the bracket
    assert extend(numeric, PAPER).columns(x) == pytest.approx(
        extend(symbolic, PAPER).columns(x), abs=1e-10
    )


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ([], "no elements; choose fields"),
        ("g12_1", "elements is the text 'g12_1'; give a sequence"),
        (["g12_1", "1"], "element g12_1 is listed twice"),
        (["g9"], "field g9 is unknown"),
        (["g12_1", "g12_2", "[g12_2,g12_1]"], r"write \[g12_1,g12_2\]"),
        (["g12_1", "g12_2", "[1,[2,[1,2]]]"], "choose from the Hall basis"),
    ],
)
def test_elements_that_make_no_system_are_refused(elements, message):
    with pytest.raises(ValueError, match=message):
        extend(hexapod(), elements)


def test_bracket_of_commuting_fields_is_refused():
    with pytest.raises(
        PlannerError, match=r"\[g1_2,g2_1\] vanishes.*its fields commute"
    ):
        extend(hexapod(), [*PAPER, "[g1_2,g2_1]"])


def test_field_that_is_zero_is_refused():
    still = StratifiedSystem("x", {"0": {"a": [1], "b": [0]}}, "0")
    with pytest.raises(PlannerError, match="element b vanishes everywhere: it is zero"):
        extend(still, ["a", "b"])


def test_missing_direction_is_a_rank_error_that_names_the_configuration():
    extended = extend(hexapod(), PAPER[:4])
    with pytest.raises(RankError, match=r"rank 4 of 5 at \(1, 2, 0, 0, 0\)") as refusal:
        extended.fictitious_inputs(np.array([1.0, 2, 0, 0, 0]), np.ones(5))
    assert (refusal.value.rank, refusal.value.needed) == (4, 5)


def test_rank_that_is_lost_at_one_configuration_only_is_found():
    pinched = StratifiedSystem((X, Y), {"0": {"a": [1, 0], "b": [0, X]}}, "0")
    x = np.array([[1.0, 0.0], [0.0, 7.0], [-1.0, 0.0]])
    with pytest.raises(RankError, match=r"rank 1 of 2 at \(0, 7\)"):
        extend(pinched, ["a", "b"]).fictitious_inputs(x, np.ones((3, 2)))


def test_units_of_fields_do_not_cost_rank():
    # a square system, one with a field to spare, and one on a slope of its state
    units = {"a": [1e5, 0], "b": [0, 1e-5]}
    plane = StratifiedSystem((X, Y), {"0": units}, "0")
    spare = StratifiedSystem((X, Y), {"0": units | {"c": [1e5, 0]}}, "0")
    slope = StratifiedSystem((X, Y), {"0": {"a": [1e5, 1e5], "b": [1e-5, 0]}}, "0")
    velocity = np.array([1.0, 2.0])
    for system in (plane, spare, slope):
        extended = extend(system, tuple(system.fields))
        inputs = extended.fictitious_inputs(np.zeros(2), velocity)
        # what the sum of terms of 1e5 inputs of 1e-5 rounds by
        assert extended.columns(np.zeros(2)) @ inputs == pytest.approx(
            velocity, abs=1e-14
        )


def test_rounding_does_not_count_for_rank():
    # cos(pi / 2) is 6e-17, and asks for inputs of 1e16
    pinched = StratifiedSystem((X, Y), {"0": {"a": [1, 0], "b": [0, sp.cos(X)]}}, "0")
    with pytest.raises(RankError, match=r"rank 1 of 2 at \(1.5708, 0\)"):
        extend(pinched, ["a", "b"]).fictitious_inputs(
            np.array([np.pi / 2, 0]), np.array([0.0, 1.0])
        )


def test_velocity_off_the_bottom_stratum_is_refused():
    extended = extend(hexapod(heights=True), LIFTED)
    with pytest.raises(
        PlannerError, match="moves height_1 at .* that no element can give"
    ):
        extended.fictitious_inputs(np.zeros(7), np.array([1.0, 0, 0, 0, 0, 1, 0]))


@pytest.mark.parametrize("size", [1e-3, 1.0, 50.0])
def test_a_millionth_of_a_velocity_may_leave_the_bottom_stratum(size):
    extended = extend(hexapod(heights=True), LIFTED)
    along, up = np.eye(7)[0], np.eye(7)[5]
    found = extended.fictitious_inputs(np.zeros(7), size * (along + 0.9e-6 * up))
    assert extended.columns(np.zeros(7)) @ found == pytest.approx(
        size * along, abs=1e-12
    )
    with pytest.raises(PlannerError, match="moves height_1 at .* by .*e-0"):
        extended.fictitious_inputs(np.zeros(7), size * (along + 1.1e-6 * up))


def crane(**fields):
    """Two coordinates and a height; the load swings with the foot up."""
    state = sp.symbols("x y h")
    strata = {"on": {"slide": [1, 0, 0]}, "off": {"raise": [0, 0, 2]} | fields}
    return StratifiedSystem(state, strata, "on", {"on": [state[2]]})


def test_field_that_leaves_the_bottom_stratum_is_made_tangent():
    # Sec. 5.1: g - (f1 / f2) lift, with f1 = x and f2 = 2
    tilted = crane(swing=[0, 1, X])
    assert tangent_field(tilted, "swing") == sp.Matrix([0, 1, 0])
    assert tangent_field(tilted, "raise") is None
    extended = extend(tilted, ["slide", "swing"])
    assert extended.elements == ("slide", "swing_tangent")
    end = play(extended.system, [Flow("off", "swing_tangent", 0.3)], np.ones(3))[-1]
    assert end == pytest.approx([1, 1.3, 1], abs=ROUNDING)


def test_lift_that_changes_what_a_field_does_is_named():
    # Assumption 2 fails: the swing depends on the foot's height
    with pytest.raises(
        DecouplingError, match=r"\[raise,swing\] does not vanish"
    ) as refusal:
        extend(crane(swing=[0, sp.exp(sp.Symbol("h")), 0]), ["slide", "swing"])
    assert (refusal.value.lift, refusal.value.field) == ("raise", "swing")


def test_lift_itself_is_no_element():
    with pytest.raises(
        PlannerError, match="field raise leaves Son and no lift field of Soff"
    ):
        extend(crane(swing=[0, 1, 0]), ["slide", "raise"])


@pytest.mark.parametrize("metric", [{}, {"x": 10.0, "y": 0.1}])
def test_a_direction_that_lacks_is_told_in_the_coordinates_whatever_they_count(metric):
    fields = {"f": [1, 2], "g": [0, "x"]}
    system = StratifiedSystem("x y", {"0": fields}, "0", metric=metric)
    with pytest.raises(RankError, match=r"at \(0, 0\) .*, nothing along x - 0\.5 y;"):
        extend(system, ["f", "g"]).fictitious_inputs(np.zeros(2), np.array([1.0, 0.0]))
