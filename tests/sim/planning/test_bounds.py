"""Plans within bounds: margin and clearance of predictions, checked independently."""

import dataclasses

import mujoco
import numpy as np
import pytest

from planner import Execution, plan, rollout
from planner.errors import BoundError
from planner.planning import subdivision as subdivide
from sim.errors import ExitCode, exit_code
from sim.experiments.identification import twist_model
from sim.motion.prediction import Predictor
from sim.obstacles.clearance import surroundings
from sim.planning.bounds import _reach, foresee, within_bounds
from sim.planning.open_loop import plan_open_loop, plan_replanned
from sim.preparation.setup import prepare
from sim.scenarios import obstacles as shapes
from sim.scenarios.body_path import line
from sim.scenarios.file import load_scenario

EVERY = 80  # steps between looks of the dense check: 0.02 rad of the fastest swing
REPLAN = pytest.mark.parametrize("replan", [False, True], ids=["open", "replanned"])


def bounded(name="line", **changes):
    return within_bounds(prepare(load_scenario(name, changes)))[0]


def foreseen(setup):
    """The stretches of a walk, and their predicted motion."""
    planned = None if setup.scenario.replan else plan_open_loop(setup)
    return list(foresee(setup, planned))


def margins(setup):
    """Margin of the predicted motion, at every `EVERY`th step and at every last one."""
    twists = twist_model(setup, setup.scenario.steer.replace("-", "_"))
    for stage in foreseen(setup):
        schedule = stage.predictor.schedule
        rows = np.arange(0, schedule.stop - schedule.start, EVERY)
        ends = [phase.stop - 1 - schedule.start for phase in schedule.phases]
        rows = np.unique(np.concatenate([rows, ends]))
        yield from Predictor(schedule, twists, setup.kinematics)(rows).margin


def engine_clearances(setup):
    """The engine's own distances between robot and obstacles, every `EVERY` steps."""
    around, model = surroundings(setup), setup.model
    data = mujoco.MjData(model)
    walls = [
        i for i in range(model.ngeom) if model.geom(i).name.startswith("obstacle_")
    ]
    parts = [part.geom for part in around.outline.solids.parts]
    for stage in foreseen(setup):
        schedule = stage.predictor.schedule
        rows = np.arange(0, schedule.stop - schedule.start, EVERY)
        for qpos in around.outline.configurations(
            *stage.predictor.configurations(rows)
        ):
            data.qpos = qpos
            mujoco.mj_kinematics(model, data)
            yield min(
                mujoco.mj_geomDistance(model, data, part, wall, 1.0, None)
                for part in parts
                for wall in walls
            )


@pytest.fixture
def passage():
    """Walls on both sides of a short diagonal walk, as far from the feet as given."""

    def make(room, way=0.02, **changes):
        up, down = 0.188 + way + room, -0.188 - room  # feet and way; thickness below
        asked = {"path.goal": [way, way, 0.0], "segments": round(way / 0.005)}
        scenario = load_scenario("line", asked | {"min_clearance": 0.002} | changes)
        walls = shapes.decode(
            [
                {"kind": "box", "center": [0, up + 0.05], "size": [1, 0.1]},
                {"kind": "box", "center": [0, down - 0.05], "size": [1, 0.1]},
            ]
        )
        return dataclasses.replace(scenario, obstacles=walls)

    return make


@pytest.fixture
def few(monkeypatch):
    """Give up early."""
    monkeypatch.setattr(subdivide, "MOST_DIVIDED", 80)


def test_without_bounds_nothing_is_changed():
    setup = prepare(load_scenario("line"))
    assert within_bounds(setup)[0] is setup


@REPLAN
def test_a_margin_is_kept_all_along_the_predicted_motion(replan):
    least = 0.05
    third = {"path.goal": [0.05, 0.05, 0.0], "segments": 13, "replan": replan}
    plain = prepare(load_scenario("line", third))
    assert min(margins(plain)) < least  # 46 mm, or the bound would show nothing
    setup = bounded(**third, min_margin=least)
    assert setup.scenario.segments > plain.scenario.segments
    # ends of swings, where the margin is least, are among the steps looked at
    assert min(margins(setup)) > least - 1e-9


