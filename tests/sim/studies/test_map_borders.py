"""Maps and pages of studies, and the changes whose effects are asked for."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sim.errors import UsageError
from sim.palette import OUTCOMES
from sim.scenarios.file import scenario_table
from sim.studies import sensitivities as library
from sim.studies.findings import findings
from sim.studies.maps import (
    _draw_curve,
    _is_table,
    _labels,
    _named,
    _place,
    _points,
    _shades,
    figures,
    page,
)
from sim.studies.sensitivities import SHARE, changes_of
from tests.studies import results

CELL = 0.92  # of the way from one place to the next
EXTREMES = 5  # points among the best, and among the worst
MOST_LABELS = 200  # at an axis


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
    own = scenario_table("line")[0] | {"swing_speed": 0.25}
    asked = {"set": {"friction": 0.5}, "scenario": own}
    some = replace(results([0.0123456, 0.2]), asked=asked)
    shown = _points(some, [1, 0], tmp_path, "there")
    assert "(SCENARIO.toml: asked.scenario of sweep.json)" in shown.header[-1]
    rows = shown.rows
    number, off, word, value, command = rows[1]
    assert (number, off, word, value) == ("0", "1.23 %", "arrived", "0.0")
    assert "stratawalk run SCENARIO.toml" in str(command)  # not the shipped line
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
    assert _labels([3, 1.0, 2.0]) == {1.0: "1", 2.0: "2", 3: "3"}
    assert _labels([0.123456, 0.1]) == {0.1: "0.1", 0.123456: "0.123"}
    assert _labels([0.00012345]) == {0.00012345: "0.000123"}


def test_values_that_differ_have_places_and_labels_of_their_own(axes):
    close = [0.1001, 0.1002, 0.1003, 0.5, 0.1001]
    assert [*_labels(close).values()] == ["0.1001", "0.1002", "0.1003", "0.5"]
    assert _labels([0.1, next := np.nextafter(0.1, 1.0).item()])[next] != "0.1"
    some = SimpleNamespace(columns={"n": close})
    assert _place(axes, some, "n", "x") == [0.0, 1.0, 2.0, 3.0, 0.0]


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


@pytest.mark.parametrize("side", [16, 17])
def test_squares_have_numbers_while_these_can_be_read(axes, side):
    places = [(a, b) for a in range(side) for b in range(side)]
    a, b = ([f"word {k}" for k in along] for along in zip(*places, strict=True))
    ((_, figure),) = figures(results([0.005] * side**2, a=a, b=b))
    (drawn,) = figure.axes
    assert len(drawn.texts) == len(drawn.patches) == (side**2 if side == 16 else 0)
    (points,) = drawn.collections or [()]
    assert len(points and points.get_offsets()) == (0 if side == 16 else side**2)


@pytest.mark.parametrize(("count", "read"), [(39, 39), (40, 20), (200, 34)])
def test_labels_at_an_axis_are_as_many_as_are_read(axes, count, read):
    words = [f"word {k:03}" for k in range(count)]
    _place(axes, SimpleNamespace(columns={"w": words}), "w", "x")
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert labels == words[:: -(-count // read)]


@pytest.mark.parametrize(
    ("count", "letters", "turned"), [(7, 10, 0), (4, 18, 90), (2, 35, 90)]
)
def test_labels_that_would_touch_are_turned(axes, count, letters, turned):
    words = [f"{k}".ljust(letters, "x") for k in range(count)]
    _place(axes, SimpleNamespace(columns={"w": words}), "w", "x")
    assert axes.get_xticklabels()[0].get_rotation() == turned


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

    heavy = replace(own, body_mass=3 * own.body_mass, mass=own.mass + 2 * own.body_mass)
    given = SimpleNamespace(robots=heavy, mechanics=phases.mechanics)
    changed = {c.what: c.robot for c in changes_of(given, setup.robot.legs)}
    ahead = changed["centre of mass ahead"].body_center - heavy.body_center
    carried = ahead * heavy.body_mass / heavy.mass  # of the whole robot
    assert carried[0] == pytest.approx([0.25e-3, 0, 0])


def test_the_effects_on_a_run_are_those_at_its_last_moment(monkeypatch):
    asked = []
    run = SimpleNamespace(time=np.array([0.0, 1.0, 2.5]), legs=(1, 2))
    monkeypatch.setattr(library, "course_of_run", lambda *_: ("phases", "course"))
    monkeypatch.setattr(library, "changes_of", lambda *given: given)
    monkeypatch.setattr(library, "sensitivities", lambda *given: asked.append(given))
    library.sensitivities_of(run)
    ((phases, course, changes, times),) = asked
    assert (phases, course, changes) == ("phases", "course", ["phases", (1, 2)])
    assert times.tolist() == [2.5]
