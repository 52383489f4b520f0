"""The evaluation, computed again from what was recorded."""

import math

import numpy as np
import pytest

from sim.evaluate import evaluate, summarise
from sim.planning import plan_open_loop
from sim.poses import wrap
from sim.scenario_file import load
from sim.setup import prepare
from sim.walk import walk

pytestmark = pytest.mark.physics
PATH = {"path": {"kind": "line", "goal": [0.01, 0.01, 0.1]}, "segments": 2}


@pytest.fixture(scope="module", params=[False, True], ids=["open loop", "replanned"])
def judged(request):
    setup = prepare(load("line", PATH | {"replan": request.param}))
    planned = None if request.param else plan_open_loop(setup)
    evaluation = evaluate(walk(setup, planned))
    return evaluation, summarise(evaluation, 0.0)


def test_the_walk_starts_after_the_hold(judged):
    evaluation, summary = judged
    assert summary["walk_starts"] == pytest.approx(0.5)
    assert evaluation.walking.sum() == (evaluation.walk.recording.rows >= 1000).sum()


def test_rows_tell_contacts_and_slip_of_the_step_they_close(judged):
    evaluation, summary = judged
    feet, rows = evaluation.walk.recording.feet, evaluation.walk.recording.rows
    assert np.array_equal(evaluation.achieved.contact, feet.contact[rows - 1])
    since = feet.slip[-1] - feet.slip[999]
    assert evaluation.achieved.slip[-1] == pytest.approx(since, abs=1e-15)
    assert summary["achieved"]["slip"] == pytest.approx(since.sum())


def test_travel_is_told_apart_by_what_stands(judged):
    evaluation, summary = judged
    loaded, air = 0.0, 0.0
    for phase in evaluation.walk.phases:
        if phase.kind == "swing":
            on_ground = phase.field in ("g1_1", "g2_2")
            loaded += abs(phase.amount) * on_ground
            air += abs(phase.amount) * (not on_ground)
    assert summary["swing_travel"] == pytest.approx(loaded)
    assert summary["air_travel"] == pytest.approx(air)
    # 0.0378 m of way for a radian
    assert summary["distance_walked"] == pytest.approx(0.0378 * loaded)


def test_every_stretch_is_predicted_from_the_pose_it_was_planned_from(judged):
    evaluation, _ = judged
    rows = evaluation.walk.recording.rows
    for stretch in evaluation.walk.stretches:
        first = np.searchsorted(rows, stretch.schedule.start, side="right")
        for prediction in evaluation.predicted.values():
            # the stretch begins by lifting a tripod, which moves no predicted body
            assert prediction.pose[first] == pytest.approx(stretch.pose, abs=1e-9)


def test_switches_achieved_are_those_of_the_contacts(judged):
    evaluation, summary = judged
    contact = evaluation.walk.recording.feet.contact[1000:]
    of = evaluation.walk.setup.robot.group_of_leg
    count = 0
    for group in (0, 1):
        held = True
        for feet in contact[:, of == group]:
            if held and not feet.any():
                held, count = False, count + 1
            elif not held and feet.all():
                held, count = True, count + 1
    assert summary["contact_switches_achieved"] == count


def test_errors_are_distances_between_last_rows(judged):
    evaluation, summary = judged
    achieved = evaluation.achieved.pose[-1]
    for name, prediction in evaluation.predicted.items():
        off = achieved - prediction.pose[-1]
        error = summary["error"][name]
        assert error["position"] == pytest.approx(np.hypot(*off[:2]))
        assert error["yaw"] == pytest.approx(abs(float(wrap(off[2]))))
        rows = zip(evaluation.achieved.pose, prediction.pose, strict=True)
        assert error["farthest"] == pytest.approx(
            max(math.dist(a[:2], b[:2]) for a, b in rows)
        )
        assert error["position_per_path"] == pytest.approx(
            error["position"] / summary["path_length"]
        )
