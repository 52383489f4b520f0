"""Stratified systems as data: the graph of strata, gaits, and what is refused."""

import copy
import pickle
from itertools import product

import numpy as np
import pytest
import sympy as sp

from planner.errors import BudgetError, StratumError
from planner.support import limited
from planner.systems.fields import NumericField
from planner.systems.flows import Gait
from planner.systems.level_sets import LevelSet
from planner.systems.strata import StratifiedSystem
from tests.systems import GAIT, hexapod

X, Y, H1, H2 = sp.symbols("x y h1 h2")
FOUR_FEET = ("1234", "234", "134", "124", "123")


def system(**changes):
    given = {"state": "x y", "strata": {"1": {"g": [1, 0]}}, "bottom": "1"} | changes
    return StratifiedSystem(**given)


def test_fields_are_numbered_in_order_of_declaration():
    assert list(hexapod().fields) == ["g12_1", "g12_2", "g1_1", "g1_2", "g2_1", "g2_2"]


def test_graph_of_two_feet_is_that_of_figure_2():
    fields = {f"g{s}": [1, 0] for s in ("12", "1", "2", "0")}
    strata = {name[1:]: {name: column} for name, column in fields.items()}
    biped = system(strata=strata, bottom="12")
    assert set(biped.edges) == {("12", "1"), ("12", "2"), ("1", "0"), ("2", "0")}


def test_graph_of_four_feet_lifted_one_at_a_time_has_the_bottom_in_its_middle():
    strata = {s: {f"g{s}": [1, 0]} for s in FOUR_FEET}
    crawl = system(strata=strata, bottom="1234")
    assert set(crawl.edges) == {("1234", high) for high in FOUR_FEET[1:]}
    assert crawl.switches("234", "123") == 2


def test_level_sets_say_which_strata_are_nested_whatever_the_names():
    strata = {"all": {"a": [1, 0, 0, 0]}, "left": {"b": [1, 0, 0, 0]}}
    named = StratifiedSystem(
        (X, Y, H1, H2), strata, "all", {"all": [H1, H2], "left": [H1]}
    )
    assert named.edges == (("all", "left"),)
    assert named.bottom_dimension == 2


def test_ways_between_strata_have_the_fewest_contact_switches_of_all():
    names = ("1234", "1", "2", "0", "23", "13")
    sparse = system(strata={s: {f"g{s}": [1, 0]} for s in names}, bottom="1234")
    assert sparse.switches("1", "1") == 0
    assert sparse.switches("1", "2") == 2  # by S0
    assert sparse.switches("1", "1234") == 3  # by S13
    assert sparse.switches("1", "23") == 3  # by S0 and S2, where S13 would cost five
    # so that no detour by another stratum saves any
    for a, b, c in product(names, repeat=3):
        through = sparse.switches(a, b) + sparse.switches(b, c)
        assert sparse.switches(a, c) <= through


def test_a_graph_of_many_strata_is_left_when_the_time_is_over():
    names = [chr(0x4E00 + n) for n in range(300)]
    many = system(strata={s: {f"g{s}": [1, 0]} for s in names}, bottom=names[0])
    with pytest.raises(BudgetError), limited(0.0):
        many.switches(*names[:2])


def test_level_set_finds_points_on_a_curved_stratum():
    circle = LevelSet((X**2 + Y**2 - 1,), (X, Y))
    assert np.abs(circle.value(circle.points)).max() < 1e-12
    assert circle.leaves(sp.ImmutableMatrix([X, Y]))
    assert not circle.leaves(sp.ImmutableMatrix([-Y, X]))
    assert circle.leaves(NumericField(lambda x: x))
    assert not circle.leaves(NumericField(lambda x: [-x[1], x[0]]))


def test_rates_are_one_row_where_formulas_show_that_all_vanish():
    plane = LevelSet((X,), (X, Y))
    assert plane.rates(sp.ImmutableMatrix([0, Y])).tolist() == [[0.0]]
    assert plane.rates(sp.ImmutableMatrix([1, Y])).shape == (len(plane.points), 1)


