"""The evaluation, computed again from what was recorded."""

import math

import numpy as np
import pytest

from sim.evaluation.assessment import evaluate, summarise
from sim.motion.poses import wrap
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from sim.walking.walks import Walker, carry_out

pytestmark = pytest.mark.physics
PATH = {"path": {"kind": "line", "goal": [0.01, 0.01, 0.1]}, "segments": 2}
BRIEF = {"segments": 1, "predictions": ["quasi_static", "compliant"]}


def judge(changes):
    setup = prepare(load_scenario("line", PATH | changes))
    planned = None if setup.scenario.replan else plan_open_loop(setup)
    evaluation = evaluate(carry_out(Walker(setup), planned), ["creep_floor"])
    return evaluation, summarise(evaluation)


@pytest.fixture(scope="module", params=[False, True], ids=["open loop", "replanned"])
def judged(request):
    return judge({"replan": request.param})


@pytest.fixture(scope="module")
def every_step():
    return judge(BRIEF | {"sample_every": 1})


def test_the_walk_starts_after_the_hold(judged):
    evaluation, summary = judged
    assert summary["walk_starts"] == pytest.approx(0.5)
    step = evaluation.walk.recording.moments.step
    assert np.array_equal(step[evaluation.walking], step[step >= 500])


def test_slip_starts_with_the_walk(judged):
    evaluation, summary = judged
    recording = evaluation.walk.recording
    since = recording.moments.slip[-1] - recording.slip_after(500)
    assert evaluation.achieved.slip[-1] == pytest.approx(since, abs=1e-15)
    assert summary["achieved"]["slip"] == pytest.approx(since.sum())


def test_the_end_of_every_phase_is_recorded(judged):
    evaluation, _ = judged
    recording = evaluation.walk.recording
    looked = recording.moments.step[recording.marks.inspected]
    assert np.isin([phase.stop for phase in evaluation.walk.phases], looked).all()


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
    step = evaluation.walk.recording.moments.step
    for stretch in evaluation.walk.stretches:
        first = np.searchsorted(step, stretch.schedule.start, side="right")
        for name, prediction in evaluation.predicted.items():
            # the stretch begins by lifting a tripod, which moves no predicted body but
            # the one on springs: 0.18 um found 10 steps after, 5e-20 m at the start
            close = 3e-7 if name == "compliant" else 1e-9
            assert prediction.pose[first] == pytest.approx(stretch.pose, abs=close)


def test_switches_achieved_are_those_of_the_contacts(every_step):
    evaluation, summary = every_step
    contact = evaluation.achieved.contact[evaluation.walking]
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


def test_the_summary_is_that_of_every_step_whatever_is_written(every_step):
    evaluation, summary = every_step
    _, coarse = judge(BRIEF | {"sample_every": 1_000_000})
    assert coarse == summary
    margin = evaluation.achieved.margin[evaluation.walking].min()
    assert summary["achieved"]["min_margin"] == margin
    for name, prediction in evaluation.predicted.items():
        least = prediction.margin[evaluation.walking].min()
        found = summary["predicted"][name]["min_margin"]
        # looked at every 0.02 rad: half of 0.01^2 times legs of 0.1 m
        assert least <= found <= least + 5e-6


def test_errors_are_distances_between_last_rows(judged):
    evaluation, summary = judged
    achieved = evaluation.achieved.pose[-1]
    for name, prediction in evaluation.predicted.items():
        off = achieved - prediction.pose[-1]
        error = summary["error"][name]
        assert error["position"] == pytest.approx(np.hypot(*off[:2]))
        assert error["yaw"] == pytest.approx(abs(float(wrap(off[2]))))
        poses = evaluation.achieved.pose, prediction.pose
        rows = zip(*(pose[evaluation.judged] for pose in poses), strict=True)
        assert error["farthest"] == pytest.approx(
            max(math.dist(a[:2], b[:2]) for a, b in rows)
        )
        assert error["position_per_path"] == pytest.approx(
            error["position"] / summary["path_length"]
        )
