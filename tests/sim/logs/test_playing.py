"""Joint motion from elsewhere is walked as plans are, with contacts of its own."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models import load
from sim.errors import UsageError
from sim.evaluation.quantities import describe
from sim.logs import feet
from sim.logs.feet import posture
from sim.logs.log import Log, of_function, read_log, written
from sim.logs.playing import Motion, posed, scenario_of, within_reach
from sim.motion.schedule import MotionLimits
from sim.palette import PREDICTED
from sim.pictures.legend import entries
from sim.preparation.setup import prepare
from sim.reports.maps import overlaid
from sim.reports.panels import panels
from sim.run_folder import write
from sim.runs.run import read_run
from sim.scenarios.file import load_scenario
from sim.simulation import play, simulate
from sim.viewing.marks import Marks

SHORTEST_CONTACT = 0.02  # [s] of a contact, or of its interruption, that is planned

PERIOD = 1.6  # [s]
SWING = 0.12  # [rad]
STANCE = 0.0378  # [m/rad], of the hexapod


def tripods(t: float) -> dict[str, float]:
    """A tripod gait of the hexapod: one swings forward in the air, one strokes."""
    part = (t / PERIOD) % 1.0
    lift = 0.25 * np.sin(2 * np.pi * part) ** 2
    swing = SWING * np.cos(2 * np.pi * part)
    angles = {}
    for legs, turned, raised in (
        ((1, 4, 5), swing, lift * (part > 0.5)),
        ((2, 3, 6), swing, lift * (part < 0.5)),
    ):
        for leg in legs:
            angles |= {f"swing_{leg}": turned, f"lift_{leg}": raised}
    return angles


@pytest.fixture(scope="module")
def log() -> Log:
    return of_function(tripods, PERIOD, 100)


@pytest.fixture(scope="module")
def played(log, tmp_path_factory):
    robot = load("hexapod")
    file = tmp_path_factory.mktemp("gait") / "tripods.csv"
    file.write_text(written(log))
    scenario = scenario_of(robot, file, {"timestep": 0.002})
    return simulate(scenario, robot=robot, without=("creep_floor",))


@pytest.mark.parametrize(
    ("file", "name"),
    [("gait_2-b", "gait_2-b"), ("a gait (2)", "a-gait--2"), ("../$?", "motion")],
)
def test_a_played_motion_is_named_after_its_file_as_folders_can_be(file, name):
    robot = load("hexapod")
    assert scenario_of(robot, Path(f"{file}.csv"), {}).name == name


def test_contacts_are_planned_from_the_lowest_feet(log):
    robot = load("hexapod")
    found = posture(robot, log.joints, log.commanded)
    one, other = [0, 3, 4], [1, 2, 5]
    quarter = len(log.time) // 4
    assert found.standing[quarter].tolist() == [f in one for f in range(6)]
    assert found.standing[3 * quarter].tolist() == [f in other for f in range(6)]


def test_feet_that_are_not_level_stand_where_the_robot_comes_to_rest():
    robot = load("hexapod")
    lowered = {f"lift_{leg}": np.full(1, -0.01 * (leg == 1)) for leg in robot.legs}
    angles = np.stack([*lowered.values()], axis=1)
    found = posture(robot, tuple(lowered), angles)
    lowest = found.feet[0, :, 2] <= found.feet[0, :, 2].min() + 1e-9
    assert lowest.sum() == 1
    assert found.standing[0].sum() >= 3


def test_a_sole_gives_to_its_load_as_all_joints_of_its_leg_do():
    """A load f turns each servo by J' f over its stiffness, and the sole by J J' f."""
    J = np.random.default_rng(3).normal(size=(5, 3, 2))
    for each in J:
        gives = feet._together(each)
        assert gives * gives[2] == pytest.approx(each @ each[2])


def test_the_rigid_prediction_is_the_stroke_times_the_stride(played):
    """Each half period one tripod strokes by 2 SWING, the first one goes back."""
    end = played.evaluation.predicted["quasi_static"].pose[-1]
    assert abs(end[2]) < 2e-3
    assert np.hypot(*end[:2]) == pytest.approx(4 * SWING * STANCE, rel=0.02)


def test_a_played_motion_has_no_goal_and_its_shares_are_of_the_predicted_way(played):
    summary = played.summary
    table = json.loads(json.dumps(summary.to_json()))
    assert not {"goal", "missed"} & table.keys()
    assert table["error"].keys() == {"quasi_static", "compliant"}
    assert summary.verdict == "arrived"
    way = np.hypot(*played.evaluation.predicted["quasi_static"].pose[-1][:2])
    assert summary.path_length == pytest.approx(way, rel=0.1)
    assert summary.weighed.goal is None
    for found in (summary.achieved, summary.predicted["compliant"]):
        assert found.slip > 0
        assert (found.slip_swing, found.slip_transition) == (None, None)
    assert (summary.contact_switches, summary.contact_switches_achieved) == (3, 4)
    # joints that lift are twice as fast
    fastest = SWING * 2 * np.pi / PERIOD
    assert summary.fastest_swing == pytest.approx(fastest, rel=0.01)


def test_physics_and_predictions_of_a_played_gait_agree(played):
    error = played.summary.error
    assert error["compliant"].position_per_path < 0.01
    assert error["quasi_static"].position_per_path < 0.05


def test_the_robot_stands_in_the_first_posture_before_time_begins(played):
    walk = played.walk
    assert played.summary.walk_starts == 0.5
    model, card = walk.setup.model, walk.setup.robot.card
    start = model.key("start").qpos
    for joint, angle in tripods(0.0).items():
        assert start[model.joint(joint).qposadr[0]] == pytest.approx(angle, abs=1e-5)
        assert joint in card.joints


def test_a_run_of_a_motion_is_walked_again_from_its_scenario(played, tmp_path):
    folder = write(played, tmp_path / "run")
    robot = load("hexapod")
    again = read_log(folder / "motion.csv", robot.card.joints, robot.legs)
    np.testing.assert_array_equal(
        again.commanded, played.walk.setup.motion.log.commanded
    )
    scenario = load_scenario(str(folder / "scenario.toml"))
    np.testing.assert_array_equal(
        prepare(scenario).motion.log.commanded, again.commanded
    )


@pytest.mark.parametrize("beyond", [-0.002, 0.0009, 0.0011, 5.0])
def test_the_joint_that_is_commanded_farthest_beyond_its_range_is_told(beyond):
    robot = load("hexapod")
    low, high = robot.span("swing_2")
    asked = {"swing_1": lambda t: 0.2 * t, "swing_2": lambda t: (low - beyond) * t}
    log = of_function(lambda t: {j: angle(t) for j, angle in asked.items()}, 1.0)
    told = within_reach(log, robot).done
    stops = f"stops at the end of its range, {low:.4g} to {high:.4g} rad"
    line = f"swing_2 is commanded to {low - beyond:.4g} rad at 1 s and {stops}; "
    line += "give the right --units where these are no radians"
    assert [*told] == [line] * (beyond > 1e-3)


def test_a_joint_without_limits_has_none_to_be_beyond():
    loose = SimpleNamespace(span=lambda joint: (-np.pi, np.pi))
    log = of_function(lambda t: {"swing_1": 9.0 * t}, 1.0)
    assert within_reach(log, load("hexapod")).done
    assert within_reach(log, loose) is log


def test_a_short_contact_is_no_planned_one(log):
    robot = posed(load("hexapod"), log)
    limits = MotionLimits(0.5, 5.0, 0.3, 0.3, 0.5, 0.001, robot.groups)
    early = replace(log, commanded=log.commanded.copy())
    row, column = len(log.time) // 4, log.joints.index("lift_2")
    early.commanded[row, column] = 0.0  # down for a moment in the middle of its lift
    assert not Motion(early, robot, limits).contact[:, 1].all()
    contact = Motion(early, robot, limits).contact[:, 1]
    assert np.count_nonzero(np.diff(contact)) == 2


@pytest.mark.parametrize(
    ("found", "planned"),
    [
        ("#.###...", "#####..."),  # an interruption, right after the first moment
        ("##.###..", "######.."),
        ("...#..##", "......##"),  # a contact
        ("##..####", "##..####"),  # it lasts for as long as one must
        (".######.", ".######."),  # how long it was or will be so, nobody knows
    ],
)
def test_what_lasts_too_short_is_planned_as_what_was_before(log, found, planned):
    motion = Motion(log, None, None)
    standing = np.array([[sign == "#", True] for sign in found])
    given = SimpleNamespace(standing=standing, height=np.ones(2), near=np.zeros((8, 2)))
    vars(motion).update(posture=given, time=np.arange(8) * SHORTEST_CONTACT / 2)
    assert "".join(np.where(motion.contact[:, 0], "#", ".")) == planned


def test_a_foot_that_plunges_for_a_moment_leaves_another_to_stand_on(log):
    """A row of a log that is wrong by a radian tips the robot off all other feet."""
    robot = posed(load("hexapod"), log)
    limits = MotionLimits(0.5, 5.0, 0.3, 0.3, 0.5, 0.001, robot.groups)
    wrong = replace(log, commanded=log.commanded.copy())
    row, column = len(log.time) // 4, log.joints.index("lift_2")
    wrong.commanded[row, column] = -1.0
    motion = Motion(wrong, robot, limits)
    assert not motion.posture.standing.any(axis=1).all()
    assert motion.contact.any(axis=1).all()


def test_a_function_is_played_and_a_joint_that_the_robot_lacks_is_named():
    fast = {"timestep": 0.002, "predictions": ["quasi_static"]}
    done = play(load("hexapod"), lambda t: {"lift_1": 0.05 * t}, 0.3, **fast)
    assert done.summary.simulated_time == pytest.approx(0.8, abs=0.01)
    assert done.summary.verdict == "arrived"  # though it was to stay where it was
    with pytest.raises(UsageError, match="no joint 'lift_9': the gait; did you mean"):
        play(load("hexapod"), lambda t: {"lift_9": 0.0}, 0.3)
    for gait in (lambda t: {f"lift_{1 + (t > 0)}": 0.0}, lambda t: {}):
        with pytest.raises(UsageError, match="no joint, or different ones at diff"):
            play(load("hexapod"), gait, 0.3)


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    """A robot that stands still in the physics, and did not quite in its log."""
    folder, way = tmp_path_factory.mktemp("still"), np.linspace(0, 0.4, 41)
    names = "time,swing_1,body.x,body.y,body.yaw,body.roll,measured.swing_1,contact.1"
    rows = [
        f"{t:.2f},0,{0.005 * hill:.6f},0,0,{0.3 + 0.02 * hill - 0.01 * t:.6f},0.03,0"
        for t, hill in zip(way, np.sin(np.pi * way / 0.4), strict=True)
    ]
    (folder / "still.csv").write_text("\n".join([names, *rows]) + "\n")
    scenario = scenario_of(load("hexapod"), folder / "still.csv", {"timestep": 0.002})
    return simulate(scenario, without=("creep_floor",))


def test_the_measured_robot_is_compared_on_the_whole_way(still):
    error, real = still.summary["error"]["measured"], still.summary.measured
    assert error["position"] < 1e-4
    assert error["farthest"] == pytest.approx(0.005, abs=1e-4)
    assert real.roll.end == pytest.approx(-0.004, abs=4e-4)  # a step before 0.4 s
    assert real.roll.off == pytest.approx(-real.roll.end, abs=1e-4)
    assert real.roll.farthest == pytest.approx(0.018, abs=2e-4)
    assert (real.pitch, real.contact) == (None, 0.0)
    assert real.joints == pytest.approx(0.03, abs=1e-3)
    assert "off the simulated one, and 1.03 at most" in describe(still.summary)


def test_noise_of_measured_joints_is_not_smoothed_by_other_clocks():
    """Of a log of 50 rows a second, beside a walk that is recorded 100 times."""
    time, noise = np.arange(0, 1.01, 0.02), np.random.default_rng(0).normal(size=51)
    still, seen = np.zeros((51, 1)), 0.01 * noise[:, None]
    log = Log(time, ("swing_1",), still, measured=seen)
    done = play(load("hexapod"), log, timestep=0.002, predictions=["quasi_static"])
    rms = float(np.sqrt(np.mean(seen**2)))  # 0.85 of it where its rows are bridged
    assert done.summary.measured.joints == pytest.approx(rms, rel=0.02)


def test_measured_joints_are_those_of_the_leg_behind_the_slack_of_its_gears():
    none = np.zeros((2, 1))
    log = Log(np.array([0.0, 0.2]), ("lift_1",), none, measured=none)
    fast = {"timestep": 0.002, "predictions": ["quasi_static"]}
    done = play(load("hexapod"), log, backlash=0.04, **fast)
    # its load pushes it to one side, half the slack from the servo's shaft
    assert done.summary.measured.joints == pytest.approx(0.02, rel=0.1)


def test_report_and_viewer_show_a_played_motion_beside_the_real_robot(
    still, tmp_path, paged
):
    run = read_run(write(still, tmp_path / "run"))
    assert run.summary.measured.roll == still.summary.measured.roll
    assert "Roll of the body [mrad]" in (drawing.heading for drawing in panels(run))
    shown = {label for label, _ in entries(run)}
    assert {"measured path", "compliant prediction", "achieved path"} <= shown
    assert {"predicted path", "its end"} <= shown
    assert not {"nominal path", "goal"} & shown
    *_, last = overlaid([("one", run), ("other", run)])
    assert last.heading == "Distance from the measured body [mm]"
    page = (tmp_path / "run" / "report.html").read_text()
    assert "predicted path" in page
    assert not any(word in page for word in ("control sequence", "ring is the goal"))
    drawn = {tuple((255 * g.rgba[:3]).round()) for g in Marks(run, run.model).at(9)}
    for mark in ("measured", "compliant"):
        assert (
            tuple(np.round(255 * np.array(PREDICTED[mark].colour.rgba())[:3])) in drawn
        )
