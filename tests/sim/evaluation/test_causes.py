"""Likely causes of walks that went wrong, found in what was measured."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

from sim.evaluation.causes import Evidence, likely_cause
from sim.evaluation.verdict import judge
from sim.feedback.stops import Followed, Stop
from sim.scenarios.file import load_scenario
from sim.scenarios.obstacles import decode
from tests.walks import simulated


@pytest.fixture(scope="module")
def evidence():
    """A walk of 10 mm on which nothing is wrong."""
    short = {"path.goal": [0.01, 0.0, 0.0], "segments": 1}
    found = simulated(load_scenario("line", short)).evaluation
    return Evidence(found.walk, found.achieved, found.predicted, found.weighed)


def with_recording(evidence, **changed):
    recording = replace(evidence.walk.recording, **changed)
    return replace(evidence, walk=replace(evidence.walk, recording=recording))


def with_setup(evidence, **changed):
    setup = replace(evidence.walk.setup, **changed)
    return replace(evidence, walk=replace(evidence.walk, setup=setup))


def with_settings(evidence, **changed):
    scenario = replace(evidence.walk.setup.scenario, **changed)
    return with_setup(evidence, scenario=scenario)


def bouncing(evidence):
    bounces = np.array([0, 3, 0, 140, 0, 2])  # on 18 touchdowns of feet
    return with_recording(evidence, bounces_of=bounces)


def test_where_nothing_is_known_the_worst_phases_are_named(evidence):
    assert likely_cause("drifted", evidence).startswith("most of it arose in '")
    assert likely_cause("fell", evidence) == ""


def test_feet_that_bounce_are_blamed_on_servos_too_stiff_for_the_pace(evidence):
    found = likely_cause("drifted", bouncing(evidence))
    assert "bounced 145 times, most often the one on joints 'swing_4'" in found
    assert "N m/rad are too stiff for a timestep of 1 ms" in found
    paced = replace(evidence.walk.setup.servo, rate=50.0)
    found = likely_cause("drifted", with_setup(bouncing(evidence), servo=paced))
    assert "too stiff for 50 commands a second" in found


def test_feet_that_bounce_on_light_joints_are_blamed_on_that(evidence):
    model = copy(evidence.walk.setup.model)
    model.dof_M0[:] -= 0.99 * model.dof_armature
    found = likely_cause("drifted", with_setup(bouncing(evidence), model=model))
    # the leg's 0.0002 kg m^2 alone; a motor's 0.0051 s^2 times 4.2 N at 0.105 m
    assert "'swing_4' and 'lift_4', which have 11 % of the inertia of a motor" in found


def test_a_few_bounces_as_feet_come_down_are_no_cause(evidence):
    few = with_recording(evidence, bounces_of=np.array([10, 10, 5, 20, 0, 15]))
    assert "bounced" not in likely_cause("drifted", few)


def test_servos_at_their_limits_are_named(evidence):
    model = copy(evidence.walk.setup.model)
    model.actuator_forcerange[:] = (-1.5, 1.5)
    limited = np.zeros(model.nu, dtype=int)
    limited[model.actuator("lift_2").id] = evidence.walk.steps // 4
    found = with_recording(with_setup(evidence, model=model), limited=limited)
    said = "servo of joint 'lift_2' gave all its 1.5 N m in 25 % of the time"
    assert said in likely_cause("fell", found)
    aside = planned_aside(found, *found.predicted)  # which a plan for soft servos mends
    assert said in likely_cause("missed", aside)
    assert said not in likely_cause("missed", planned_aside(evidence, *found.predicted))


def test_a_foot_that_never_carried_load_is_named(evidence):
    contact = evidence.achieved.contact.copy()
    contact[:, 4] = False
    achieved = replace(evidence.achieved, contact=contact)
    found = likely_cause("missed", replace(evidence, achieved=achieved))
    assert found.startswith("the foot of leg 5 never carried load: ")


def test_a_floor_too_steep_for_its_friction_is_named(evidence):
    steep = with_settings(evidence, slope=(0.3, 0.0), friction=0.4)
    found = likely_cause("drifted", steep)
    assert "standing takes 77 % of the friction" in found  # tan(0.3) / 0.4
    slippery = with_settings(evidence, friction=0.0)
    assert "there is no friction" in likely_cause("missed", slippery)
    level = with_settings(evidence, slope=(0.1, 0.0))
    assert "know nothing of slope" in likely_cause("drifted", level)


def test_strokes_that_friction_does_not_hold_are_named(evidence):
    hasty = with_settings(evidence, swing_acceleration=500.0)
    assert "lower swing_acceleration" in likely_cause("slipped", hasty)


def test_counts_that_cannot_follow_loads_are_named_where_they_are_coarse(evidence):
    servo, said = evidence.walk.setup.servo, likely_cause("drifted", evidence)
    assert "a count of" not in said
    coarse = with_setup(evidence, servo=replace(servo, resolution=0.01))
    said = likely_cause("drifted", coarse)
    # each of the softest loads bends its servo by a hundredth of a degree
    assert "a count of 0.57 degrees raises a foot by" in said
    assert "bends its servo by 0.0 counts" in said
    assert "take servos with finer counts (servo)" in said
    fine = with_setup(evidence, servo=replace(servo, resolution=1e-6))
    assert "a count of" not in likely_cause("drifted", fine)


def test_bounces_on_counts_that_cannot_follow_loads_are_told_though_it_arrived(
    evidence,
):
    servo, bounced = evidence.walk.setup.servo, bouncing(evidence)
    coarse = with_setup(bounced, servo=replace(servo, resolution=0.01))
    said = judge(coarse, coarse.walking).text
    assert "prediction; feet bounced 145 times: a count of 0.57 degrees raises" in said
    twice = with_recording(coarse, bounces_of=np.array([0, 1, 0, 0, 1, 0]))
    slack = with_settings(coarse, backlash=0.01)  # of which feet bounce as well
    for other in (bounced, twice, slack):
        assert "bounced" not in judge(other, other.walking).text


def test_soft_servos_are_named(evidence):
    qpos = evidence.walk.recording.moments.qpos.copy()
    model = evidence.walk.setup.model
    qpos[:, model.joint("lift_6").qposadr[0]] += 0.1
    moments = evidence.walk.recording.moments._replace(qpos=qpos)
    found = likely_cause("drifted", with_recording(evidence, moments=moments))
    assert "the servo of joint 'lift_6', of 1000 N m/rad, is 100 mrad off" in found
    assert found.endswith("or let commands make up for it (feed_forward)")
    servo = replace(evidence.walk.setup.servo, feed_forward=True)
    led = with_setup(with_recording(evidence, moments=moments), servo=servo)
    found = likely_cause("drifted", led)
    assert found.endswith(
        "although these allow for its loads: take stiffer servos "
        "(servo_stiffness, or servo)"
    )


def test_settings_that_predictions_ignore_are_named_with_the_next_step(evidence):
    loaded = with_settings(evidence, payload=(0.1, 0.0, 0.0, 0.0), backlash=0.01)
    found = likely_cause("drifted", loaded)
    assert "know nothing of backlash, payload: plan again on the way (--rep" in found
    for without_plan in ({"replan": True}, {"motion": "gait.csv"}):
        again = with_settings(loaded, **without_plan)
        assert "a walk without it, or" in likely_cause("drifted", again)


def planned_aside(evidence, *names, by=0.004):
    """Predictions that end 4 mm aside, as the walk does."""
    off = np.array([0.0, by, 0.0])
    moved = {
        name: replace(found, pose=found.pose + off) if name in names else found
        for name, found in evidence.predicted.items()
    }
    weighed = replace(evidence.weighed, goal=0.4)
    return replace(evidence, predicted=moved, weighed=weighed)


def test_a_robot_that_readings_misled_is_told_how_far(evidence):
    """The last segment is planned from where it thought that it stood before."""
    pose = (0.0, 0.0, 0.0)
    told = {name: pose for name in Stop._fields} | {"segment": 0, "time": 1.0}
    stop = Stop(**told)
    off = stop._replace(thought=(0.003, -0.004, 0.02))
    missed = replace(evidence, weighed=replace(evidence.weighed, goal=0.5))
    setup = replace(missed.walk.setup, scenario=load_scenario("line", {"replan": True}))
    said = {}
    for stops in ((stop, stop), (off, stop), (off,)):
        followed = Followed(stops, setup.feedback(), learns=False)
        walk = replace(missed.walk, setup=setup, followed=followed)
        said[stops] = likely_cause("missed", replace(missed, walk=walk))
    assert said[off, stop] == (
        "it was misled: as it planned its last segment, it thought that it was 5.0 mm "
        "and 1.1 degrees from where it was: average more readings (sense_readings), or "
        "take a better sensor (sense)"
    )
    assert said[stop, stop] == said[off,] == ""


def test_a_plan_that_misses_on_paper_asks_for_segments_or_another_prediction(evidence):
    both = likely_cause("missed", planned_aside(evidence, "ideal", "quasi_static"))
    assert "the quasi-static prediction, the plan itself misses the goal by 40" in both
    assert "(--segments 2), or plan again on the way" in both
    real = likely_cause("missed", planned_aside(evidence, "quasi_static"))
    assert "--steer quasi-static finds a plan, if there is one" in real
    paper = with_settings(planned_aside(evidence, "quasi_static"), fields="paper")
    assert "never lifted drag: --set fields=lifted" in likely_cause("missed", paper)
    none = likely_cause("missed", planned_aside(evidence))
    assert "the plan itself" not in none


@pytest.mark.parametrize(
    ("own", "other", "said"),
    [
        (0.2, 0.0, ""),  # half of what the walk misses
        (0.21, 0.105, "--steer quasi-static finds a plan"),
        (0.4, 0.2, "--steer quasi-static finds a plan"),
        (0.4, 0.21, "or plan again on the way"),
    ],
)
def test_what_a_plan_misses_counts_from_half_of_what_is_missed(
    evidence, own, other, said, monkeypatch
):
    aside = planned_aside(evidence, "quasi_static")
    judge = aside.weighed.prediction
    shares = {judge: own}
    monkeypatch.setattr(Evidence, "on_paper", lambda self, key: shares.get(key, other))
    found = likely_cause("missed", aside)
    assert said in found
    assert ("the plan itself misses" in found) == bool(said)


def planned_soft(evidence, *names):
    """The compliant prediction as judge, which ends aside, as others of these names."""
    predicted = {**evidence.predicted, "compliant": evidence.predicted["quasi_static"]}
    soft = replace(evidence, predicted=predicted)
    aside = planned_aside(soft, "compliant", *names)
    weighed = replace(aside.weighed, prediction="compliant")
    return replace(aside, weighed=weighed)


def test_servos_that_yield_are_named_where_the_compliant_prediction_alone_misses(
    evidence,
):
    found = likely_cause("missed", planned_soft(evidence))
    assert "the plan reaches the goal on stiff servos" in found
    assert "these, of 1000 N m/rad, yield under load and miss it by 40" in found
    assert "(--steer compliant), let commands make up for it (--set feed_f" in found
    servo = replace(evidence.walk.setup.servo, feed_forward=True)
    led = likely_cause("missed", with_setup(planned_soft(evidence), servo=servo))
    assert "although commands allow for loads" in led
    assert "feed_forward" not in led
    loaded = with_settings(planned_soft(evidence), payload=(0.1, 0.0, 0.0, 0.0))
    assert "reaches the goal without payload" in likely_cause("missed", loaded)


def test_servos_are_no_cause_where_others_miss_as_well_or_it_was_steered_by(evidence):
    both = likely_cause("missed", planned_soft(evidence, "quasi_static"))
    steered = with_settings(planned_soft(evidence), steer="compliant")
    for said in (both, likely_cause("missed", steered)):
        assert "the plan itself misses" in said
        assert "yield" not in said


@pytest.mark.parametrize(
    ("foreseen", "remedy"), [(0.45, "--steer quasi-static"), (0.55, "--segments 2")]
)
def test_segments_are_too_few_where_the_ideal_fields_miss_by_most_of_it(
    evidence, foreseen, remedy
):
    missed = planned_aside(evidence, "quasi_static")
    some = planned_aside(missed, "ideal", by=0.004 * foreseen)
    assert remedy in likely_cause("missed", some)


def test_a_robot_that_touches_itself_needs_smaller_strokes(evidence):
    assert "--segments 2" in likely_cause("collided", evidence)
    walls = with_recording(evidence, wall_contacts=1)
    assert "out of the file" in likely_cause("collided", walls)
    box = decode([{"kind": "box", "center": [2.0, 2.0], "size": [0.5, 0.5]}])
    among = with_settings(walls, obstacles=box)
    assert "min_clearance" in likely_cause("collided", among)
