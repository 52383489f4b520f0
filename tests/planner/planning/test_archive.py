"""Plans and systems written down and read back, to the last digit."""

import json

import numpy as np
import pytest
import sympy as sp

from planner.execution.execution import Execution
from planner.planning import archive
from planner.planning.algorithm import plan
from planner.planning.archive import load_plan, save_plan, system_from, system_table
from planner.planning.paths import line
from planner.planning.rollouts import rollout
from planner.systems.formulas import read_formula, write_formula
from planner.systems.strata import StratifiedSystem
from tests.systems import LIFTED, METRES, X, Y, hexapod


def test_saved_plan_is_the_same_when_loaded(tmp_path):
    path = line(np.zeros(7), [0.1, 0.1] + [0] * 5)
    robot = hexapod(**METRES, heights=True)
    planned = plan(robot, path, 3, LIFTED, execution=Execution(stance="centred"))
    save_plan(planned, tmp_path / "plan.json")
    loaded = load_plan(tmp_path / "plan.json")
    assert loaded.flows == planned.flows
    assert loaded.segment_ends == planned.segment_ends
    assert (loaded.hall_coordinates == planned.hall_coordinates).all()
    assert rollout(loaded).tolist() == rollout(planned).tolist()
    assert str(loaded) == str(planned)
    assert [p.name for p in tmp_path.iterdir()] == ["plan.json"]


def test_a_long_plan_is_written_by_its_first_segments_and_its_last():
    path = line(np.zeros(7), [0.1, 0.1] + [0] * 5)
    planned = plan(hexapod(**METRES, heights=True), path, 9, LIFTED)
    head, *first, more, last = str(planned).splitlines()
    assert head.startswith(repr(planned).removeprefix("<Plan: ").removesuffix(">"))
    assert [int(row.split()[0]) for row in (*first, last)] == [1, 2, 3, 9]
    assert more.strip() == "and 5 more; segments() has them all"


def test_system_survives_its_table():
    table = system_table(hexapod(0.1, 1 / 3, heights=True))
    again = system_from(json.loads(json.dumps(table)))
    assert system_table(again) == table


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "is not JSON"),
        ("[" * 99_999, "is not JSON"),
        ("[]", "is not a plan of the format"),
        ('{"format": "stratified plan, version 2"}', "is damaged: 'system'"),
    ],
)
def test_files_that_are_no_plans_are_refused(tmp_path, text, message):
    (tmp_path / "plan.json").write_text(text)
    with pytest.raises(ValueError, match=message):
        load_plan(tmp_path / "plan.json")


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ({"flows": [["12", "g9", 1.0]]}, "field g9 is unknown"),
        ({"flows": [["12", "g1_1", 1.0]]}, "the field belongs to S1; save the plan ag"),
        ({"flows": [["9", "g1_1", 1.0]]}, "stratum '9', which is unknown"),
        *(({"flows": [["1", "g1_1", time]]}, f"a flow lasts for a {kind}; save the")
          for time, kind in [("1_0", "str"), (True, "bool"), (None, "NoneType")]),
        ({"flows": [["1", "g1_1", float("nan")]]}, "flow .* is not below 1e.100; save"),
        ({"flows": [["1", "g1_1", 10**400]]}, "int too large to convert to float"),
        (
            {"segment_ends": [99]},
            "segment_ends do not ascend to the number of flows, ",
        ),
        ({"segment_ends": ["all"]}, "is damaged: .* as an integer"),
        ({"segment_ends": [1.5]}, "is damaged: .* as an integer"),
        ({"gait": ["zz"]}, "is damaged: .*zz"),
        ({"nominal": [[0, 0]]}, r"nominal of shape \(1, 2\) should be \(2, 5\) finite"),
        ({"nominal": [[float("nan")] * 5] * 2}, "nominal of shape .* finite numbers"),
        ({"nominal": "home"}, "nominal of shape"),
        ({"nominal": [[1e308] * 5] * 2}, "nominal of shape .* finite numbers"),
        (
            {"system": {"state": ["x"], "bottom": "0", "strata": {"0": {"g": [True]}}}},
            "True is neither a number nor a formula",
        ),
        ({"inputs": 5}, r"inputs of shape \(\) should be \(1, 5\) finite numbers"),
        ({"hall_coordinates": [[0, 0]]}, "hall_coordinates of shape"),
        ({"elements": 5}, "is damaged: "),
        ({"elements": [1]}, "is damaged: "),
        ({"elements": ["g9"]}, "element g9: field g9 is unknown"),
        ({"depart": "9"}, "stratum '9' is unknown; there are 12, 1, 2"),
        ({"depart": 9}, "is damaged: "),
        ({"system": 5}, "is damaged: "),
        ({"system": {"state": ["x"] * 101, "bottom": "0", "strata": {}}},
         "a system of 101 coordinates; 100 are the most"),
        ({"system": {"state": ["x"], "bottom": "0", "strata": [1]}}, "is damaged: "),
    ],
)  # fmt: skip
def test_plans_of_another_shape_are_refused(tmp_path, damage, message):
    path = tmp_path / "plan.json"
    save_plan(plan(hexapod(), line(np.zeros(5), [1, 1, 0, 0, 0]), 1, LIFTED), path)
    path.write_text(json.dumps(json.loads(path.read_text()) | damage))
    with pytest.raises(ValueError, match=message) as refusal:
        load_plan(path)
    assert str(refusal.value).startswith(f"{path} is damaged: ")


