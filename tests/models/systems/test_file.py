"""A user's own system in one file: what it may say, and how it is refused."""

import numpy as np
import pytest

from models.errors import ProblemError
from models.systems.catalogue import load_system, shipped_system
from planner.controllability.gaits import gait_controllability
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.archive import system_table
from planner.planning.chained_forms import chained_form
from planner.planning.rollouts import rollout

WHEEL = """
description = "a wheel"
state = ["x", "y", "theta"]
goal = { y = 1 }
segments = 4

[parameters]
radius = 0.5

[strata.0]
roll = { x = "radius*cos(theta)", y = "radius*sin(theta)" }
turn = { theta = 1 }
"""
BIPED = """
state = ["x", "y", "theta", "phi_1", "phi_2", "height_1", "height_2"]
goal = { y = 1 }
elements = ["g1_1", "g2_2", "g1_2", "g2_1", "[g1_1,g2_2]"]

[limits]
phi_1 = [-2, 2]

[level_sets]
12 = ["height_1", "height_2"]
1 = ["height_1"]
2 = ["height_2"]

[strata.12]

[strata.1]
g1_1 = { x = "cos(theta)", y = "sin(theta)", theta = 1, phi_1 = 1 }
g1_2 = { phi_2 = 1 }
g1_3 = { height_2 = 1 }

[strata.2]
g2_1 = { phi_1 = 1 }
g2_2 = { x = "cos(theta)", y = "sin(theta)", theta = -1, phi_2 = 1 }
g2_3 = { height_1 = 1 }
"""
PYTHON = """
import numpy as np
from models.systems.problem import Problem
from planner.systems.strata import StratifiedSystem

roll = lambda x: np.array([np.cos(x[2]), np.sin(x[2]), 0.0])
turn = lambda x: np.array([0.0, 0.0, 1.0])
problem = Problem(
    name="wheel",
    description="fields known as functions",
    system=StratifiedSystem("x y theta", {"0": {"roll": roll, "turn": turn}}, "0"),
    gait=("0",),
    elements=("roll", "turn", "[roll,turn]"),
    goal={"x": 0.1, "y": 0.1},
)
"""


@pytest.fixture
def read(tmp_path):
    """Load a text as a file of the given name."""

    def read(text, name="mine.toml", values=None):
        path = tmp_path / name
        path.write_text(text)
        return load_system(path, values)

    return read


def test_file_of_formulas_is_a_problem(read):
    problem = read(WHEEL)
    assert (problem.name, problem.description) == ("mine", "a wheel")
    assert problem.states[1].tolist() == [0, 1, 0]
    assert problem.gait == ("0",)
    assert problem.segments == 4


def test_elements_left_out_are_chosen(read):
    problem = read(WHEEL)
    assert problem.elements == ()
    planned = plan(problem.system, problem.path, 4)
    assert planned.elements == ("roll", "turn", "[roll,turn]")


def test_flat_outputs_are_formulas(read):
    wheel = read('flat = { along = "x", across = "y", slope = "tan(theta)" }' + WHEEL)
    form = chained_form(wheel.system, wheel.flat)
    assert rollout(form.plan(*wheel.states))[-1] == pytest.approx([0, 1, 0], abs=1e-12)
    with pytest.raises(ProblemError, match=r"flat has no key 'sideways'"):
        read("flat = { sideways = 1 }" + WHEEL)
    with pytest.raises(ProblemError, match="across"):
        read('flat = { along = "x" }' + WHEEL)


def test_degree_and_words_are_keys(read):
    assert read("degree = 3\nwords = 'symmetric'" + WHEEL).degree == 3
    with pytest.raises(ProblemError, match="words 'longest' is unknown"):
        read("words = 'longest'" + WHEEL)


def test_parameters_can_be_set_from_outside(read):
    slow, fast = read(WHEEL), read(WHEEL, values={"radius": 2})
    at = dict.fromkeys(slow.system.state, 0)
    speeds = [p.system.fields["roll"].subs(at)[0] for p in (slow, fast)]
    assert speeds == [0.5, 2]


