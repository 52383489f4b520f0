"""What is laid out and seen of a plan before it is walked."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner import Flow
from sim.drive import rehearsal
from sim.drive.drive import Drive
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from sim.walking import finished
from sim.walking.finished import Ahead, laid_out
from sim.walking.walks import Walker

PLAN = SimpleNamespace(segments=lambda: iter([[Flow("1", "g1_1", 0.05)]]))
SOFT = {"servo_stiffness": 50.0, "servo_damping": 1.0}


@pytest.fixture(scope="module")
def setup():
    return prepare(load_scenario("line"))


def test_every_stretch_has_the_torques_of_its_own_schedule_where_servos_are_soft(
    setup, monkeypatch
):
    def torques(schedule):
        return "torques of", schedule

    fake = SimpleNamespace(torques=torques)
    monkeypatch.setattr(rehearsal, "Rehearsal", lambda _: fake)
    monkeypatch.setattr(Drive, "require_strength", lambda *_: None)
    standing, walking = laid_out(prepare(load_scenario("line", SOFT)), PLAN)
    for stretch in (standing, walking):
        assert stretch.torques == ("torques of", stretch.schedule)
        assert stretch.pose.tolist() == [0, 0, 0]
    assert walking.schedule.start == standing.schedule.stop > 0
    # stiff servos may be rehearsed for their strength, which changes no command
    with monkeypatch.context() as here:
        here.setattr(Drive, "rehearsed", True)
        assert [stretch.torques for stretch in laid_out(setup, PLAN)] == [None, None]
    soft = prepare(load_scenario("line", SOFT | {"feed_forward": False}))
    assert [stretch.torques for stretch in laid_out(soft, PLAN)] == [None, None]


def test_what_is_practised_for_slack_is_seen_ahead(monkeypatch):
    """The commands that are aimed are those that `Walker` gives."""
    practice = SimpleNamespace(shifts=lambda schedule, _: ("shifts of", schedule))
    monkeypatch.setattr(rehearsal, "Practice", lambda _: practice)
    loose = prepare(load_scenario("line", {"dead_band": 0.005}))
    for stretch in laid_out(loose, PLAN):
        assert stretch.practised == ("shifts of", stretch.schedule)


def test_a_plan_ends_where_all_its_commands_have_led(setup, monkeypatch):
    lasting = laid_out(setup, PLAN)[-1].schedule.stop

    def course_of(known, phases, legs, rows):
        ends = [leg.schedule.stop for leg in legs]
        assert ends[-1] == lasting > ends[0]
        return sum(map(len, rows))

    def follow(course):
        """A body that goes a millimetre with every command."""
        return SimpleNamespace(pose=np.outer(1e-3 * np.arange(course + 1), [1, 0, 0]))

    fake = SimpleNamespace(follow=follow)
    monkeypatch.setattr(finished, "phases_of", lambda _: fake)
    monkeypatch.setattr(finished, "course_of", course_of)
    end = Ahead(setup).end(setup, PLAN)
    assert end.tolist() == pytest.approx([1e-3 * lasting, 0, 0])


def test_a_walk_that_never_began_starts_at_the_origin(setup):
    recorder = SimpleNamespace(finish=lambda: "recorded")
    own = SimpleNamespace(setup=setup, _stretches=[], _recorder=recorder, seconds={})
    for origin, told in ((None, [0, 0, 0]), (np.array([1.0, 2.0, 0.5]), [1, 2, 0.5])):
        own._origin = origin
        walk = Walker.finish(own, 3)
        assert walk.origin.tolist() == told
        assert (walk.saturated_segments, walk.recording) == (3, "recorded")