def test_a_replanned_walk_on_ideal_fields_is_planned_once_within_its_bounds():
    changes = {"path.goal": [0.02, 0.02, 0.0], "segments": 4, "replan": True}
    setup, planned = within_bounds(
        prepare(load_scenario("line", changes | {"min_margin": 0.03}))
    )
    assert planned.flows == plan_replanned(setup).flows
    steered = prepare(load_scenario("line", changes | {"min_margin": 0.03} | STEERED))
    assert within_bounds(steered)[1] is None  # other poses are predicted than reached


STEERED = {"steer": "quasi-static"}


def test_legs_out_of_range_are_brought_back_by_subdividing_too():
    setup = bounded(segments=3, min_margin=0.02)
    assert setup.scenario.segments > 3
    for stage in foreseen(setup):
        swing, _ = stage.predictor.schedule.angles(stage.rows)
        assert np.abs(swing).max() <= 0.45 + 1e-9


@REPLAN
def test_a_straight_walk_is_cut_hardly_finer_than_the_joint_range_asks(replan):
    """Both tripods sweep 0.9 rad a segment at most, each 0.0378 m for a radian."""
    way, sweep = 0.4, 2 * 0.9 * 0.0378
    setup = bounded(
        min_margin=0.0, segments=4, replan=replan, **{"path.goal": [way, 0.0, 0.0]}
    )
    fewest = way / sweep
    assert fewest <= setup.scenario.segments <= 2 * np.ceil(fewest)
    assert all(stage.fraction == 1 for stage in foreseen(setup))


@pytest.mark.parametrize("span", [(-0.2, 0.45), (-0.45, 0.2)], ids=["back", "front"])
def test_each_end_of_a_range_is_told_apart(edited, scenario, span):
    """The legs of one tripod go less far to one side, and the walk is longer yet."""
    edits = []
    for leg in (2, 3, 6):  # of one sign, so that the range is that of their group
        low_high, joint = f'range="{span[0]} {span[1]}"', f'name="swing_{leg}"'
        edits += [f"{joint}/>", f"{joint} {low_high}/>"]
    robot = edited(*edits)
    assert robot.swing_range["2"] == pytest.approx(span)
    path = line((0.06, 0.06, 0.0))
    setup = prepare(scenario(robot=str(robot.path), segments=3, path=path))
    slack = _reach(setup)
    planned = plan(
        setup.extended,
        setup.nominal(),
        setup.scenario.segments,
        execution=Execution(stance=setup.stance),
    )
    phi = [setup.extended.shape.names.index(f"phi_{group}") for group in "12"]
    angle = rollout(planned)[1:, phi]
    low, high = np.transpose([robot.swing_range[group] for group in "12"])
    left = np.minimum(high - angle, angle - low).min(axis=1)
    pieces = np.split(left, planned.segment_ends[:-1])
    assert slack.walking == pytest.approx([piece.min() for piece in pieces], abs=1e-12)
    assert slack.walking.min() < 0
    assert slack.standing == pytest.approx(np.full(3, 0.2))


def test_a_lift_is_decided_by_the_segment_that_left_the_legs_there():
    first, second, *_ = foreseen(prepare(load_scenario("line", {"replan": True})))
    kinds = [phase.kind for phase in second.predictor.schedule.phases]
    lifts = kinds.index("swing")
    assert lifts > 0
    starts = [
        p.start - second.predictor.schedule.start
        for p in second.predictor.schedule.phases
    ]
    decided = second.segment(np.array(starts))
    assert decided.tolist() == [0] * lifts + [1] * (len(kinds) - lifts)
    assert (first.segment(first.rows) == 0).all()


def test_a_margin_beyond_what_standing_gives_is_refused_with_what_it_gives():
    message = (
        r"min_margin of 0\.06 m cannot be kept: standing on S[12] with all legs at "
        r"angle 0 the margin is 0\.0536\d* m, which shorter segments cannot exceed"
    )
    with pytest.raises(BoundError, match=message) as refused:
        bounded(min_margin=0.06)
    assert exit_code(refused.value) == ExitCode.SIMULATION


