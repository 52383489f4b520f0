"""Fictitious inputs: of least norm, refused where elements nearly lose rank."""

import numpy as np
import pytest

from planner.errors import PlannerError, RankError
from planner.extension.choice import choose_elements
from planner.extension.extended import _decomposed, _inverse, extend
from planner.systems.fields import sample_configurations
from planner.systems.strata import StratifiedSystem

CONDITION = 1e9  # number of B(x) beyond which the elements count as dependent
UNREACHED = 1e-6  # relative part of a velocity that the elements may miss


def plane(metric=None, **fields):
    return StratifiedSystem("x y", {"0": fields}, "0", metric=metric or {})


THREE = {"a": [1, 0], "b": [1, 2], "c": ["3 + x", -1]}
AT = np.array([[0.5, 0.1], [-0.7, 2.0]])
VELOCITY = np.array([[1.0, 2.0], [-3.0, 0.5]])


@pytest.mark.parametrize("units", [None, [1.0, 2.0, 0.25]])
@pytest.mark.parametrize("metric", [{}, {"x": 10.0}])
def test_redundant_elements_have_inputs_of_least_norm_in_their_units(units, metric):
    extended = extend(plane(metric, **THREE), ["a", "b", "c"])
    given = None if units is None else np.array(units)
    found = extended.fictitious_inputs(AT, VELOCITY, given)
    scale = np.ones(3) if units is None else given
    for x, v, inputs in zip(AT, VELOCITY, found, strict=True):
        matrix = np.array([[1, 1, 3 + x[0]], [0, 2, -1]])
        assert matrix @ inputs == pytest.approx(v)
        assert inputs == pytest.approx(scale * (np.linalg.pinv(matrix * scale) @ v))


@pytest.mark.parametrize(("share", "regular"), [(0.9, True), (1.1, False)])
def test_elements_span_up_to_a_condition(share, regular):
    """Of columns (1, 0) and (1, e), in the norm of rows, it is about 2 / e."""
    least = 2.0 / (share * CONDITION)
    matrix = np.array([[1.0, 1.0], [0.0, least]])
    assert (_inverse(matrix) is not None) == regular
    assert _inverse(np.ones((2, 3))) is None
    assert _inverse(np.zeros((2, 2))) is None
    both = np.stack([np.eye(2), matrix])
    assert (_inverse(both) is not None) == regular


@pytest.mark.parametrize(("share", "regular"), [(1.2, True), (0.8, False)])
def test_redundant_elements_span_up_to_the_same_condition(share, regular):
    """The lesser singular value of three columns over the larger, in any units."""
    # the greater is the root of 3, the lesser e times that of 2
    e = share * np.sqrt(1.5) / CONDITION
    extended = extend(plane(a=[1, 0], b=[1, e], c=[1, -e]), ["a", "b", "c"])
    x, v = np.zeros(2), np.array([1.0, 1e-10])
    if regular:
        found = extended.fictitious_inputs(x, v)
        assert found[0] + found[1] + found[2] == pytest.approx(1.0)
    else:
        with pytest.raises(RankError, match=r"y") as refused:
            extended.fictitious_inputs(x, v)
        assert refused.value.missing == ("y",)


@pytest.mark.parametrize(("share", "refused"), [(0.9, False), (1.1, True)])
def test_a_velocity_that_no_element_gives_is_refused(share, refused):
    system = StratifiedSystem(
        "x y h", {"1": {"a": [1, 0, 0], "b": [0, 1, 0]}, "0": {"up": [0, 0, 1]}}, "1",
        level_sets={"1": ["h"]},
    )  # fmt: skip
    extended = extend(system, ["a", "b"])
    velocity = np.array([2.0, -4.0, share * 4.0 * UNREACHED])
    if refused:
        told = (
            r"moves h at \(0, 0, 0\) by 4.4e-06 that no element can give; keep it on S1"
        )
        with pytest.raises(PlannerError, match=told):
            extended.fictitious_inputs(np.zeros(3), velocity)
    else:
        assert extended.fictitious_inputs(np.zeros(3), velocity)[:2].tolist() == [2, -4]
    still = np.array([0.0, 0.0, share * 1e-12])
    if refused:
        with pytest.raises(PlannerError, match="that no element can give"):
            extended.fictitious_inputs(np.zeros(3), still)
    else:
        extended.fictitious_inputs(np.zeros(3), still)


