"""Tables and facts that commands print, from numbers that are known."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner import play
from planner.systems import merged
from sim.commands.comparing import _kind, _text, draw
from sim.commands.fit import _cells, _of_servos
from sim.commands.plan_report import Prospect, Steps, of_system, of_walk
from sim.commands.walks import Try, describe, judged, walk_tries
from sim.evaluation.summary import Weighed
from sim.fitting.estimate import Estimates, Parameter
from sim.fitting.fitting import JointFit
from sim.folder import RunFolder
from sim.optimisation.judging import Judge
from sim.preparation.setup import prepare
from sim.problems.scenario import ScenarioProblem
from sim.reports.tables import Table
from sim.scenarios.file import load_scenario
from tests.walks import simulated


def parameters(*units):
    return tuple(
        Parameter(name=f"p{k}", unit=unit, spread=1.0, step=0.1)
        for k, unit in enumerate(units)
    )


def estimates(value, error, units):
    value, error = np.atleast_2d(value), np.atleast_2d(error)
    information = np.array([np.diag(1 / np.square(row) - 1) for row in error])
    made = parameters(*units)
    return Estimates(made, value, value, information, np.ones(len(value)))


@pytest.mark.parametrize(
    ("unit", "value", "error", "cell"),
    [
        ("N m/rad", 9.123456, 0.25, "9.12 +- 0.25"),
        ("N m/rad", 9.123456, 0.0251, "9.123 +- 0.025"),
        ("N m/rad", 9.123456, 2e-9, "9.123456 +- 0.000000"),
        ("rad", 0.0123456, 0.00031, "12.35 +- 0.31"),
        ("s", 0.5, 0.4, "500 +- 400"),
        ("N m/rad", 9.0, 0.6, "-"),
    ],
)
def test_a_cell_has_two_digits_of_its_error_in_thousandths_of_rad_and_s(
    unit, value, error, cell
):
    assert _cells(estimates([value], [error], [unit]), 0) == [cell]


def test_servos_are_told_joint_by_joint_and_together():
    each = estimates([[1.0, 2.0], [3.0, 4.0]], [[0.1, 0.9], [0.1, 0.2]], ["N m", "rad"])
    make = estimates([2.0], [0.05], ["N m"])
    own = estimates([[2.0], [4.0]], [[0.9], [0.2]], ["rad"])
    before, after = np.array([0.3, np.nan]), np.array([0.1, np.nan])
    found = _of_servos(JointFit(("a", "b"), each, make, own, before, after))
    rows = dict(found["rows"][2:])
    assert rows["a"] == ["1.00 +- 0.10", "-"]
    assert rows["b"] == ["3.00 +- 0.10", "4000 +- 200"]
    assert rows["all joints"] == ["2.000 +- 0.050", ""]
    assert found["rows"][1] == ("", ["[N m]", "[mrad]"])
    assert (found["before"], found["after"]) == pytest.approx((0.3, 0.1))
    assert dict(found["unseen"]) == {"p1 does not show": ["a"]}


def test_columns_of_a_comparison_are_as_wide_as_their_cells():
    rows = [("short", "1.0", "22.25"), ("a longer name", "1000.0", "3")]
    text = _text(Table(("", "one", "other"), rows)).splitlines()
    assert text == [
        "                  one  other",
        "short             1.0  22.25",
        "a longer name  1000.0      3",
    ]
    assert _text(Table(("", "one"), [])) == "All settings are the same."


def test_arrows_lead_from_the_legs_that_are_changed(tmp_path, monkeypatch):
    from matplotlib.figure import Figure

    kept, savefig = [], Figure.savefig

    def saved(figure, *given, **named):
        kept.append(figure)
        savefig(figure, *given, **named)

    monkeypatch.setattr(Figure, "savefig", saved)
    feet = np.array([[0.1, 0.2], [0.1, -0.2], [-0.1, 0.0]]) + [1.0, 1.0]
    run = SimpleNamespace(
        contact_point=feet[None], achieved=np.array([[1.0, 1.0, 0.0]]), legs=(1, 2, 3)
    )
    found = [
        {"what": "zero of joint 1 of leg 2", "unit": "1 degree", "x": 0.0, "y": 2e-3},
        {"what": "friction", "unit": "0.1", "x": -1e-3, "y": 0.0},
    ]
    draw(run, found, tmp_path / "a.png")
    (axes,) = kept[0].axes
    arrows = [t for t in axes.texts if t.arrow_patch is not None]
    ways = {(tuple(t.xyann), tuple(t.xy)) for t in arrows}
    scale = 0.6 * 0.2 / 2e-3
    places = [np.round([*a, *b], 9).tolist() for a, b in ways]
    leg = [0.1, -0.2, 0.1, round(-0.2 + scale * 2e-3, 9)]
    body = [0.0, 0.0, round(-scale * 1e-3, 9), 0.0]
    assert sorted(places) == sorted([leg, body])
    names = [t.get_text() for t in axes.texts if t.get_text()]
    assert names == ["leg 1", "leg 2", "leg 3"]
    assert f"drawn {scale:.3g} times as long" in axes.get_title()
    assert _kind(found[0]) == "1 degree: zero of joint 1"
    assert _kind(found[1]) == "0.1: friction"


@pytest.fixture(scope="module")
def reported():
    scenario = load_scenario("line", {"path.goal": [0.02, 0.01, 0.0], "segments": 2})
    setup = prepare(scenario)
    problem = ScenarioProblem(setup)
    planned = problem.stratified
    facts, text = of_walk(
        problem, planned, Prospect("", None, {"compile": 1.0, "plan": 1.0})
    )
    return setup, planned, facts, text


@pytest.mark.parametrize("overlapped", [False, True])
def test_a_plan_is_as_long_as_its_walk(overlapped):
    """Where a segment goes on in the next, backwards at that, it is walked in one."""
    changes = {"path.goal": [0.02, -0.004, 0.12], "overlap_recovery": overlapped}
    scenario = load_scenario("diagonal", changes | {"segments": 2})
    problem = ScenarioProblem(prepare(scenario))
    assert len(merged(problem.stratified.flows)) < len(problem.stratified.flows)
    told = Prospect("", None, {"compile": 1.0, "plan": 1.0})
    facts, _ = of_walk(problem, problem.stratified, told)
    walked = simulated(replace(scenario, predictions=("ideal",))).summary
    for name in ("swing_travel", "air_travel", "distance_walked", "contact_switches"):
        assert facts[name] == pytest.approx(getattr(walked, name), rel=1e-12), name


def test_facts_of_a_plan_are_those_of_its_flows(reported):
    setup, planned, facts, text = reported
    end = play(planned.system, planned.flows, planned.start)[-1]
    assert facts["pose"] == pytest.approx(tuple(end[:3]))
    off = facts["error"]
    assert off["position"] == pytest.approx(math.dist(end[:2], (0.02, 0.01)))
    assert off["yaw"] == pytest.approx(abs(end[2]))
    states = play(planned.system, planned.flows, planned.start)
    assert facts["largest_swing"] == pytest.approx(np.abs(states[:, 3:5]).max())
    assert facts["time"] == Judge(setup).duration(planned.flows)
    assert facts["path_length"] == pytest.approx(math.hypot(0.02, 0.01))
    assert facts["contact_switches"] == planned.contact_switches
    assert (facts["segments"], facts["replan"]) == (2, False)
    assert text


def test_a_system_is_told_its_way_and_what_it_misses():
    from models import shipped_system

    problem = shipped_system("unicycle")
    planned = problem.plan()
    facts, text = of_system("unicycle", planned, folded=lambda way: 0.25)
    assert facts["largest_fold"] == 0.25
    assert facts["flow_count"] == len(planned.flows)
    assert facts["flow_time"] == pytest.approx(
        sum(abs(f.duration) for f in planned.flows)
    )
    goal = np.array([*facts["goal"].values()])
    end = np.array([*facts["end"].values()])
    start = np.array([*facts["start"].values()])
    length = planned.system.length
    assert facts["distance"] == pytest.approx(float(length(goal - start)))
    assert facts["error"] == pytest.approx(float(length(goal - end)))
    largest = np.array([*facts["largest"].values()])
    assert (largest >= np.abs(end) - 1e-9).all()
    assert facts["segments"] == len(planned.segment_ends)
    assert "largest_fold" not in of_system("unicycle", planned)[0]
    assert text


def test_steps_are_told_of_ways_that_are_not_met_exactly():
    exact = SimpleNamespace(
        path=SimpleNamespace(at=lambda s: np.array([[0.0, 0], [3.0, 4]]), corners=()),
        segments=1,
        is_exact=True,
        extended=SimpleNamespace(system=SimpleNamespace(length=np.linalg.norm)),
    )
    assert Steps.of(exact) is None


def test_a_yaw_off_its_goal_is_told_in_no_row_and_the_least_margin_is_the_worst():
    tries = [
        Try(0, "arrived", 0.001, 0.002, None, 0.5, 0.04, off=0.01),
        Try(1, "arrived", 0.003, 0.006, None, 0.1, 0.02, off=0.02),
        Try(2, "arrived", 0.002, 0.001, None, 0.1, 0.03, off=0.02),
    ]
    lines = list(describe(tries, 0.1))
    assert lines[0] == "3 of 3 draws walked to their end"
    cells = {line[:22].strip(): line[22:].split() for line in lines[1:]}
    assert cells["goal"] == ["2.00", "mm", "2.00%", "3.00", "mm", "3.00%"]
    assert cells["ideal"] == ["2.00", "mm", "2.00%", "6.00", "mm", "6.00%"]
    assert cells["least margin"] == ["30.0", "mm", "20.0", "mm"]
    assert "quasi-static" not in cells
    assert len(lines) == 5
    plain = list(describe(tries, 0.0))
    assert plain[2].split() == ["goal", "2.00", "mm", "3.00", "mm"]
    assert list(describe([Try(4, "fell over")], 0.1)) == [
        "0 of 1 draws walked to their end", "draw 4: fell over",
    ]  # fmt: skip
    played = next(describe([Try(5, "arrived", off=0.02)], 0.1))  # which has no goal
    assert played == "1 of 1 draws walked to their end"


def test_draws_are_counted_and_their_table_has_a_row_each(tmp_path, monkeypatch):
    walked, told = [], []

    def tried(scenario, robot, folder, **_):
        walked.append((scenario.draw, folder.path.name))
        return Try(scenario.draw, "arrived", 0.5)

    monkeypatch.setattr("sim.commands.walks._try", tried)
    scenario = load_scenario("line")
    found = walk_tries(
        scenario,
        None,
        RunFolder(tmp_path),
        range(3, 6),
        lambda *said: told.append(said),
    )
    assert [one.draw for one in found] == [3, 4, 5]
    assert walked == [(3, "draw-003"), (4, "draw-004"), (5, "draw-005")]
    assert [share for _, share in told] == pytest.approx([0, 1 / 3, 2 / 3])
    lines = (tmp_path / "tries.csv").read_text().splitlines()
    assert len(lines) == 4
    assert lines[0].startswith("draw,verdict,goal,")
    assert lines[1].startswith("3,arrived,0.5,")


def summary(verdict="arrived", **weighed):
    own = dict(
        prediction="ideal", radius=0.2, length=1.0, goal=0.1, ended=0.1, farthest=0.2
    )
    return SimpleNamespace(
        scenario="line", robot="hexapod", verdict=verdict, verdict_text="fell at 1 s",
        weighed=Weighed(**(own | weighed)),
    )  # fmt: skip


def test_a_walk_ends_with_4_where_it_fell_and_with_7_beyond_its_tolerance(capsys):
    assert judged(summary("fell"), 1.0, "see it") == 4
    assert "the walk fell at 1 s: line on hexapod; see it" in capsys.readouterr().err
    assert judged(summary(), 0.2, "see it") == 0
    assert judged(summary(), 0.19, "see it") == 7
    said = capsys.readouterr().err
    assert (
        "the walk was 20 % of its path off the ideal prediction, yaw included" in said
    )
    assert "beyond --tolerance 0.19" in said
    far = {"the export": summary(farthest=0.5).weighed}
    assert judged(summary(), 0.3, "see it", far) == 7
    assert "the export was 50 % of its path" in capsys.readouterr().err
    none = summary()
    none.weighed = None
    assert judged(none, 0.0, "see it") == 0
