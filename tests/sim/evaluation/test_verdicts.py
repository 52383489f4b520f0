"""Verdicts and causes at both sides of their borders, on a walk changed by hand."""

from dataclasses import replace

import numpy as np
import pytest

from sim.evaluation.causes import Evidence
from sim.evaluation.deviations import Scale
from sim.evaluation.phases import (
    standing_slip,
)
from sim.evaluation.summary import Departure, Weighed
from sim.evaluation.verdict import _by_the_nearest, _share, judge
from sim.scenarios.file import load_scenario
from tests.sim.evaluation.test_causes import with_recording
from tests.walks import simulated

DEGREE = np.deg2rad(1)  # of yaw, from which on it is put into words


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


@pytest.mark.parametrize(
    ("more", "length", "word"),
    [(0.09, 0.01, "arrived"), (0.11, 0.01, "slipped"), (0.11, 10.0, "arrived")],
)
def test_a_tenth_more_slip_than_predicted_is_told_where_the_body_slid_too(
    evidence, more, length, word
):
    """Of feet that stand while legs swing; the worst leg is named."""
    walk, best = evidence.walk, evidence.best
    foreseen = standing_slip(walk, best.slip)
    ratio = foreseen.sum() * (1 + more) / standing_slip(walk).sum()
    slip = walk.recording.moments.slip * ratio
    moments = walk.recording.moments._replace(slip=slip)
    slid = with_recording(
        weighed(evidence, ended=0.03, goal=None, farthest=0.03, length=length),
        moments=moments,
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
