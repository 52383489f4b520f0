"""Scenarios: what is read, what is refused, and that text reads back the same."""

import math
import tomllib

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad

from sim.errors import UsageError
from sim.scenarios import body_path as nominal
from sim.scenarios.file import (
    dumps,
    load_scenario,
    parse_override,
    shipped_scenarios,
    to_table,
)
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS

SMALLEST = 'segments = 3\n[path]\nkind = "line"\ngoal = [0.1, 0.0, 0.0]\n'


@pytest.fixture
def file(tmp_path):
    def write(text, name="mine.toml"):
        path = tmp_path / name
        path.write_text(text)
        return str(path)

    return write


def walking(**changes):
    return Scenario(
        name="walk", segments=2, path=nominal.line([0.1, 0.1, 0.0]), **changes
    )


def test_shipped_scenarios_end_where_the_paper_goes():
    goals = {name: load_scenario(name).path.goal for name in shipped_scenarios()}
    assert goals == {
        "line": (0.15, 0.15, 0.0),
        "ellipse": (0.0, 0.0, 0.0),
        "diagonal": (0.15, 0.15, math.pi / 2),
        "corridor": (0.35, 0.35, math.pi / 2),
        "detour": (0.9, 0.0, 0.0),
    }


@pytest.mark.parametrize("name", shipped_scenarios())
def test_shipped_scenarios_start_at_the_origin_and_end_at_their_goal(name):
    path = load_scenario(name).path
    assert path(0.0) == pytest.approx((0, 0, 0), abs=1e-15)
    assert path(1.0) == pytest.approx(path.goal, abs=1e-15)


@given(st.floats(0.01, 10), st.floats(0.01, 10))
def test_length_of_an_ellipse_is_the_integral_of_its_speed(a, b):
    def speed(angle):
        return math.hypot(a * math.sin(angle), b * math.cos(angle))

    quarter, _ = quad(speed, 0, math.pi / 2, epsabs=0.0, epsrel=1e-10)
    assert nominal.ellipse([a, b]).length == pytest.approx(4 * quarter, rel=1e-9)


def test_length_of_waypoints_counts_every_piece_and_no_turn():
    path = nominal.waypoints([[0, 0, 0], [0.3, 0, 0], [0.3, 0.4, 0], [0.3, 0.4, 1]])
    assert path.length == pytest.approx(0.7)


def test_waypoints_are_met_in_order():
    points = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.4, 1.0)]
    path = nominal.waypoints(points)
    walked = np.array([path(s) for s in np.linspace(0, 1, 2001)])
    nearest = [np.linalg.norm(walked - point, axis=1).argmin() for point in points]
    assert nearest == sorted(nearest)
    assert nearest[0] == 0
    assert nearest[-1] == 2000
    assert walked[nearest[1]] == pytest.approx(points[1], abs=1e-3)  # of the grid of s


def test_path_that_goes_nowhere_is_a_path():
    path = nominal.line([0, 0, 0])
    assert path.length == 0
    assert path(0.5) == pytest.approx((0, 0, 0))


VALUES = st.fixed_dictionaries(
    {"segments": st.integers(1, 1000)},
    optional={
        "description": st.text(),
        "robot": st.text(min_size=1).filter(lambda s: not s.endswith(".xml")),
        "fields": st.sampled_from(["paper", "lifted"]),
        "stance": st.sampled_from(["paper", "centred"]),
        "replan": st.booleans(),
        "friction": st.floats(0, 10),
        "timestep": st.floats(1e-6, 0.02),
        "servo_stiffness": st.floats(1e-3, 1e6),
        "playback": st.floats(1e-3, 100),
        "sample_every": st.integers(1, 100),
    },
)
POSES = st.tuples(*[st.floats(-1e6, 1e6)] * 3)
PATHS = st.one_of(
    POSES.map(nominal.line),
    st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)).map(nominal.ellipse),
    st.lists(POSES, min_size=1, max_size=4).map(
        lambda points: nominal.waypoints([(0, 0, 0), *points])
    ),
)