def test_plan_of_functions_is_not_saved(tmp_path):
    line_of_numbers = StratifiedSystem("x", {"0": {"g": lambda x: [1.0]}}, "0")
    planned = plan(line_of_numbers, line([0], [1]), 1, ["g"])
    with pytest.raises(ValueError, match="field g is a function, which cannot"):
        save_plan(planned, tmp_path / "plan.json")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"bottom": None}, "system lacks 'bottom'; it has state, strata"),
        ({"foot": "1"}, "system has the unknown key 'foot'"),
        ({"strata": {"0": {"g": ["y"]}}}, "formula 'y' has 'y', which is neither"),
    ],
)
def test_tables_that_are_no_systems_are_refused(change, message):
    table = {"state": ["x"], "bottom": "0", "strata": {"0": {"g": ["1"]}}} | change
    with pytest.raises(ValueError, match=message):
        system_from({key: value for key, value in table.items() if value is not None})


@pytest.mark.parametrize(
    "text",
    [
        "0.1 + 0.2",
        "1/3",
        "x**2 / 3 - sin(y)*exp(-x)",
        "atan2(y, x) + sqrt(Abs(x)) * pi",
        "0.30000000000000004*cos(y)",
    ],
)
def test_formulas_survive_being_written(text):
    expression = read_formula(text, (X, Y))
    assert read_formula(write_formula(expression), (X, Y)) == expression


def test_formulas_mean_what_they_say():
    assert read_formula("-x**2 / 4 + 2*cos(pi)", (X,)) == -(X**2) / 4 - 2
    assert read_formula(2, ()) == sp.Integer(2)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("__import__('os')", "which is neither a number nor one of x, pi, sin"),
        ("x.y", "which is neither"),
        ("x if x else 1", "which is neither"),
        ("True", "which is neither"),
        ("x +", "cannot be read"),
        ("sin(x, x)", "has 'sin.x, x.'; functions take one number"),
        ("9**9**9**9", "too large a number"),
        ("exp(exp(exp(1000.0)))", "exp.1000.0.' .*no real number below 1e.100"),
        ("Abs(exp(exp(exp(100))) - x)", "exp.exp.100..' .*no real number below"),
        (f"sqrt({'9' * 3000})", "cannot be read: int too large"),
        (f"sqrt({'+'.join(f'1/{9**50 + k}' for k in range(9))})", "in 1024 bits"),
        ("*".join(f"(x + {k}*x**2)" for k in range(40)), "term of 120 factors"),
        ("sin(" * 80 + "x" + ")" * 80, "a term of 81 factors.*; 64 at most"),
        ("1/(x + " * 80 + "1" + ")" * 80, "a term of 81 factors"),
        ("(9**100)**100", "too large a number"),
        ("(1/3)**99999999999", "1/3' to the power 99999999999 is too large a number"),
        ("(2*x)**99999999999", "too large a number"),
        ("4**(99999999999/2)", "too large a number"),
        (
            "sin(" + "+".join("y" * 99) + ")",
            r"sin\(y\+y[+y]*\.\.\.' has 'y', wh",
        ),
        ("-" * 9000 + "x", "cannot be read"),
        ("x" * 10_001, "10001 characters long, 10000 at most"),
    ],
)
def test_texts_that_are_no_formulas_are_refused(text, message):
    with pytest.raises(ValueError, match=message):
        read_formula(text, (X,))


def test_what_could_not_be_read_again_is_not_saved(tmp_path, monkeypatch):
    """Numbers that have no name in formulas, and plans beyond what is read."""
    fields = {"f": [sp.E, 0, 0], "g": [0, 1, "x"]}
    unnamed = plan(
        StratifiedSystem("x y z", {"0": fields}, "0"), line([0] * 3, [1] * 3), 1
    )
    with pytest.raises(ValueError, match="formula 'E' has 'E', which is neither"):
        save_plan(unnamed, tmp_path / "plan.json")
    long = plan(hexapod(), line(np.zeros(5), [1, 1, 0, 0, 0]), 1, LIFTED)
    monkeypatch.setattr(archive, "MOST_BYTES", 1000)
    with pytest.raises(ValueError, match="is too large to be read again, 0 MB may be"):
        save_plan(long, tmp_path / "plan.json")
    assert list(tmp_path.iterdir()) == []
    monkeypatch.undo()
    save_plan(long, tmp_path / "long.json")
    monkeypatch.setattr(archive, "MOST_FLOWS", most := len(long.flows) - 1)
    said = f"a plan of {most + 1} flows; {most} are the most"
    with pytest.raises(ValueError, match=said):
        save_plan(long, tmp_path / "plan.json")
    with pytest.raises(ValueError, match=said):
        load_plan(tmp_path / "long.json")
    assert [path.name for path in tmp_path.iterdir()] == ["long.json"]
