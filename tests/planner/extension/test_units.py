"""Units, senses and corners of rectangles, computed once more from the fields."""

import numpy as np
import pytest

from planner.extension.bracket_fields import hall_fields
from planner.extension.rectangles import rectangles, sign_choices, weights
from planner.systems.strata import StratifiedSystem

EQUAL = 1e-6  # relative difference below which units count as equal
LONGEST_SHAPE = 10.0  # times as long as wide that a rectangle may be
ROUNDING = 1e-12

METRIC = {"x": 2.0, "y": 2.0}


def made(f, g, names="x y a", metric=METRIC, top=2):
    system = StratifiedSystem(names, {"0": {"f": f, "g": g}}, "0", metric=metric)
    return rectangles(system, hall_fields(system, ("f", "g"), top))


def car(drive=1.0, turn=1.0):
    return made([f"{drive}*cos(a)", f"{drive}*sin(a)", 0], [0, 0, turn])


AT = np.array([[0.3, -0.2, 0.4], [1.0, 0.0, -2.0]])


@pytest.mark.parametrize(("drive", "turn"), [(1.0, 1.0), (0.5, -4.0)])
def test_units_move_by_a_length_of_one_in_the_metric(drive, turn):
    found = car(drive, turn).units.at(AT)
    assert found == pytest.approx(np.tile([0.5 / abs(drive), 1 / abs(turn)], (2, 1)))


def test_a_generator_that_moves_joints_is_measured_in_them_where_all_do():
    """Joints are coordinates that no field depends on."""
    f, g = ["3*cos(a)", 0, 0, 2, 0], ["0", 0, "5 + x", 0, 1]
    found = made(f, g, "x y a p q", {"x": 2.0, "p": 0.5}).units
    assert found.at(np.zeros((1, 5))) == pytest.approx(np.array([[1.0, 1.0]]))
    lacking = made(f, ["0", 0, "5 + x", 0, 0], "x y a p q", {"x": 2.0, "p": 0.5}).units
    first = np.hypot(6.0, 1.0)
    assert lacking.at(np.zeros((1, 5))) == pytest.approx(np.array([[1 / first, 0.2]]))


def test_a_generator_that_vanishes_nearby_or_everywhere_has_a_unit_still():
    units = made(["x", 0, 0], ["1/x", 1, 0]).units
    at = np.array([[0.0, 0.3, 0.1], [2.0, 0.0, 0.0]])
    around = at[0] + units._nearby
    near = 2 * np.sqrt((around[:, 0] ** 2).mean())
    found = units.at(at)
    assert found[0, 0] == pytest.approx(1 / near)
    assert found[1] == pytest.approx([0.25, 1 / np.hypot(1.0, 2.0)])
    rates = np.hypot(2 / around[:, 0], 2.0) ** 2  # of g, which is singular there
    assert found[0, 1] == pytest.approx(1 / np.sqrt(rates.mean()))


@pytest.mark.parametrize(
    ("f", "signs"),
    [
        (["cos(a)", "sin(a)", 0], [1, 1]),
        (["-cos(a)", "-sin(a)", 0], [1, 1]),  # they add up to more than 0
        (["1", "-1", 0], [1, 1]),
        (["-1", "1", 0], [-1, 1]),  # where they add up to nothing the first counts
        (["-1", "0.9", 0], [-1, 1]),
        (["-0.9", "1", 0], [1, 1]),
    ],
)
def test_generators_run_forward_whichever_way_they_are_declared(f, signs):
    units = made(f, [0, 0, 1]).units
    mean = units.generators.values(units._nearby)[..., 0].mean(axis=0) @ [2, 2, 1]
    found = units._senses
    if abs(mean) > 1e-3:
        assert found[0] == np.sign(mean)
    else:
        assert found.tolist() == signs
    turned = made([f"-({e})" for e in f], [0, 0, -1]).units
    assert turned._senses.tolist() == (-found).tolist()


def test_several_joints_run_the_way_of_the_body_at_rest():
    for way, sign in (("1 - 2*y", 1), ("-1 + 4*y", -1)):
        units = made([way, 0, "0", 1, -1], [0, 1, 0, 0, 0], "x y a p q").units
        assert units._senses[0] == sign
    one = made(["-1 + 4*y", 0, "0", 1, 0], [0, 1, 0, 0, 0], "x y a p q").units
    rates = one.generators.values(one._nearby)[..., 0] * one.weights
    assert one._senses[0] == np.sign(rates.sum())


def measured(h, at=AT[:1], drive=1.0, turn=1.0):
    return car(drive, turn).units.measured(np.array([h], dtype=float), at)


def test_what_is_small_beside_a_segment_s_motion_is_rounding():
    where = 2.0 * np.abs(AT[0, :2]).max()  # of the configuration, in the metric
    units = np.array([0.5, 1.0, 0.5])  # of coordinates of f, g and [f,g]
    for share, kept in ((0.9, False), (1.1, True)):
        for j in range(3):
            h = np.zeros(3)
            h[j] = share * ROUNDING * where * units[j]
            assert measured(h)[0].any() == kept
            h = np.array([10.0, 10.0, 10.0]) * units
            h[j] = share * ROUNDING * 10.0 * units[j]
            assert bool(measured(h)[0][0, j]) == kept