@given(VALUES, PATHS)
def test_scenario_written_and_read_is_the_same(tmp_path_factory, values, path):
    scenario = Scenario(name="again", path=path, **values)
    file = tmp_path_factory.mktemp("scenario") / "scenario.toml"
    file.write_text(dumps(scenario), encoding="utf-8", newline="")
    assert load_scenario(str(file)) == scenario


@pytest.mark.parametrize("name", shipped_scenarios())
def test_written_scenario_holds_every_setting_that_has_a_value(name):
    scenario = load_scenario(name)
    written = tomllib.loads(dumps(scenario))
    have = {name for name in SETTINGS if getattr(scenario, name) is not None}
    assert written.keys() - {"obstacles"} == have | {"path"}


def test_written_scenario_names_settings_that_are_left_open_too():
    lines = dumps(walking()).splitlines()
    (line,) = (line for line in lines if "playback" in line)
    assert line.startswith("# playback =  ")
    assert line.endswith("; fits the walk if not given")


def test_file_names_the_scenario_unless_it_says_otherwise(file):
    assert load_scenario(file(SMALLEST, "stroll.toml")).name == "stroll"
    assert load_scenario(file('name = "hike"\n' + SMALLEST)).name == "hike"


def test_robot_file_is_found_beside_the_scenario_that_names_it(file, tmp_path):
    scenario = load_scenario(file('robot = "mine.xml"\n' + SMALLEST))
    assert scenario.robot == str(tmp_path / "mine.xml")


def test_overridden_robot_file_is_found_from_where_one_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert load_scenario("line", {"robot": "mine.xml"}).robot == str(
        tmp_path / "mine.xml"
    )


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("friction=0.5", "friction", 0.5),
        ("replan=true", "replan", True),
        ("stance=paper", "stance", "paper"),
        ("path.goal = [1, 2, 3]", "path.goal", [1, 2, 3]),
        ("description=a=b", "description", "a=b"),
        ("robot='x'\ny=1", "robot", "'x'\ny=1"),
    ],
)
def test_override_is_toml_or_else_text(text, key, value):
    assert parse_override(text) == (key, value)


def test_override_reaches_into_the_path_which_loses_its_description():
    left = {"path.goal": [0.0, 0.05, 0.0]}
    assert (scenario := load_scenario("line", left)).path.goal == (0.0, 0.05, 0.0)
    assert load_scenario("line", {**left, "description": "left"}).description == "left"
    shorter = load_scenario("line", {"segments": 3})
    assert (scenario.description, shorter.description[:8]) == ("", "sideways")


@pytest.mark.parametrize("text", ["friction", "=1", "friction=", ""])
def test_override_without_key_or_value_is_refused(text):
    with pytest.raises(UsageError, match="sets nothing: --set; write KEY=VALUE"):
        parse_override(text)


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("friction", -1, "from 0 to 10"),
        ("friction", math.nan, "from 0 to 10"),
        ("friction", math.inf, "from 0 to 10"),
        ("friction", True, "from 0 to 10"),
        ("friction", "high", "from 0 to 10"),
        ("timestep", 0, "from 1e-06 to 0.02"),
        ("timestep", -0.001, "from 1e-06 to 0.02"),
        ("segments", 0, "a whole number from 1"),
        ("segments", 2.5, "a whole number from 1"),
        ("swing_speed", 0.0, "from 1e-09"),
        ("swing_speed", 1e-320, "from 1e-09"),
        ("resolution", 5e-324, "0, or a number from 1e-09 to 0.2 [rad]"),
        ("servo_stiffness", -5, "from 1e-09"),
        ("fields", "papper", "lifted or paper"),
        ("replan", "yes", "true or false"),
        ("robot", "", "text"),
        ("name", "../up", "text in quotation marks, without slashes"),
    ],
)
def test_impossible_value_is_refused_with_key_value_and_limits(key, value, allowed):
    table = {**to_table(walking()), "path": nominal.line([0.1, 0, 0]), key: value}
    with pytest.raises(UsageError, match=f"{key} = .* is not allowed") as refusal:
        Scenario(**table)
    assert repr(value) in str(refusal.value)
    assert allowed in refusal.value.remedy


