"""Classes, groups and shares of a study, on tables that are written by hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sim.errors import UsageError
from sim.palette import OUTCOMES
from sim.studies.maps import (
    CELL,
    EXTREMES,
    MOST_LABELS,
    _draw_curve,
    _is_table,
    _label,
    _labels,
    _named,
    _place,
    _points,
    _shades,
    figures,
    page,
)
from sim.studies.results import (
    ROUND,
    Explained,
    Findings,
    Results,
    _left,
    _require,
    explained,
    findings,
    group,
)
from sim.studies.sensitivities import SHARE, changes_of


def results(shares, **columns):
    """Walks of a path of 2 m that came off by shares of it; None was no walk."""
    count = len(shares)
    table = {
        "point": list(range(count)),
        "status": ["no way" if s is None else "ok" for s in shares],
        "error.ideal.farthest": [None if s is None else 2.0 * s for s in shares],
        "path_length": [None if s is None else 2.0 for s in shares],
        "distance_walked": [None if s is None else 9.0 for s in shares],
        "verdict": [None if s is None else "arrived" for s in shares],
        "a": [float(k) for k in range(count)],
        **columns,
    }
    return Results(
        table, tuple(k for k in ("a", "b") if k in table), "ideal", judge="ideal"
    )


def test_points_are_within_limits_up_to_and_including_them():
    found = results([0.0, 0.01, 0.0101, 0.03, 0.0301, 0.1, 0.1001, None])
    assert found.classes.tolist() == [0, 0, 1, 1, 2, 2, 3, 5]
    assert found.counts == {
        "within 1 %": 2, "within 3 %": 2, "within 10 %": 2,
        "beyond": 1, "fell": 0, "no walk": 1,
    }  # fmt: skip
    assert found.walked.tolist() == [True] * 7 + [False]
    assert len(found) == 8


def test_a_robot_that_fell_is_in_a_class_of_its_own_however_near_it_was():
    words = ["arrived", "fell", "missed"]
    found = results([0.001, 0.001, 0.2], verdict=words)
    assert found.classes.tolist() == [0, 4, 3]
    none = results([0.001])
    del none.columns["verdict"]
    assert none.classes.tolist() == [0]


def test_a_path_without_length_is_weighed_by_the_way_that_was_walked():
    found = results([0.1, 0.1], path_length=[0.0, 2.0], distance_walked=[4.0, 4.0])
    assert found.off == pytest.approx([0.05, 0.1])
    assert found.classes.tolist() == [2, 2]


def test_fitted_limits_are_round_and_just_above_thirds():
    rng = np.random.default_rng(0)
    shares = sorted(np.exp(rng.normal(-5, 1, 301)).tolist())
    limits = results(shares).fitted().limits
    thirds = np.quantile(shares, [1 / 3, 2 / 3, 1.0])
    for limit, third in zip(limits, thirds, strict=True):
        assert limit in ROUND
        assert third <= limit
        below = ROUND[limit * (1 - 1e-12) > ROUND][-1]
        assert below < third
    even = results([0.01] * 9).fitted().limits
    assert even == pytest.approx((0.01, 0.012, 0.015))
    assert results([None]).fitted().limits == (0.01, 0.03, 0.10)
    vast = results([1e9] * 3).fitted().limits
    assert vast == pytest.approx(tuple(ROUND[-3:]))
    fell = results([0.5, 0.001, 0.001], verdict=["fell", "arrived", "arrived"])
    assert max(fell.fitted().limits) < 0.01


def test_a_column_that_is_not_there_is_named():
    with pytest.raises(UsageError, match="no column 'patth_length'.*the table"):
        results([0.1]).column("patth_length")
    found = results([0.1, None]).column("path_length")
    assert found[0] == 2.0
    assert np.isnan(found[1])


@pytest.mark.parametrize(
    ("value", "fine"),
    [
        (0.0, True),
        (-1e-9, False),
        (1e12, True),
        (1.01e12, False),
        (True, False),
        ("x", False),
    ],
)
def test_numbers_of_a_table_are_from_0_to_a_million_million(value, fine):
    if fine:
        _require("c", [1.0, value], "numbers from 0", int, float)
        return
    with pytest.raises(UsageError, match="row 1 of column 'c'"):
        _require("c", [1.0, value], "numbers from 0", int, float)


@pytest.mark.parametrize(
    ("count", "groups"),
    [(12, 12), (13, 4), (60, 5), (61, 5), (72, 6), (288, 24), (600, 24)],
)
def test_more_than_a_dozen_values_are_in_groups_of_a_dozen_points(count, groups):
    found = group([float(k) for k in range(count)][::-1])
    assert len(set(found.tolist())) == groups
    assert (np.diff(found) <= 0).all()  # in their order
    sizes = np.bincount(found)
    assert sizes.max() - sizes.min() <= 1
    assert (
        len(set(group([float(k) for k in range(count)], separate=True).tolist()))
        == count
    )


def test_equal_values_are_one_group_whatever_their_type():
    assert group([2, 1.0, 2.0, 1]).tolist() == [1, 0, 1, 0]
    assert len(set(group([True, 1, "1"]).tolist())) == 3


def test_shares_are_the_variance_of_means_over_the_whole_one():
    values = [0.0] * 3 + [1.0] * 3 + [2.0] * 2
    y = np.array([1.0, 2.0, 3.0, 5.0, 5.0, 8.0, 1.0, 2.0])
    groups = [y[:3], y[3:6], y[6:]]
    within = sum(((g - g.mean()) ** 2).sum() for g in groups)
    total = ((y - y.mean()) ** 2).sum()
    assert explained(values, y, exact=True) == pytest.approx(1 - within / total)
    chance = (8 - 1) / (8 - 3)  # of as many means from as many points
    assert explained(values, y, exact=False) == pytest.approx(
        1 - chance * within / total
    )
    holes = np.append(y, np.nan)
    assert explained([*values, 7.0], holes, exact=True) == pytest.approx(
        1 - within / total
    )


@pytest.mark.parametrize(
    ("values", "y"),
    [
        ([1.0, 1.0, 1.0], [1.0, 2.0, 3.0]),  # one group
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),  # as many groups as points
        ([1.0, 1.0, 2.0], [4.0, 4.0, 4.0]),  # nothing differs
    ],
)
def test_where_nothing_can_be_explained_nothing_is_said(values, y):
    assert explained(values, np.array(y), exact=True) is None


@pytest.mark.parametrize(
    ("shares", "left"),
    [
        ([0.5, 0.2], 0.3), ([0.7, 0.5], 0.0), ([0.5, None], None),
        ([0.5], None), ([], None),
        ([0.1, 0.2, 0.3], 0.4),
    ],
)  # fmt: skip
def test_what_is_left_of_a_whole_is_known_if_all_shares_are(shares, left):
    assert _left(shares) == (None if left is None else pytest.approx(left))


def grid(lost=()):
    """Four by three points, whose order of magnitude is a sum of both settings."""
    a, b = (m.ravel().tolist() for m in np.meshgrid(range(4), range(3)))
    shares = [None if k in lost else 10.0 ** (-4 + 0.5 * x + 0.1 * y)
              for k, (x, y) in enumerate(zip(a, b, strict=True))]  # fmt: skip
    return results(shares, a=[float(x) for x in a], b=[float(y) for y in b])


def test_a_full_grid_of_sums_leaves_nothing_to_several_together():
    found = findings(grid())
    parts = {k: one.departure for k, one in found.explained.items()}
    variance = {"a": 0.25 * np.var(range(4)), "b": 0.01 * np.var(range(3))}
    whole = sum(variance.values())
    assert parts == {k: pytest.approx(v / whole) for k, v in variance.items()}
    assert found.together.departure == pytest.approx(0.0, abs=1e-9)
    assert "exact for this full grid of 12 points" in found.method
    assert [key for key, _ in found.ranked][:2] == ["a", "b"]
    assert found.verdicts == {"arrived": 12}
    assert (found.points, found.judge) == (12, "")


def test_a_grid_with_lost_points_is_exact_for_losses_and_estimated_for_the_rest():
    found = findings(grid(lost=(0, 4, 8)))
    assert "estimated from 9 points" in found.method
    assert found.together.departure is None
    assert found.explained["a"].falls == pytest.approx(1.0)
    assert found.explained["b"].falls == pytest.approx(0.0)
    assert found.together.falls == pytest.approx(0.0)
    assert found.reasons == {"no way": 3}
    twice = grid()
    doubled = replace(twice, columns={k: v * 2 for k, v in twice.columns.items()})
    assert "estimated" in findings(doubled).method


def test_reasons_are_the_five_most_frequent_without_their_numbers():
    status = [*["bad 1.5 mm", "bad 2e-3 mm"], *["c"] * 3, *"defgh"]
    found = findings(results([None] * 10, status=status))
    assert list(found.reasons)[:2] == ["c", "bad ... mm"]
    assert found.reasons["bad ... mm"] == 2
    assert len(found.reasons) == 5


def test_a_single_setting_is_not_divided_and_zero_is_rounding():
    found = findings(results([0.0, 1e-12, 1e-9, 0.1], a=[0.0, 0.0, 1.0, 1.0]))
    assert "only one setting varies" in found.method
    y = np.log10([1e-9, 1e-9, 1e-9, 0.1])
    best = explained([0.0, 0.0, 1.0, 1.0], y, exact=False)
    assert found.explained["a"].departure == pytest.approx(best)
    other = replace(results([0.1, 0.2]), judge="compliant")
    assert findings(other).judge == "compliant"


def test_settings_are_ranked_by_what_they_explain_and_several_come_last():
    parts = {
        "a": Explained(None, None),
        "b": Explained(0.2, 0.9),
        "c": Explained(0.5, 0.0),
    }
    made = Findings(1, "ideal", {}, parts, {}, {}, "", Explained(None, 0.1), "")
    assert [key for key, _ in made.ranked] == ["c", "b", "a", "several together"]
    alone = Findings(1, "ideal", {}, parts, {}, {}, "", Explained(None, None), "")
    assert [key for key, _ in alone.ranked] == ["c", "b", "a"]


def test_the_page_has_the_five_worst_and_the_five_best(tmp_path):
    shares = [0.001 * (k + 1) for k in range(11)]
    some = results(shares)
    html = page(some, findings(some), tmp_path / "t.parquet", tmp_path)
    assert "11 points" in html
    shown = [f"{0.1 * (k + 1):.3g} %" in html for k in range(11)]
    assert shown == [k != 5 for k in range(11)]
    few = results(shares[: 2 * EXTREMES])
    table = page(few, findings(few), tmp_path / "t.parquet", tmp_path)
    assert "0.6 %" in table
    assert "a varies" in table


def test_points_have_the_command_that_walks_them_or_their_report(tmp_path):
    asked = {"set": {"friction": 0.5}, "scenario": {"name": "my line"}}
    some = replace(results([0.0123456, 0.2]), asked=asked)
    rows = _points(some, [1, 0], tmp_path, "there").rows
    number, off, word, value, command = rows[1]
    assert (number, off, word, value) == ("0", "1.23 %", "arrived", "0.0")
    assert "stratawalk run" in str(command)
    assert "my line" in str(command)
    assert "friction=0.5" in str(command)
    assert "a=0.0" in str(command)
    assert rows[0][0] == "1"


@pytest.fixture
def axes():
    from matplotlib.figure import Figure

    return Figure().add_subplot()


def test_few_values_and_words_have_places_side_by_side(axes):
    columns = {"w": ["up", "down", "up"], "n": [float(k) for k in range(13)]}
    some = SimpleNamespace(columns=columns)
    assert _place(axes, some, "w", "x") == [0.0, 1.0, 0.0]
    assert axes.get_xlim() == (-0.5, 1.5)
    assert _place(axes, some, "n", "y") == columns["n"]
    assert _is_table(columns["n"][:12])
    assert not _is_table(columns["n"])
    assert _is_table([True, False])
    assert _labels([3, 1.0, 2.0]) == ["1", "2", "3"]
    assert _labels([0.123456, 0.1]) == ["0.1", "0.123"]
    assert _label(0.00012345) == "0.000123"


@pytest.mark.parametrize("count", [MOST_LABELS, MOST_LABELS + 1])
def test_an_axis_has_two_hundred_words_at_most(axes, count):
    some = SimpleNamespace(columns={"w": [f"word {k}" for k in range(count)]})
    if count > 200:
        with pytest.raises(
            UsageError, match="201 values of w: the table; vary 200 words"
        ):
            _place(axes, some, "w", "x")
    else:
        assert len(_place(axes, some, "w", "x")) == 200


def test_settings_at_axes_have_their_units():
    assert _named("geometry.body_mass") == "geometry.body_mass [kg]"
    assert _named("geometry.kappa") == "geometry.kappa"
    assert _named("geometry.thigh") == "geometry.thigh [m]"
    assert _named("friction") == "friction"
    assert _named("payload").startswith("payload")
    assert _named("swing_speed") == "swing_speed [rad/s]"


def test_classes_of_one_hue_darken_with_the_distance():
    some = replace(results([0.1]), limits=(0.001, 0.002, 0.02))
    shades = _shades(some)
    assert len(shades) == 6
    assert shades[0] == OUTCOMES[0].tint(2 / 3)
    assert shades[1] == OUTCOMES[0].tint(1.0)
    assert shades[2] == OUTCOMES[1].tint(1.0)
    assert tuple(shades[3:]) == OUTCOMES[3:]


def test_a_map_has_a_square_for_each_place_with_the_worst_of_its_points(axes):
    from matplotlib.patches import Rectangle

    some = results(
        [0.005, 0.02, 0.3, None], a=[0.0, 0.0, 1.0, 1.0], b=[0.0, 0.0, 1.0, 1.0]
    )
    ((keys, figure),) = figures(some)
    assert keys == ("a", "b")
    (drawn,) = figure.axes
    squares = [p for p in drawn.patches if isinstance(p, Rectangle)]
    places = sorted(
        (round(p.get_x() + CELL / 2, 6), round(p.get_y() + CELL / 2, 6))
        for p in squares
    )
    assert places == [(0, 0), (1, 1)]
    assert {p.get_width() for p in squares} == {CELL}
    texts = {t.get_text() for t in drawn.texts}
    assert texts == {"2.0", "1 of 2:\nno walk"}
    assert "the worst at each place" in drawn.get_title("left")
    labels = {t.get_text() for t in figure.legends[0].get_texts()}
    assert labels == {"within 1 %: 1", "within 3 %: 1", "beyond: 1", "no walk: 1"}


def test_a_curve_has_all_points_in_per_cent_and_what_is_rounding_at_its_foot(axes):
    some = results([0.0, 0.02, None])
    _draw_curve(axes, some, "a")
    offsets = axes.collections[0].get_offsets()
    assert np.array(offsets[:, 1]) == pytest.approx([1e-4, 2.0, 100.0])
    lines = [line.get_ydata()[0] for line in axes.lines]
    assert lines == pytest.approx([1.0, 3.0, 10.0])
    assert axes.get_yscale() == "log"


def test_changes_are_a_quarter_of_their_unit():
    """Zeros, lengths, payload, centre of mass, slope, friction and stiffness."""
    from sim.compliant.prediction import phases_of
    from sim.preparation.setup import prepare
    from sim.scenarios.file import load_scenario

    setup = prepare(load_scenario("line"))
    phases = phases_of(setup)
    own = phases.robots
    found = {c.what: c for c in changes_of(phases, setup.robot.legs)}
    legs = len(setup.robot.legs)
    assert len(found) == 3 * legs + 1 + 2 + 2 + 2
    assert SHARE == 0.25
    quarter = np.radians(0.25)
    zero = found["zero of joint 2 of leg 3"].robot.offset - own.offset
    place = setup.robot.legs.index(3)
    assert zero[0, place, 1] == pytest.approx(quarter)
    assert np.count_nonzero(zero) == 1
    longer = found["length of leg 4"].robot.radius - own.radius
    assert longer[0, setup.robot.legs.index(4)] == pytest.approx(0.25e-3)
    assert np.count_nonzero(longer) == longer.shape[2]
    laden = found["payload in the body's middle"].robot
    assert laden.weight - own.weight == pytest.approx([0.25])
    assert laden.mass - own.mass == pytest.approx(laden.body_mass - own.body_mass)
    moment = laden.body_mass[:, None] * laden.body_center
    assert moment == pytest.approx(own.body_mass[:, None] * own.body_center)
    for axis, way in enumerate(("ahead", "to the left")):
        moved = found[f"centre of mass {way}"].robot
        shift = (
            (moved.body_center - own.body_center)[0] * own.body_mass[0] / own.mass[0]
        )
        assert shift == pytest.approx(0.25e-3 * np.eye(3)[axis])
        leaning = found[f"floor that leans down {way}"].robot.gravity[0]
        assert leaning[axis] / -leaning[2] == pytest.approx(quarter, rel=1e-4)
        assert leaning[1 - axis] == pytest.approx(own.gravity[0, 1 - axis])
    assert found["friction"].robot.friction - own.friction == pytest.approx(
        np.full_like(own.friction, 0.025)
    )
    stiff = found["stiffness of all servos"].robot.stiffness / own.stiffness
    assert stiff == pytest.approx(np.full_like(stiff, 1.025))