def test_written_biped_is_the_shipped_one(read):
    ours, theirs = shipped_system("biped"), read(BIPED)
    assert system_table(theirs.system) == system_table(ours.system)
    assert theirs.limits == {"phi_1": (-2, 2)}
    start = theirs.states[0]
    assert gait_controllability(theirs.system, theirs.gait, start).controllable


@pytest.mark.parametrize("kink", ["Abs(x - 9)", "(x - 9)*sign(x - 9)"])
def test_kink_away_from_the_path_is_as_smooth_as_its_side(read, kink):
    problems = [read(WHEEL.replace("radius*c", f"({k})*c")) for k in (kink, "9 - x")]
    bent, smooth = (plan(p.system, p.path, 2).flows for p in problems)
    assert [flow[:2] for flow in bent] == [flow[:2] for flow in smooth]
    durations = [[flow.duration for flow in flows] for flows in (bent, smooth)]
    assert durations[0] == pytest.approx(durations[1], rel=1e-12)  # rounding


def test_gait_left_out_visits_every_neighbour(read):
    assert read(BIPED).gait == ("12", "1", "12", "2", "12")


def test_python_file_may_have_fields_known_as_functions(read):
    problem = read(PYTHON, "wheel.py")
    compiled = extend(problem.system, problem.elements)
    misses = []
    for count in (1, 16):
        end = rollout(plan(compiled, problem.path, count))[-1]
        misses.append(np.linalg.norm(end - problem.states[1]))
    assert misses[1] < misses[0] / 2  # falls as one over the root of the segments


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("state =", "sate ="), "has no key 'sate'; did you mean 'state'"),
        (("segments", "segmnts"), "has no key 'segmnts'; did you mean 'segments'"),
        (("[parameters]", "[parameters"), "bad system: .*mine.toml; "),
        (('"x", "y"', '"x", 7'), r"state must be a list of texts, got \['x', 7"),
        (
            ('["x", "y", "theta"]', '"x y theta"'),
            "state must be a list of texts, got 'x y theta'",
        ),
        (
            ("{ theta = 1 }", "[0, 0, 1]"),
            r"field turn is \[0, 0, 1\]; give rates, as in",
        ),
        (("{ theta", "{ thta"), "field turn moves thta, .* mean 'theta'"),
        (("{ theta = 1 }", "{ theta = true }"), "field turn has True; write a number"),
        (("cos(theta)", "cos(phi)"), "field roll: formula .* has 'phi', which is nei"),
        (("cos(theta)", "__import__('os')"), "field roll: formula .* neither a number"),
        (("cos(theta)", "theta.real"), "field roll: formula .* has 'theta.real'"),
        (("cos(theta)", "(lambda: 1)()"), "field roll: formula .* neither a number"),
        (("cos(theta)", "9**9**9**9"), "field roll: .*too large a number"),
        (("cos(theta)", "cos(theta"), "field roll: formula .* cannot be read"),
        (("cos(theta)", "1/0"), "field roll of S0 has zoo, no real number"),
        (("radius = 0.5", "theta = 0.5"), "theta is a parameter and a coordinate"),
        (
            ("cos(theta)", "x*asin(2)"),
            r"roll: 'asin\(2\)' has nan, no real number",
        ),
        (
            ("cos(theta)", "(-8)**(1/3)"),
            r"roll: .*-8.* \*\* .1 / 3.' has nan, no real number",
        ),
        (("cos(theta)", "exp(exp(exp(9)))"), "no real number below 1e.100"),
        (("radius = 0.5", "sin = 0.5"), "sin is a parameter, but formulas use it"),
        (("radius = 0.5", "radius = 'big'"), "parameters.radius must be a number, got"),
        (("{ y = 1 }", "{ z = 1 }"), "goal has z, which is unknown; there are x, y, "),
        (("{ y = 1 }", "{ y = inf }"), "goal.y must be a number, got inf"),
        (("{ y = 1 }", "1"), "goal must be a table, got 1"),
        (
            ("segments = 4", "segments = 0"),
            "segments is 0; a whole number from 1 to 100000",
        ),
        (("segments = 4", "segments = 1_000_000"), "from 1 to 100000"),
        (("segments = 4", "stance = 'jump'"), "stance 'jump' is unknown; there are p"),
        (
            ("segments = 4", "stance = ['paper']"),
            "stance must be a text, got",
        ),
        (("segments = 4", "limits = { q = [0, 1] }"), "limit of q, which is unknown"),
        (
            ("segments = 4", "limits = { x = [0, 1] }"),
            "limit of x: some field moves it",
        ),
        (
            ("segments = 4", "limits = { x = [1, 0] }"),
            "limits of x are empty: 1.0 to 0.0; ",
        ),
        (
            ("segments = 4", "segments = 4.5"),
            "segments must be a whole number",
        ),
        (("segments = 4", "gait = ['0', '1']"), "stratum '1' of gait .* is unknown"),
        (("segments = 4", "bottom = '1'"), "bottom '1' is unknown; there is only 0"),
        (("segments = 4", "limits = { x = 1 }"), "limits.x must be a list of numbers"),
        (
            ("segments = 4", "level_sets = { 0 = 'x' }"),
            "level_sets.0 must be a list",
        ),
        (("segments = 4", "level_sets = { 0 = ['x'] }"), "roll leaves its stratum S0"),
        (("[strata.0]", "[strata]"), "field x is 'radius.*'; give rates"),
    ],
)
def test_what_makes_no_sense_is_refused(read, change, message):
    assert change[0] in WHEEL
    with pytest.raises(ProblemError, match=message) as refusal:
        read(WHEEL.replace(*change))
    assert "mine.toml" in str(refusal.value)
    assert "\n" not in str(refusal.value).strip()


