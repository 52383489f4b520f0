"""A finished run as pictures and reports see it: rows, commands, groups and circles."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sim.feedback.stops import Stop
from sim.motion.poses import compose
from sim.pictures.legend import noun
from sim.runs.run import read_run


@pytest.fixture
def run(folder):
    return read_run(folder)


def test_rows_of_the_walk_begin_where_it_starts(run):
    rows = run.walking
    assert run.time[rows][0] >= run.summary.walk_starts - 1e-6
    before = run.time[: rows.start]
    assert (before < run.summary.walk_starts).all()
    late = replace(run, summary=replace(run.summary, walk_starts=1e9))
    assert late.walking.start == len(run.time) - 1


def test_commands_of_rows_are_those_in_force(run):
    assert run.ctrl.shape == (len(run.time), run.model.nu)
    times = run.commands["time"]
    for row in (0, 1, len(run.time) // 2, len(run.time) - 1):
        at = min(int((times < run.time[row] - 1e-6).sum()), len(times) - 1)
        assert (run.ctrl[row] == run.commands["ctrl"][at]).all()


def test_errors_are_achieved_less_predicted(run):
    for name, pose in run.predicted.items():
        error = run.error(name)
        assert error[:, :2] == pytest.approx((run.achieved - pose)[:, :2])
        assert (np.abs(error[:, 2]) <= np.pi).all()
    turned = replace(
        run, arrays={**run.arrays, "measured_pose": run.achieved + [0, 0, 2 * np.pi]}
    )
    assert turned.error("measured")[:, 2] == pytest.approx(
        np.zeros(len(run.time)), abs=1e-9
    )
    assert "measured" in turned.compared
    assert "measured" not in run.compared
    assert [*turned.drawn][0] == "measured"
    assert {"ideal", run.best} == {*run.drawn}


def test_legs_and_groups_are_those_of_the_card(run):
    assert run.legs == (1, 2, 3, 4, 5, 6)
    assert noun(run) == "tripod"
    for leg, group in zip(run.legs, run.group_of_foot, strict=True):
        assert leg in [*run.card.groups.values()][group].legs
    odd = {"1": SimpleNamespace(legs=(1, 2)), "2": SimpleNamespace(legs=(3,))}
    assert noun(SimpleNamespace(card=SimpleNamespace(groups=odd))) == "group"
    assert run.segments == 2


def test_reach_is_that_of_the_farthest_foot_at_the_end(run):
    feet = run.contact_point[-1] - run.achieved[-1, :2]
    assert run.reach == pytest.approx(max(np.hypot(x, y) for x, y in feet))


def test_the_nominal_path_is_drawn_from_its_start_to_its_goal(run):
    assert run.nominal[0] == pytest.approx(np.zeros(3))
    assert run.nominal[-1] == pytest.approx(run.summary.goal)
    assert len(run.nominal) == 400
    assert run.path_labels == ("nominal path", "goal")
    frame = np.array([1.0, 2.0, 0.5])
    moved = replace(run, frame=frame)
    assert moved.nominal == pytest.approx(compose(frame, run.nominal))
    assert run.obstacles == ()
    assert run.clearance is None


def stop(place, doubt):
    nothing = (0.0,) * 3
    return Stop(
        0, 1.0, 1.0, nothing, (0.0,) * 4, (*place, 0.0), (*doubt, 0.0), *[nothing] * 4
    )


def test_where_feedback_was_sure_to_be_is_an_ellipse_of_ninety_per_cent(run):
    assert run.thought == ()
    summary = replace(run.summary, feedback=SimpleNamespace())
    sure = replace(run, summary=summary, stops=(stop((0.1, 0.2), (0.01, 0.02)),))
    ((line),) = sure.thought
    off = (line - [0.1, 0.2]) / [0.01, 0.02]
    radius = np.sqrt(-2 * np.log(0.1))  # of two normal numbers: 90 % are within
    assert np.hypot(*off.T) == pytest.approx(np.full(len(line), radius), rel=1e-3)
    assert line[0] == pytest.approx(line[-1])
    assert len(line) == 33
    framed = replace(sure, frame=np.array([1.0, 0.0, np.pi / 2]))
    x, y = framed.thought[0].mean(axis=0)
    assert (x, y) == pytest.approx((1.0 - 0.2, 0.1), abs=2e-3)