def test_field_may_be_tangent_on_its_curved_stratum_alone():
    # off the circle the field leaves the circles around it, too
    field = [-Y + (X**2 + Y**2 - 1) * X, X]
    on_circle = StratifiedSystem(
        (X, Y), {"1": {"g": field}}, "1", {"1": X**2 + Y**2 - 1}
    )
    assert on_circle.bottom_dimension == 1


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"state": ""}, "state is empty"),
        ({"state": "x x"}, "state names x twice"),
        ({"state": ("x", "2y")}, "state has 2y, which is not a name"),
        ({"strata": {}}, "strata hold no fields"),
        ({"bottom": "2"}, r"bottom '2' is unknown; there is only 1"),
        (
            {"strata": {"1": {"g": [1]}}},
            r"g of S1 has shape \(1, 1\), expected \(2, 1\)",
        ),
        (
            {"strata": {"1": {"g": [1, sp.Symbol("z")]}}},
            r"uses z, .* not in the state \(x, y\)",
        ),
        (
            {"strata": {"1": {"g": [1, sp.nan]}}},
            "field g of S1 has nan, no real number",
        ),
        ({"strata": {"1": {"g": ["1e308**1e308", 0]}}}, r"has 1e\+308, no real"),
        ({"strata": {"1": {"g": ["(-1)**x", 0]}}}, r"has \(-1\)\*\*x, no real number"),
        ({"strata": {"1": {"g 1": [1, 0]}}}, "field name 'g 1' of S1: use letters"),
        (
            {"strata": {"1": {"g": [1, 0]}, "2": {"g": [1, 0]}}},
            "field g is in S1 and S2; rename one",
        ),
        ({"strata": {"1": {"g": ["9**x", "__import__('os')"]}}}, "g of S1: formula"),
        ({"strata": {"1": {"g": [[1], [1, 2]]}}}, "field g of S1: SympifyError"),
        (
            {"strata": {"1": {"g": [1, 0]}, "10": {}}},
            "stratum '10' has a contact for each character of its name, 0 for none; na",
        ),
        ({"strata": {"1": {"g": [1, 0]}, "1213": {}}}, "stratum '1213' has a contact"),
        (
            {"strata": {"1": {}, "12": {"g": [1, 0]}, "21": {}}},
            "strata S12 and S21 have the same contacts; make them one",
        ),
        (
            {"strata": {"1": {}, "2": {"g": [1, 0]}}, "level_sets": {"1": [], "2": []}},
            "strata S1 and S2 have the same contacts",
        ),
        ({"strata": {"1": {"g": 1}}}, r"field g of S1 has shape \(1, 1\)"),
        ({"state": "x sin"}, "state has sin, which formulas use; rename it"),
        (
            {"level_sets": {"1": ["__import__('os')"]}},
            "set of S1: formula .* neither",
        ),
        (
            {"level_sets": {"1": ["sqrt(-2) + y"]}},
            "level set of S1: 'sqrt.-2.' has nan",
        ),
        ({"level_sets": {"2": [X]}}, "level set of stratum '2', which is unknown"),
        ({"level_sets": {"1": [sp.Symbol("z")]}}, "level set of S1 uses z"),
        (
            {"level_sets": {"1": [Y, 2 * Y]}},
            r"S1 are not independent: y, 2\*y \(Def. 1\)",
        ),
        ({"level_sets": {"1": [X]}}, "field g leaves its stratum S1: it changes x at"),
        *(
            ({"level_sets": {"1": [flat]}}, r"are not independent where .* \(Def. 1\)")
            for flat in (Y**2, Y**3, (Y - X**2) ** 2)
        ),
        ({"level_sets": {"1": [sp.Abs(Y)]}}, r"Abs\(y\), has no derivative \(Def. 1\)"),
        (
            {"level_sets": {"1": [X**2 + 1]}},
            r"no configuration where x\*\*2 \+ 1 vanish",
        ),
    ],
)
def test_unsound_systems_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        system(**changes)


