"""Logs of several trials and of turned cameras are brought onto one frame."""

from dataclasses import replace

import numpy as np
import pytest

from sim.logs.alignment import measured, together
from sim.logs.log import Log
from sim.motion.poses import compose

TIME = np.linspace(0, 2, 41)
WAY = np.stack([0.1 * TIME, 0.02 * TIME**2, 0.1 * TIME], axis=1)  # x, y, yaw


def log(pose, time=TIME):
    return Log(time, ("hip",), np.zeros((len(time), 1)), pose=pose)


def test_a_camera_that_is_shifted_and_turned_with_the_tag_sees_the_same_way():
    camera = np.array([0.4, -0.2, 2.0])
    seen = measured(log(compose(camera, WAY)), TIME, WAY)
    np.testing.assert_allclose(seen.pose, WAY, atol=1e-12)
    (said,) = seen.done
    first = "at (0.4, -0.2) m and 114.6 degrees in their frame"
    assert said == f"poses are counted from the first one, {first}"
    assert measured(log(WAY), TIME, WAY).done == ()


def test_a_camera_whose_axes_are_turned_against_the_yaw_is_turned_back_and_said():
    turned = compose(np.array([1.0, 0.0, 0.7]), WAY)
    turned[:, 2] = WAY[:, 2]  # of a gyroscope, which begins at 0
    seen = measured(log(turned), TIME, WAY)
    np.testing.assert_allclose(seen.pose, WAY, atol=1e-12)
    _, said = seen.done
    assert said.startswith("its frame is turned by 40.1 degrees against the robot")


def test_a_pose_that_was_misread_once_turns_no_frame():
    wild = WAY.copy()
    wild[20] = 5.0, 5.0, 2.0
    assert not any("turned" in said for said in measured(log(wild), TIME, WAY).done)


def test_a_sensor_that_is_upside_down_rolls_across_the_half_turn():
    """Its numbers jump from one half turn to the other, and it does not."""
    roll = np.pi + 0.01 * np.sin(TIME)
    wrapped = (roll + np.pi) % (2 * np.pi) - np.pi
    lean = np.stack([wrapped, 0 * TIME], axis=1)
    seen = measured(replace(log(WAY), lean=lean), TIME, WAY)
    np.testing.assert_allclose(seen.lean["roll"], 0.01 * np.sin(TIME), atol=1e-12)


def test_a_robot_that_veers_is_not_turned_back():
    veering = np.stack([0.1 * np.sin(TIME), 0.1 * (1 - np.cos(TIME)), TIME], axis=1)
    straight = np.stack([0.1 * TIME, 0 * TIME, 0 * TIME], axis=1)
    seen = measured(log(veering), TIME, straight)
    np.testing.assert_allclose(seen.pose, veering, atol=1e-12)


def test_gaps_are_bridged_and_a_yaw_that_nobody_measured_is_the_predictions():
    holes = WAY.copy()
    holes[5:8] = np.nan
    holes[:, 2] = np.nan
    seen = measured(log(holes), TIME, WAY)
    np.testing.assert_allclose(seen.pose, WAY, atol=2e-4)
    assert seen.done == (
        "body.x, body.y: empty cells bridged, 3 in each",
        "no yaw was measured; that of the prediction is taken",
    )


@pytest.mark.parametrize("seen", [1, 7, len(TIME) - 1, len(TIME)])
def test_a_pose_that_is_held_because_no_later_one_was_measured_is_told(seen):
    lost = WAY.copy()
    lost[seen:] = np.nan
    done = measured(log(lost), TIME, WAY).done
    words = f"empty cells bridged, {len(TIME) - seen} in each"
    held = f"body.x, body.y, body.yaw: {words}; held after {TIME[seen - 1]:.4g} s"
    assert (held in done) == (seen < len(TIME))


def test_gaps_are_told_by_columns_with_what_is_held_at_their_ends():
    pose, lean = WAY.copy(), WAY[:, :2].copy()
    pose[:3, 1] = pose[-2:, 2] = lean[:3, 0] = lean[[0, 9, -1], 1] = np.nan
    done = measured(replace(log(pose), lean=lean), TIME, WAY).done
    assert done == (
        "body.y, body.roll: empty cells bridged, 3 in each; held before 0.15 s",
        "body.yaw: empty cells bridged, 2 in each; held after 1.9 s",
        "body.pitch: empty cells bridged, 3 in each; "
        "held before 0.05 s and after 1.95 s",
    )


def test_a_yaw_alone_and_standard_errors_of_some_columns_are_left_out_and_told():
    alone = np.full_like(WAY, np.nan)
    alone[:, 2] = TIME
    seen = measured(log(alone), TIME, WAY)
    assert seen.pose is None
    assert seen.done == ("body.yaw is left out, since there is no body.x and body.y",)
    spread = np.full_like(WAY, 1e-3)
    assert measured(replace(log(WAY), spread=spread), TIME, WAY).spread is not None
    spread[:, 0] = np.nan
    seen = measured(replace(log(WAY), spread=spread), TIME, WAY)
    assert seen.spread is None
    assert seen.done[0].startswith("standard errors are left out, since body.x, ")


