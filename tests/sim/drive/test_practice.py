"""Practice: what commands add, so that slack in servos and gears does not show."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner.systems.flows import Flow
from sim.drive.drive import Drive
from sim.drive.feed_forward import FeedForward
from sim.drive.rehearsal import Beforehand, Practice, Practised
from sim.motion.schedule import Scheduler
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from tests.walks import simulated

BAND = 0.0087


@pytest.fixture
def classroom(scenario):
    def make(**given):
        return prepare(scenario(robot="hexapod-classroom", **given))

    return make


def stroke(setup):
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(0.2)
    scheduler.flow(Flow("1", "g1_1", 0.1), setup.equations.swings["g1_1"])
    scheduler.hold(0.2)
    return scheduler.finish()


@pytest.mark.physics
@pytest.mark.parametrize(
    "slack",
    [
        {"dead_band": BAND},
        {"backlash": BAND, "assumed_backlash": BAND},
    ],
    ids=str,
)
def test_a_practised_stroke_ends_where_it_would_without_slack(classroom, slack):
    setup = classroom(resolution=0.0, **slack)
    schedule = stroke(setup)
    made_up, practised = Beforehand(setup, Drive(setup)).feed_forward(schedule)

    def angles(walking, shifts):
        found, _ = Practised(walking).walk(schedule, made_up, shifts)
        return found.values

    wanted = angles(setup.as_planned, None)
    missed = [angles(setup, shifts) - wanted for shifts in (None, practised)]
    off, left = (float(np.sqrt((miss**2).mean())) for miss in missed)
    assert off > BAND / 4
    assert left < off / 2  # measured: a quarter to 0.35
    # no command is shifted by more than the whole slack
    assert np.abs(practised.values).max() <= BAND


def test_only_what_is_assumed_is_practised(classroom):
    assert not Drive(classroom()).practises
    assert Drive(classroom(dead_band=BAND)).practises
    assert not Drive(classroom(dead_band=BAND, assumed_dead_band=0.0)).practises
    assert not Drive(classroom(dead_band=BAND).as_planned).practises
    assert not Drive(classroom(backlash=BAND)).practises
    assumed = classroom(dead_band=BAND, assumed_dead_band=0.01).scenario.as_assumed
    assert (assumed.dead_band, assumed.backlash) == (0.01, 0.0)


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "segments", "yaw", "band", "turned"),
    [
        ("line", 10, 0.0, BAND, 0.5),
        ("line", 10, 0.0, 0.0175, 1.0),
        ("diagonal", 8, np.pi / 8, BAND, 0.5),
    ],
)
def test_a_quarter_of_a_walk_is_practised(name, segments, yaw, band, turned):
    """Measured: 0.6, 0.15 and 0.9 % and 0.15 degrees; without practice 4 and 3."""
    goal = [0.0375, 0.0375, yaw]
    given = {"robot": "hexapod-classroom", "path.goal": goal, "segments": segments}
    summary = simulated(load_scenario(name, given | {"dead_band": band})).summary
    off = summary["error"]["goal"]
    assert 100 * off["position"] / np.hypot(*goal[:2]) <= 1.5
    assert np.degrees(abs(off["yaw"])) <= turned


def test_practice_adds_what_is_missed_and_half_a_count_besides():
    """Of a robot whose joints hang 0.3 and -0.2 rad beside what they are told."""
    hang, half = np.array([0.3, -0.2]), np.array([0.05, -0.1])
    wanted = FeedForward(np.zeros((4, 2)), 10)

    def walk(schedule, made_up, shifts):
        if shifts is None:
            return wanted, np.zeros(3)
        reached = shifts.values - hang
        off = np.abs(reached - half).max()  # from what would be best
        return replace(wanted, values=reached), np.array([off, 0.0, 0.0])

    engine = SimpleNamespace(moment=0, rewind=lambda moment: None)
    kinematics = SimpleNamespace(reach=0.2)
    loose = SimpleNamespace(
        engine=engine, drive=[], walk=walk, setup=SimpleNamespace(kinematics=kinematics)
    )
    own = SimpleNamespace(
        _tight=SimpleNamespace(walk=walk), _loose=loose, _shift=half, _width=np.ones(2)
    )
    found = Practice.shifts(own, None, None)
    assert found.values == pytest.approx(np.tile(hang + half, (4, 1)), abs=1e-3)