def test_orientations_are_signs_of_the_determinant():
    extended = extend(plane(a=["x", 0], b=[1, 1]), ["a", "b"])
    x = np.array([[[-2.0, 0], [3.0, 0]], [[0.5, 1], [-1.0, 1]]])
    assert extended.orientations(x).tolist() == [[-1, 1], [1, -1]]
    wide = extend(plane(**THREE), ["a", "b", "c"])
    assert wide.orientations(x).tolist() == [[1, 1], [1, 1]]


def test_equal_matrices_are_decomposed_once_and_alike():
    rng = np.random.default_rng(0)
    one, other = rng.normal(size=(2, 2, 3))
    row = np.stack([one, one, other, other, one]).reshape(5, 1, 2, 3)
    left, singular, right = _decomposed(row)
    again = left * singular[..., None, :] @ right
    assert again == pytest.approx(row)
    assert left.shape == (5, 1, 2, 2)


def test_the_usual_length_of_an_element_is_its_median_on_the_path_and_near_it():
    system = plane({"x": 2.0}, a=["x", 0], b=["0", "1/y"])
    extended = extend(system, ["a", "b"])
    x = np.array([[[0.5, 0.0], [0.0, 2.0], [4.0, 1.0]]])
    matrix = extended.columns.values(x)
    found = extended._sizes(matrix, x)
    near = x[0, 0] + sample_configurations(2) / [2.0, 1.0]
    first = [2 * abs(value) for value in [*x[0, :, 0], *near[:, 0]] if value]
    second = [abs(1 / value) for value in [*x[0, :, 1], *near[:, 1]] if value]
    assert found == pytest.approx([np.median(first), np.median(second)])


def test_extended_systems_are_kept_and_their_degree_is_raised_on_demand():
    car = StratifiedSystem("x y a", {"0": {"d": ["cos(a)", "sin(a)", 0],
                                           "t": [0, 0, 1]}}, "0")  # fmt: skip
    first = extend(car, ["d", "t", "[d,t]"])
    assert extend(car, ("d", "t", "[d,t]")) is first
    assert first.to_degree(2) is first
    third = first.to_degree(3)
    assert third.to_degree(3) is third
    assert first.to_degree(3) is third
    assert third.steering.degree == 3
    assert len(third.steering.basis) > len(first.steering.basis)
    with pytest.raises(ValueError, match="degree is 1, but plans steer by brackets of"):
        first.to_degree(1)


def test_a_choice_says_what_each_element_adds_and_its_condition():
    system = StratifiedSystem(
        "x y z", {"12": {}, "1": {"f": [2, 0, 0]}, "2": {"g": [0, 1, "x"]}}, "12"
    )
    found = choose_elements(system, (1, 0, 0))
    assert found.elements == ("f", "g", "[f,g]")
    assert found.reasons == (
        "f: degree 1, 2 contact switches, adds x",
        "g: degree 1, 2 contact switches, adds y + z",
        "[f,g]: degree 2, 8 contact switches, adds -y + z",
    )
    matrix = np.array([[1, 0, 0], [0, 1, 0], [0, 1, 1]]) / [1, np.sqrt(2), 1]
    assert found.condition == pytest.approx(np.linalg.cond(matrix))
    for wrong in ((0, 0), np.zeros((2, 2, 3))):
        with pytest.raises(ValueError, match=r"expected \(k, 3\)"):
            choose_elements(system, wrong)
    with pytest.raises(ValueError, match="max_degree is 0; fields themselves have"):
        choose_elements(system, (0, 0, 0), 0)