def test_nearest_stratum_is_offered():
    with pytest.raises(StratumError, match=r"'0012' is unknown; did you mean '12'\?"):
        hexapod().switches("0012", "1")


def test_strata_that_no_chain_joins_are_named():
    strata = {s: {f"g{s}": [1, 0]} for s in ("1", "2")}
    apart = system(strata=strata)
    with pytest.raises(StratumError, match="no chain of nested strata joins S1 to S2"):
        apart.switches("1", "2")


def test_tripod_gait_is_a_closed_walk():
    assert str(Gait(hexapod(), GAIT)) == "S12 -> S1 -> S12 -> S2 -> S12"


@pytest.mark.parametrize(
    ("walk", "reason"),
    [
        ((), "visits 1 to 1000 strata"),
        (("12", "3", "12"), r"stratum '3' of gait S12 -> S3 -> S12 is unknown"),
        (("12", "1"), "does not close: it starts in S12 and ends in S1"),
        (("1", "2", "1"), "steps from S1 to S2, which are not neighbours.*of S1: S12"),
    ],
)
def test_walks_that_are_no_gaits_are_refused_with_the_reason(walk, reason):
    with pytest.raises(StratumError, match=reason):
        Gait(hexapod(), walk)


def test_wrong_jacobian_of_a_numeric_field_is_refused():
    wrong = NumericField(lambda x: [x[0] ** 2, 0], lambda x: [[x[0], 0], [0, 0]])
    with pytest.raises(
        ValueError, match="g of S1 has a derivative of .* differences give"
    ):
        system(strata={"1": {"g": wrong}})


def test_numeric_field_with_a_jump_is_refused():
    def jump(x):
        return [np.sign(np.sin(300 * x[0])), 0]

    with pytest.raises(ValueError, match="correct its jacobian or make it smooth"):
        system(strata={"1": {"g": jump}})


def test_rates_count_however_small_and_rounding_does_not():
    x, h = sp.symbols("x h")
    heights = {"1": [h]}
    with pytest.raises(ValueError, match="field a leaves its stratum S1"):
        StratifiedSystem((x, h), {"1": {"a": [1, 1e-12]}}, "1", heights)
    level = LevelSet((1e-6 * h,), (x, h))
    assert level.leaves(sp.ImmutableMatrix([0, 1e-9]))
    assert not level.leaves(sp.ImmutableMatrix([1, 1e9 * h * sp.exp(x)]))
    assert not level.leaves(
        sp.ImmutableMatrix([0, sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1])
    )


def test_functions_that_vanish_nowhere_together_have_no_level_set():
    x, h = sp.symbols("x h")
    with pytest.raises(ValueError, match=r"found no configuration where h\*\*2 \+ 1"):
        _ = LevelSet((h**2 + 1,), (x, h)).points


def test_fields_cannot_be_exchanged_behind_a_system_s_back():
    system = hexapod()
    with pytest.raises(TypeError, match="does not support item assignment"):
        system.strata["1"]["g1_1"] = system.strata["1"]["g1_2"]
    with pytest.raises(AttributeError):
        system.strata.clear()


@pytest.mark.parametrize(
    "again", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))]
)
def test_systems_are_copied_and_sent_whole(again):
    one = hexapod()
    one.compiled("g1_1")  # functions that no process could send
    other = again(one)
    assert other.state == one.state
    assert other.strata == one.strata
    assert (other.bottom, other.metric, other.lifts) == (
        one.bottom, one.metric, one.lifts,
    )  # fmt: skip
    assert other.level_sets == one.level_sets


def test_an_unknown_field_is_said_with_those_that_there_are():
    with pytest.raises(ValueError, match="field g3 is unknown; .*g12_1"):
        hexapod().fields["g3"]