def test_a_margin_that_takes_too_many_segments_is_refused_with_what_can_be_kept(few):
    with pytest.raises(BoundError, match=r"more than 80 segments.* is kept with \d+"):
        bounded(min_margin=0.0535)


@pytest.mark.parametrize(
    "replan",
    # replanned it takes five times as long, to say what is said of margins, too
    [False, pytest.param(True, marks=pytest.mark.full)],
    ids=["open", "replanned"],
)
def test_a_passage_is_walked_through_clear_of_its_walls(passage, replan):
    """The clearance of the prediction, found densely by the engine's own distances."""
    room = 0.012
    coarse = prepare(passage(room, way=0.01, replan=replan))
    assert min(engine_clearances(coarse)) < 0  # or nothing would have to be cut
    setup, _ = within_bounds(coarse)
    assert setup.scenario.segments > coarse.scenario.segments
    assert min(engine_clearances(setup)) > 0.002 - 1e-6


def test_a_plan_may_have_to_stay_clear_by_nothing_at_all(passage):
    coarse = prepare(passage(0.012, way=0.01, min_clearance=0.0))
    setup, _ = within_bounds(coarse)
    assert min(engine_clearances(coarse)) < 0 < min(engine_clearances(setup)) + 1e-6


def test_a_plan_may_be_left_to_hit(passage):
    setup = prepare(passage(0.012, min_clearance=-1))
    assert within_bounds(setup)[0] is setup


def test_a_passage_too_narrow_for_the_nominal_path_is_refused_there(passage):
    message = (
        r"the nominal path itself, standing on S12, has foot_2 1\.0 mm from obstacle "
        r"2 at \(0, 0, 0\), where more than 2\.0 mm are required; "
        r"make 1\.0 mm more room"
    )
    with pytest.raises(BoundError, match=message) as refused:
        within_bounds(prepare(passage(0.001)))
    assert exit_code(refused.value) == ExitCode.SIMULATION


def test_legs_that_are_raised_reach_farther_than_those_that_stand(passage):
    message = r"the nominal path itself, standing on S1, has foot_2 -\d\.\d mm from"
    with pytest.raises(BoundError, match=message):
        within_bounds(prepare(passage(0.0025)))


def test_a_passage_too_narrow_for_any_tube_is_refused(passage, few):
    with pytest.raises(BoundError, match=r"min_clearance of 0\.002 m would need more"):
        within_bounds(prepare(passage(0.0085)))


def test_a_foreseen_replanned_walk_starts_each_segment_where_the_last_one_ended():
    setup = prepare(
        load_scenario("diagonal", {"replan": True, "segments": 8, "path.goal": GOAL})
    )
    stages = foreseen(setup)
    for before, after in zip(stages[:-1], stages[1:], strict=True):
        last = np.array(
            [before.predictor.schedule.stop - before.predictor.schedule.start - 1]
        )
        ended = before.predictor(last).pose[0]
        began = after.predictor(np.array([0])).pose[0]
        assert began == pytest.approx(ended, abs=1e-9)


GOAL = [0.04, 0.04, 0.3]


@pytest.mark.full
def test_the_corridor_is_clear_along_the_prediction():
    coarse = prepare(
        load_scenario("corridor", {"steer": "ideal"})
    )  # else out of joint range
    assert min(engine_clearances(coarse)) < 0
    asked = prepare(load_scenario("corridor"))
    least = asked.scenario.min_clearance
    divided, _ = within_bounds(asked)
    assert divided.scenario.segments == 60  # 46 where aims that diverge are taken
    assert min(engine_clearances(divided)) > least - 1e-6


def test_a_robot_that_poses_for_its_lifts_is_judged_by_its_walk():
    """With all legs at angle 0 the quadruped tips over; posed, 6.8 mm are left."""
    small = {"robot": "quadruped", "path.goal": [0.004, 0.004, 0.0], "segments": 4}
    kept = min(margins(bounded(**small, min_margin=0.0)))
    assert kept > 0
    with pytest.raises(BoundError, match=r"walk keeps 0\.00.* although its legs"):
        bounded(**small, min_margin=2 * kept)