def test_trials_become_their_mean_and_its_standard_error():
    offsets = np.array([-0.01, 0.0, 0.01])
    logs = [
        log(WAY + TIME[:, None] * [offset / 2, 0, 0], TIME * (1 + 1e-9 * k))
        for k, offset in enumerate(offsets)
    ]
    mean = together(logs)
    np.testing.assert_allclose(mean.pose, WAY, atol=1e-9)
    assert mean.spread[-1, 0] == pytest.approx(0.01 / np.sqrt(3), rel=1e-6)
    assert mean.done == ("mean of 3 trials, with its standard error",)


def test_trials_of_other_commands_are_told_apart():
    other = replace(log(WAY), commanded=np.full((41, 1), 0.1))
    said = together([log(WAY), other]).done[0]
    assert "commands of trial 2 differ by up to 5.7 degrees" in said


def test_a_trial_that_ends_before_the_first_has_no_other_commands():
    turning = replace(log(WAY), commanded=TIME[:, None] / TIME[-1])
    half = log(WAY[:20], TIME[:20])
    half = replace(half, commanded=turning.commanded[:20])
    assert not any("commands of" in said for said in together([turning, half]).done)
    with pytest.raises(ValueError, match="trial 2 commands other joints"):
        together([log(WAY), replace(log(WAY), joints=("knee",))])


def test_a_log_that_measured_nothing_is_none():
    assert measured(log(None), TIME, WAY) is None


def test_roll_and_pitch_are_counted_from_the_first_row_for_a_sensor_sits_askew():
    lean = np.stack([0.1 * TIME, 0.03 * np.sin(TIME)], axis=1)
    seen = measured(replace(log(None), lean=lean + [0.5, -0.2]), TIME, WAY)
    assert seen.pose is None
    np.testing.assert_allclose([*seen.lean.values()], lean.T, atol=1e-12)


def test_roll_and_pitch_of_trials_become_their_means():
    lean = np.stack([0.1 * TIME, 0.03 * np.sin(TIME)], axis=1)
    logs = [replace(log(WAY), lean=k * lean + 0.4 * k) for k in (1, 2, 3)]
    np.testing.assert_allclose(together(logs).lean, 2 * lean, atol=1e-12)


def test_trials_that_lack_a_column_are_left_out_of_the_mean_and_told():
    """Whichever comes first; a mean of one is that one, without a standard error."""
    bare, flat = log(None), log(WAY * [1, 1, np.nan])
    for trials in ([log(WAY), bare], [bare, log(WAY)], [flat, bare, log(WAY), flat]):
        mean = together(trials)
        np.testing.assert_allclose(mean.pose, WAY, atol=1e-12)
        assert mean.spread is None
        assert len(mean.done) == len(trials) - 1
    assert mean.done[0] == (
        "trial 1 has no body.yaw, and is left out beside those that have"
    )
    alike = together([flat, flat])
    np.testing.assert_allclose(alike.pose, flat.pose, atol=1e-12)
    assert measured(alike, TIME, WAY).spread is None


def test_a_mean_ends_where_the_first_trial_lost_the_body_and_that_is_told():
    lost = WAY.copy()
    lost[20:] = np.nan
    mean = together([log(WAY), log(lost)])
    assert np.isfinite(mean.pose[:21]).all()
    assert not np.isfinite(mean.pose[21:]).any()
    told = (
        "body.x, body.y, body.yaw: empty cells bridged, 21 in each; held after 0.95 s"
    )
    assert mean.done[0] == f"trial 2, {told}"
    seen = measured(mean, TIME, WAY)
    np.testing.assert_allclose(seen.pose[20:, 0], 0.1 * TIME[20], atol=0.003)
    assert seen.done[0].endswith("empty cells bridged, 20 in each; held after 1 s")


def test_a_place_counts_more_than_angles_however_many():
    """Of a trial with a gyroscope and one with a camera that saw no heading."""
    flat, lean = log(WAY * [1, 1, np.nan]), WAY[:, :2]
    turning = replace(log(WAY * [np.nan, np.nan, 1]), lean=lean)
    for trials in ([flat, turning], [turning, flat]):
        mean = together(trials)
        np.testing.assert_allclose(mean.pose[:, :2], WAY[:, :2], atol=1e-12)
        assert any(
            "has no body.x, body.y, and is left out" in word for word in mean.done
        )


def test_a_column_that_one_trial_loses_leaves_the_others_as_they_are():
    lost = WAY.copy()
    lost[20:, 2] = np.nan
    mean = together([log(WAY), log(lost)])
    np.testing.assert_allclose(mean.pose[:, :2], WAY[:, :2], atol=1e-12)
    assert not np.isfinite(mean.pose[21:, 2]).any()


def test_sensors_of_trials_may_take_turns():
    """No row has both, as of a camera and a sensor of lean that are read in turn."""
    even = (np.arange(len(TIME)) % 2 == 0)[:, None]
    lean = np.where(even, np.nan, 0.1 * WAY[:, :2])
    trial = replace(log(np.where(even, WAY, np.nan)), lean=lean)
    mean = together([trial, trial])
    np.testing.assert_allclose(mean.pose, WAY, atol=1e-3)
    assert np.isfinite(mean.lean).all()


def test_joints_and_contacts_of_later_trials_are_left_out_and_that_is_told():
    contact = {1: np.ones(len(TIME))}
    trials = [log(WAY), replace(log(WAY), contact=contact)]
    assert "joints and contacts that trials after" in together(trials).done[0]
    assert len(together(trials[::-1]).done) == 1