@pytest.mark.parametrize(
    ("h", "size"),
    [([0.5, 0, 0], 1.0), ([0, 8.0, 0], 8.0), ([0, 0, 8.0], 4.0), ([0.5, 3, 2], 3.0)],
)
def test_units_are_powers_of_two_near_the_size_of_a_segment_s_flows(h, size):
    """The size of an area is that of its sides."""
    (found,) = measured(h)[1]
    mean = np.sqrt(0.5 * 1.0)
    expected = np.array([0.5, 1.0]) / mean * 2 ** np.rint(np.log2(mean * size))
    assert np.abs(found) == pytest.approx(expected)


def test_generators_of_one_length_have_equal_units():
    # each differs from their mean by half as much as they from one another
    for drive, equal in ((0.5, True), (0.5 * (1 + 1.9 * EQUAL), True),
                         (0.5 * (1 + 2.1 * EQUAL), False)):  # fmt: skip
        (found,) = measured([1.0, 1, 1], drive=drive)[1]
        assert (abs(found[0]) == abs(found[1])) == equal


def test_no_motion_has_units_as_well():
    h, scales = measured([0.0, 0.0, 0.0])
    assert not h.any()
    assert (scales != 0).all()


@pytest.mark.parametrize("ratio", [0.01, 0.2, 1.0, 3.0, 50.0])
def test_rectangles_are_shaped_where_both_halves_of_the_error_are_parallel(ratio):
    rect = car()
    first = np.array([0.6, 0.8, 0.0])
    for second, parallel in ((ratio * first, True), (-ratio * first, True),
                             (ratio * np.array([0.8, -0.6, 0]), False),
                             (0 * first, False)):  # fmt: skip
        (found,) = rect._sides(np.stack([first, second], axis=-1)[None])
        shape = np.clip(ratio, 1 / LONGEST_SHAPE, LONGEST_SHAPE) if parallel else 1.0
        assert found == pytest.approx([np.sqrt(shape), 1 / np.sqrt(shape)])


def test_more_than_one_pair_has_no_shape_of_its_own():
    fields = {"f": [1, 0, "-y", "-z"], "g": [0, 1, "x", 0], "k": [0, 0, 0, "x"]}
    system = StratifiedSystem("x y z w", {"0": fields}, "0")
    rect = rectangles(system, hall_fields(system, ("f", "g", "k"), 2))
    assert rect.hall.only_pair is None
    assert rect._sides(np.ones((2, 4, 5))).tolist() == np.ones((2, 3)).tolist()


@pytest.mark.parametrize(
    ("h", "units"), [([0.1, 0.2, 0.3], [0.5, 2.0]), ([0.1, 0.0, -0.4], [-1.0, 3.0])]
)
def test_the_way_that_is_turned_has_the_least_error(h, units):
    """The printed one is kept unless another has less than half of its error."""
    rect = car(2.0, 0.7)
    h, at = np.array([h]), AT[:1]
    units = np.array([units])
    scales = rect.scales(h, at, units)
    fields = rect.fields.values(at) * rect.units.weights[:, None]
    own, beyond = fields[..., :3], fields[..., 3:]
    sides = units * rect._sides(beyond * weights(rect._beyond, units)[:, None])
    factors = weights(rect.hall.elements, sides)
    further = beyond * weights(rect._beyond, sides)[:, None]
    errors = rect._errors(h / factors, own * factors[:, None], further)[:, 0]
    best = 0 if errors[0] / 2 <= errors.min() * (1 + 1e-9) else errors.argmin()
    assert scales == pytest.approx(sides * rect._signs[best])


def test_without_brackets_or_where_fields_are_singular_units_stay_as_they_are():
    rect, units = car(), np.array([[2.0, 3.0]])
    assert rect.scales(np.array([[0.1, 0.2, 0.0]]), AT[:1], units) is units
    singular = made(["1/x", 0, 1], [0, "1", 0])
    at = np.zeros((1, 3))
    assert singular.scales(np.array([[0.1, 0.2, 0.3]]), at, units) is units
    deep = made(["cos(a)", "sin(a)", 0], [0, 0, 1], top=3)
    assert deep.fields is None
    assert deep.scales(np.ones((1, 5)), at, units) is units


def test_errors_are_what_brackets_beyond_miss_of_the_motion():
    """A corner's word has half of [X,[X,Y]] and of [Y,[X,Y]], with signs of its own."""
    rect = car()
    h = np.array([[0.3, 0.1, 0.09]])
    rng = np.random.default_rng(3)
    own, beyond = rng.normal(size=(1, 3, 3)), rng.normal(size=(1, 3, 2))
    errors = rect._errors(h, own, beyond)
    assert errors.shape == (len(rect._signs), 1)
    size = np.sqrt(0.09)
    moved = np.abs(own[0] * [size, size, size**2]).max(axis=1)
    for (_, sign), error in zip(rect._signs, errors[:, 0], strict=True):
        parts = [0.5 * size**3 * beyond[0, :, 0], 0.5 * size**3 * beyond[0, :, 1]]
        either = {
            round(float(np.linalg.norm((parts[0] + s * parts[1]) / moved)), 9)
            for s in (1, -1)
        }
        assert round(float(error), 9) in either
        assert sign in (1, -1)
    assert len({round(float(e), 9) for e in errors[:, 0]}) == 2


def test_signs_are_those_of_all_but_the_first_the_printed_ones_first():
    assert sign_choices(3, (2, 3)).tolist() == [
        [1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1],
    ]  # fmt: skip
    rect = car()
    assert rect._signs.tolist() == [[1, 1], [1, -1]]
