"""Verdicts and causes at both sides of their borders, on a walk changed by hand."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sim.evaluation.causes import Evidence, likely_cause
from sim.evaluation.deviations import Scale, sensed
from sim.evaluation.phases import (
    carried_out,
    commanded_pace,
    count_changes,
    moving_time,
    standing_slip,
    swing_travel,
)
from sim.evaluation.summary import DEGREE, Departure, Weighed
from sim.evaluation.verdict import _by_the_nearest, _share, judge
from sim.physics.measure import ContactLog
from sim.scenarios.file import load_scenario
from tests.sim.evaluation.test_causes import with_recording, with_settings, with_setup
from tests.walks import simulated


@pytest.fixture(scope="module")
def evidence():
    """A walk of 10 mm on which nothing is wrong."""
    short = {"path.goal": [0.01, 0.0, 0.0], "segments": 1}
    found = simulated(load_scenario("line", short)).evaluation
    return Evidence(found.walk, found.achieved, found.predicted, found.weighed)


def weighed(evidence, **changes):
    return replace(evidence, weighed=replace(evidence.weighed, **changes))


def verdict(evidence):
    return judge(evidence, evidence.walking)


def test_a_walk_that_ends_as_planned_arrived(evidence):
    found = verdict(evidence)
    assert found.word == "arrived"
    assert found.text.startswith("arrived 0.")
    assert " mm from the goal and 0." in found.text


@pytest.mark.parametrize(("degrees", "fell"), [(29.5, False), (30.5, True)])
def test_a_body_that_tilts_by_thirty_degrees_has_fallen(evidence, degrees, fell):
    moments = evidence.walk.recording.moments
    qpos = moments.qpos.copy()
    root = evidence.walk.setup.robot.root_address_in(evidence.walk.setup.model)
    half, row = np.radians(degrees) / 2, len(qpos) // 2
    qpos[row, root + 3 : root + 7] = [np.cos(half), np.sin(half), 0, 0]
    changed = with_recording(evidence, moments=moments._replace(qpos=qpos))
    found = verdict(changed)
    assert (found.word == "fell") == fell
    if fell:
        seconds = moments.step[row] * evidence.walk.setup.limits.timestep
        how = f"fell at {seconds:.1f} s: the body tilted by {degrees:.0f} degrees;"
        assert found.text.startswith(how)
        before = np.arange(len(moments.step)) > row
        assert judge(changed, before & evidence.walking).word != "fell"


@pytest.mark.parametrize(("share", "fell"), [(0.48, False), (0.52, True)])
def test_a_body_that_loses_half_its_height_has_fallen(evidence, share, fell):
    kinematics = evidence.walk.setup.kinematics
    height = kinematics.center_of_mass[2] - kinematics.standing.height.min()
    center = evidence.achieved.center_of_mass.copy()
    first = int(evidence.walking.argmax())
    center[-1, 2] = center[first, 2] - share * height
    found = verdict(
        replace(evidence, achieved=replace(evidence.achieved, center_of_mass=center))
    )
    assert (found.word == "fell") == fell
    if fell:
        lost = 1e3 * share * height
        assert f"the body sank by {lost:.0f} of {1e3 * height:.0f} mm" in found.text


@pytest.mark.parametrize(
    ("own", "walls", "said"),
    [
        (1, 0, "parts of the robot touched each other 1 time;"),
        (2, 0, "parts of the robot touched each other 2 times;"),
        (0, 1, "the robot touched obstacles 1 time;"),
        (3, 4, "touched each other 3 times and the robot touched obstacles 4 times;"),
    ],
)
def test_whatever_touches_is_counted(evidence, own, walls, said):
    touched = with_recording(evidence, self_contacts=own, wall_contacts=walls)
    found = verdict(touched)
    assert found.word == "collided"
    assert said in found.text


@pytest.mark.parametrize(("goal", "word"), [(0.049, "arrived"), (0.051, "missed")])
def test_a_twentieth_of_the_path_is_missed(evidence, goal, word):
    found = verdict(weighed(evidence, goal=goal))
    assert found.word == word
    if word == "missed":
        assert f"missed its goal by {100 * goal:.1f} % of the path" in found.text
    assert verdict(weighed(evidence, goal=None)).word == "arrived"


@pytest.mark.parametrize(
    ("farthest", "ended", "word"),
    [
        (0.249, 0.0, "arrived"),
        (0.251, 0.0, "drifted"),
        (0.049, 0.03, "arrived"),
        (0.051, 0.03, "drifted"),
    ],
)
def test_the_way_counts_less_where_the_end_is_good(evidence, farthest, ended, word):
    changed = weighed(evidence, farthest=farthest, ended=ended, goal=None)
    found = verdict(changed)
    assert found.word == word
    if word == "drifted":
        assert f"{100 * farthest:.1f} % of the path" in found.text
        assert (
            "off the quasi-static prediction" in found.text or " off the " in found.text
        )


@pytest.mark.parametrize(("more", "word"), [(0.09, "arrived"), (0.11, "slipped")])
def test_a_tenth_more_slip_than_predicted_is_told_where_the_body_slid_too(
    evidence, more, word
):
    """Of feet that stand while legs swing; the worst leg is named."""
    walk, best = evidence.walk, evidence.best
    foreseen = standing_slip(walk, best.slip)
    ratio = foreseen.sum() * (1 + more) / standing_slip(walk).sum()
    slip = walk.recording.moments.slip * ratio
    moments = walk.recording.moments._replace(slip=slip)
    slid = with_recording(
        weighed(evidence, ended=0.03, goal=None, farthest=0.03), moments=moments
    )
    found = verdict(slid)
    assert found.word == word
    if word == "slipped":
        total = 1e3 * foreseen.sum()
        assert (
            f"its feet slid {total * (1 + more):.1f} mm where {total:.1f} mm"
            in found.text
        )
        apart = standing_slip(slid.walk) - foreseen
        leg = walk.setup.robot.legs[int(apart.argmax())]
        assert f"the foot of leg {leg} most of all" in found.text
        near = weighed(slid, ended=0.019)
        assert verdict(near).word == "arrived"


def of(goal=0.1, ended=0.1, radius=0.2):
    return Weighed(
        prediction="ideal",
        radius=radius,
        length=1.0,
        goal=goal,
        ended=ended,
        farthest=0.1,
    )


@pytest.mark.parametrize(
    ("off", "weight", "said"),
    [
        (Departure(position=0.05, yaw=0.1), of(), "10.0 % of the path, yaw included"),
        (Departure(position=0.05, yaw=0.3), of(), "most of it by a yaw of 17 degrees"),
        (Departure(position=0.05, yaw=0.3), of(0.02, 0.02), "10.0 % of the path"),
        (Departure(position=0.05, yaw=0.3), of(0.021, 0.0), "most of it by a yaw"),
        (Departure(position=0.05, yaw=0.25), of(), "10.0 % of the path, yaw included"),
    ],
)
def test_a_share_says_what_yaw_has_to_do_with_it(off, weight, said):
    assert said in _share(weight, 0.1, off)
    assert ("yaw" in _share(weight, 0.1, off)) == ("yaw" in said)


@pytest.mark.parametrize(
    ("goal", "ended", "farthest", "changed"),
    [
        (0.05, 0.03, 0.06, True),
        (0.051, 0.03, 0.06, False),  # it missed its goal as well
        (0.05, 0.01, 0.06, True),
        (0.01, 0.01, 0.06, False),  # it ended well
        (0.05, 0.03, 0.05, False),  # it is not far
        (0.05, 0.03, 0.25, True),
        (0.05, 0.03, 0.251, False),  # it is too far
        (None, 0.03, 0.06, False),
    ],
)
def test_a_walk_that_one_prediction_alone_misses_is_judged_by_the_nearest(
    evidence, goal, ended, farthest, changed
):
    asked = weighed(evidence, goal=goal, ended=ended, farthest=farthest)
    found = _by_the_nearest(asked, evidence.walking)
    assert (found is not asked) == changed
    if changed:
        each = {
            name: Scale(name, asked.weighed.radius, asked.weighed.length)
            .weigh(
                evidence.achieved.pose[evidence.walking],
                made.pose[evidence.walking],
                evidence.walk.setup.scenario.goal,
            )
            .farthest
            for name, made in evidence.predicted.items()
        }
        assert found.weighed.prediction == min(each, key=each.get)


def test_words_beyond_a_tolerance_name_what_is_off():
    far = Weighed(
        prediction="quasi_static",
        radius=0.2,
        length=1.0,
        goal=0.3,
        ended=0.1,
        farthest=0.2,
    )
    both = far.beyond(0.1)
    assert both == (
        "30 % of its path off its goal and 20 % of its path off the quasi-static "
        "prediction, yaw included"
    )
    assert far.beyond(0.25) == "30 % of its path off its goal, yaw included"
    assert far.beyond(0.3) == ""
    well = replace(far, goal=0.02, ended=0.02)
    assert well.beyond(0.1) == "20 % of its path off the quasi-static prediction"
    assert replace(far, goal=None, ended=0.02).ended_well
    assert not replace(far, goal=None, ended=0.021).ended_well


@pytest.mark.parametrize(
    ("yaw", "said"), [(0.99, "2.50 mm"), (1.01, "2.50 mm and 1.0 degrees")]
)
def test_yaw_is_told_from_a_degree_on(yaw, said):
    assert str(Departure(position=0.0025, yaw=yaw * DEGREE)) == said


def bouncing(evidence, per_landing):
    landings = 3 * sum(p.kind == "land" for p in evidence.walk.phases)
    bounces = np.zeros(6, dtype=int)
    bounces[2] = round(per_landing * landings)
    return with_recording(evidence, bounces_of=bounces)


@pytest.mark.parametrize(("each", "told"), [(5.0, False), (5.2, True)])
def test_five_bounces_a_touchdown_are_a_cause(evidence, each, told):
    assert ("bounced" in likely_cause("drifted", bouncing(evidence, each))) == told


@pytest.mark.parametrize(("share", "light"), [(0.19, True), (0.21, False)])
def test_joints_of_a_fifth_of_a_motors_inertia_are_light(evidence, share, light):
    from sim.world.motors import inertia_share

    robot, model = evidence.walk.setup.robot, copy(evidence.walk.setup.model)
    leg = robot.leg_cards[2]
    own = inertia_share(robot, model, (leg.swing, leg.lift))
    model.dof_M0[:] *= share / own
    said = likely_cause("drifted", with_setup(bouncing(evidence, 9.0), model=model))
    assert (f"{100 * share:.0f} % of the inertia of a motor" in said) == light
    assert ("too stiff" in said) != light


@pytest.mark.parametrize(("part", "told"), [(0.0095, False), (0.0105, True)])
def test_a_servo_at_its_limit_in_a_hundredth_of_all_steps_is_named(
    evidence, part, told
):
    limited = np.zeros(evidence.walk.setup.model.nu)
    limited[3] = part * evidence.walk.steps
    found = likely_cause("fell", with_recording(evidence, limited=limited))
    assert ("gave all its" in found) == told


@pytest.mark.parametrize(("bent", "told"), [(0.029, False), (0.031, True)])
def test_servos_that_lag_by_30_mrad_on_average_are_soft(evidence, bent, told):
    model, moments = evidence.walk.setup.model, evidence.walk.recording.moments
    place = model.joint("lift_6").qposadr[0]
    qpos, walking = moments.qpos.copy(), evidence.walking
    ctrl = np.concatenate(list(evidence.walk.commands()))[moments.step[walking] - 1]
    qpos[walking, place] = ctrl[:, evidence.drives["lift_6"]] + bent * (
        -1
    ) ** np.arange(walking.sum())
    changed = with_recording(evidence, moments=moments._replace(qpos=qpos))
    said = likely_cause("drifted", changed)
    assert ("'lift_6'" in said) == told
    assert (f"is {1e3 * bent:.0f} mrad off" in said) == told


@pytest.mark.parametrize(("share", "told"), [(0.04, True), (0.06, False)])
def test_a_foot_that_carries_in_a_twentieth_of_its_time_never_does(
    evidence, share, told
):
    contact, walking = evidence.achieved.contact.copy(), evidence.walking
    planned = np.flatnonzero(evidence.best.contact[:, 4] & walking)
    contact[:, 4] = False
    contact[planned[: round(share * len(planned))], 4] = True
    changed = replace(evidence, achieved=replace(evidence.achieved, contact=contact))
    assert ("leg 5 never carried" in likely_cause("fell", changed)) == told


@pytest.mark.parametrize(("used", "told"), [(0.49, False), (0.51, True)])
def test_a_slope_that_takes_half_of_the_friction_is_steep(evidence, used, told):
    steep = with_settings(
        evidence, slope=(float(np.arctan(used * 0.4)), 0.0), friction=0.4
    )
    said = likely_cause("drifted", steep)
    assert (f"takes {100 * used:.0f} % of the friction" in said) == told


@pytest.mark.parametrize(("used", "told"), [(0.49, False), (0.51, True)])
def test_strokes_that_take_half_of_what_friction_holds_are_hasty(evidence, used, told):
    rates = np.linalg.norm(evidence.walk.setup.kinematics.standing.rates, axis=-1)
    held = evidence.walk.setup.scenario.friction * 9.81
    hasty = with_settings(evidence, swing_acceleration=used * held / float(rates.max()))
    assert ("swing_acceleration" in likely_cause("slipped", hasty)) == told


def test_lifts_swings_and_times_of_a_walk_are_counted(evidence):
    walk = evidence.walk
    switches, fastest = commanded_pace(walk)
    kinds = [p.kind for p in walk.phases]
    assert switches == kinds.count("lift") + kinds.count("land")
    assert count_changes(walk) == switches
    moving = [p for p in walk.phases if p.kind != "hold"]
    dt = walk.setup.limits.timestep
    assert moving_time(walk) == pytest.approx((moving[-1].stop - moving[0].start) * dt)
    swings = [p for p in walk.phases if p.kind == "swing"]
    groups = walk.setup.robot.groups
    loaded, free = (swing_travel(swings, groups, loaded=way) for way in (True, False))
    whole = sum(abs(p.amount) * sum(map(abs, p.direction)) for p in swings)
    assert loaded + free == pytest.approx(whole)
    assert 0 < loaded < whole
    peaks, schedule = [], walk.stretches[-1].schedule
    for phase in swings:  # by the commands themselves
        rows = np.arange(phase.start, phase.stop) - schedule.start
        swing, _ = schedule.angles(rows)
        peaks.append(np.abs(np.diff(swing, axis=0)).max() / dt)
    assert fastest == pytest.approx(max(peaks), rel=1e-2)
    told = carried_out(walk)
    assert [p.kind for p in told] == kinds
    assert told[-1].end == pytest.approx(walk.phases[-1].stop * dt)


def test_a_group_changes_when_its_last_foot_does(evidence):
    walk, own = evidence.walk, evidence.walk.setup.robot.group_of_leg == 0
    rows = np.ones((7, 6), dtype=bool)
    rows[1, np.flatnonzero(own)[0]] = False  # one foot alone is no lift-off
    rows[3:5, own] = False
    rows[5, np.flatnonzero(own)[0]] = False
    assert count_changes(walk, rows) == 2
    log = ContactLog(walk.starts + np.arange(7), rows)
    seen = replace(walk, recording=replace(walk.recording, contacts=log))
    assert count_changes(seen) == 2


def test_what_feedback_thinks_is_told_if_it_was_told_something(evidence):
    assert sensed(evidence.walk) is None
    exact = SimpleNamespace(
        feedback=SimpleNamespace(sensing=SimpleNamespace(is_exact=True))
    )
    assert sensed(SimpleNamespace(followed=exact)) is None
    stop = SimpleNamespace(expected=(0.3, 0.4, 3.1), true=(0.0, 0.0, -3.1))
    sensing = SimpleNamespace(is_exact=False, sees_position=True)
    followed = SimpleNamespace(
        feedback=SimpleNamespace(sensing=sensing), stops=[stop],
        claimed=(0.01, 0.02), bound=(0.003, 0.004),
    )  # fmt: skip
    found = sensed(SimpleNamespace(followed=followed))
    assert found.wrong == pytest.approx(0.5)
    assert found.wrong_yaw == pytest.approx(2 * np.pi - 6.2)
    assert (found.claimed, found.claimed_yaw) == (0.01, 0.02)
    assert (found.bound, found.bound_yaw) == (0.003, 0.004)
    assert found.thought == [0.3, 0.4, 3.1]