@pytest.mark.parametrize("key", [n for n, s in SETTINGS.items() if s.default is None])
def test_setting_left_to_the_robot_may_be_none(key):
    assert getattr(walking(**{key: None}), key) is None


def test_setting_with_a_default_may_not_be_none():
    with pytest.raises(UsageError, match="friction = None is not allowed"):
        walking(friction=None)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ('kind = "line"', r"goal is missing: path of kind line; give goal = \[x"),
        ('kind = "table"', 'file is missing: .*; give file = "POSES.csv", or poses = '),
        ('kind = "lien"\ngoal = [0, 0, 0]', "unknown kind 'lien': path; .*'line'"),
        ('kind = "line"\ngoal = [0, 0, 0]\nturn = 1', "unknown key 'turn'"),
        ("semi_axes = [1, 1]", "give a table whose kind is one of line, ellipse"),
        ('kind = "line"\ngoal = [0, 0]', r"path.goal = \[0, 0\] is not allowed"),
        ('kind = "line"\ngoal = "here"', "path.goal = 'here' is not allowed"),
        ('kind = "line"\ngoal = [nan, 0, 0]', r"path.goal = \[nan, 0, 0\] is not"),
        ('kind = "line"\ngoal = [1e300, 0, 0]', r"path.goal = \[1e\+300, 0, 0\] is"),
        ('kind = "ellipse"\nsemi_axes = [1, 0]', "give a list of two lengths above 0"),
        ('kind = "waypoints"\npoints = []', "give at least two poses"),
        ('kind = "waypoints"\npoints = [[0, 0, 0]]', "give at least two poses"),
        ('kind = "waypoints"\npoints = [[1, 0, 0], [0, 0, 0]]', "the start pose"),
        (
            'kind = "waypoints"\npoints = [[0, 0, 0], [1, 0]]',
            r"path.points\[1\] = \[1, 0\]",
        ),
    ],
)
def test_impossible_path_is_refused(file, table, message):
    with pytest.raises(UsageError, match=message):
        load_scenario(file(f"segments = 3\n[path]\n{table}\n"))


def test_unknown_key_is_refused_with_the_nearest_valid_one(file):
    with pytest.raises(
        UsageError, match="unknown key 'fricton'.*did you mean 'friction'"
    ):
        load_scenario(file("fricton = 1\n" + SMALLEST))


def test_unknown_table_is_refused_in_an_override():
    with pytest.raises(UsageError, match="unknown key 'paht.goal'"):
        load_scenario("line", {"paht.goal": [0, 0, 0]})


def test_file_must_say_what_has_no_default(file):
    with pytest.raises(UsageError, match=r"path is missing: .*mine.toml; give path"):
        load_scenario(file("segments = 3"))


def test_a_goal_alone_is_a_route_to_be_found(file):
    path = load_scenario(file("[path]\ngoal = [0.1, 0.2, 0.3]")).path
    assert path.kind == "route"
    assert path.goal == (0.1, 0.2, 0.3)


def test_unknown_name_is_refused_with_the_nearest_shipped_one():
    with pytest.raises(UsageError, match="unknown scenario 'elipse'.*'ellipse'"):
        load_scenario("elipse")


def test_absent_file_is_refused(tmp_path):
    with pytest.raises(UsageError, match="no such scenario file: .*gone.toml"):
        load_scenario(str(tmp_path / "gone.toml"))


def test_folder_is_refused(tmp_path):
    with pytest.raises(UsageError, match="a folder is not a scenario"):
        load_scenario(str(tmp_path))


def test_broken_file_is_refused_with_its_line(file):
    with pytest.raises(UsageError, match="not TOML, .*line 2.*mine.toml"):
        load_scenario(file("segments = 3\nthis is no TOML\n"))


def test_binary_file_is_refused(tmp_path):
    (tmp_path / "picture.toml").write_bytes(b"\xff\xfe\x00")
    told = "not TOML, line 1 is no text in UTF-8, as it must be: .*picture.toml"
    with pytest.raises(UsageError, match=told):
        load_scenario(str(tmp_path / "picture.toml"))