def test_unknown_parameter_from_outside_is_refused(read):
    with pytest.raises(ProblemError, match="parameter 'rad' is unknown; .* mean 'rad"):
        read(WHEEL, values={"rad": 1})


def test_power_of_a_parameter_is_too_large_like_a_written_one(read):
    text = WHEEL.replace("radius*cos", "2**radius*cos")
    with pytest.raises(ProblemError, match="2' to the power 99999999999 is too large"):
        read(text, values={"radius": 99999999999})


@pytest.mark.parametrize("name", ["gone.toml", "gone.py"])
def test_a_file_that_is_not_there_is_a_problem_of_ours(tmp_path, name):
    path, way = tmp_path / name, "give a file that exists"
    with pytest.raises(ProblemError, match=f"no such system file: {path}; {way}"):
        load_system(path)
    path.mkdir()
    why = "cannot be read, Is a directory"
    with pytest.raises(ProblemError, match=f"{why}: {path}; {way}"):
        load_system(path)


def test_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ProblemError, match="bad system"):
        load_system(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("problem = 1", "it defines no models.Problem named `problem`"),
        ("", "it defines no"),
        ("1 / 0", "it ends with ZeroDivisionError: division by zero"),
        ("def (", "it ends with SyntaxError"),
    ],
)
def test_python_file_that_makes_no_problem_is_refused(read, text, message):
    with pytest.raises(ProblemError, match=message):
        read(text, "wheel.py")


def test_python_file_has_no_parameters(read):
    with pytest.raises(ProblemError, match="no parameters to set"):
        read(PYTHON, "wheel.py", {"radius": 1})


def test_a_file_may_declare_its_metric_and_its_lifts_and_be_named_by_a_text(tmp_path):
    path = tmp_path / "foot.toml"
    path.write_text(
        """
        state = ["x", "a", "h"]
        goal = { x = 1 }
        bottom = "1"
        metric = { a = 0.2 }
        lifts = { 0 = ["lift"] }
        level_sets = { 1 = ["h"] }
        [strata.1]
        turn = { a = 1 }
        [strata.0]
        swing = { x = 1, h = 1 }
        lift = { a = 1, h = 2 }
        """
    )
    system = load_system(str(path)).system
    assert system.weights.tolist() == [1, 0.2, 1]
    assert system.lifts == {"0": ("lift",)}
