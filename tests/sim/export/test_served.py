"""Walks whose commands go elsewhere, as `drive` serves them."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from models import SERVO_KINDS, JointServo, load
from planner import PlannerError
from sim.cli import main
from sim.errors import UsageError
from sim.export.served import served
from sim.scenarios.file import load_scenario


@pytest.mark.physics
def test_a_segment_in_which_nothing_moves_has_no_commands():
    still = {"segments": 2, "path.goal": [0.0, 0.0, 0.0]}
    soft, loose = {"robot": "hexapod-classroom"}, {"assumed_dead_band": 0.01}
    for given in ({}, soft, loose, soft | {"feed_forward": "predicted"}):
        walk = served(load_scenario("line", still | given))
        assert len([*walk.stand()]) > 1
        assert [*walk.walk(0)] == []


def test_a_walk_without_end_is_refused_before_it_begins(monkeypatch):
    """All commands of a segment are held, as many as a robot's card makes them."""
    monkeypatch.setattr("sim.preparation.scheduling.MOST_STEPS", 20_000)
    given = {"segments": 2, "path.goal": [0.007, 0, 0]}
    served(load_scenario("line", given))
    with pytest.raises(UsageError, match="physics steps"):
        served(load_scenario("line", given | {"swing_speed": 0.01}))


@pytest.mark.physics
def test_what_servos_of_the_card_cannot_reach_is_not_sent():
    robot = load("hexapod-classroom")
    servos = {"lift_1": JointServo(limits=(-0.05, 0.1))}
    robot = replace(robot, card=replace(robot.card, joint_servos=servos))
    given = {"segments": 1, "path.goal": [0.007, 0, 0], "robot": "hexapod-classroom"}
    walk = served(load_scenario("line", given), robot)
    with pytest.raises(
        UsageError, match="joint 'lift_1' goes to .* its servo from -0."
    ):
        list(walk.walk(0))


@pytest.mark.physics
def test_a_robot_that_waits_between_segments_is_foreseen_as_it_is_rehearsed():
    """Counts of the same commands differ by one at most."""
    given = {"robot": "hexapod-classroom", "segments": 2, "path.goal": [0.007, 0, 0]}
    sent = []
    for how in ("predicted", True):
        walk = served(load_scenario("line", given | {"feed_forward": how}))
        rows = [*walk.stand()]
        for segment in range(2):
            rows += walk.walk(segment)
            rows += [walk.wait() for _ in range(30)]
            walk.seen(segment, [np.nan] * 3)
        sent.append(np.array([angles for _, angles in rows]))
    count = walk.setup.servo.resolution
    assert np.abs(sent[0] - sent[1]).max() <= count * (1 + 1e-9)


@pytest.mark.physics
def test_a_robot_is_led_around_obstacles():
    walk = served(load_scenario("detour"))
    (box,), path = walk.setup.scenario.obstacles, walk.setup.nominal()
    line = shapely.LineString([path(s)[:2] for s in np.linspace(0.0, 1.0, 200)])
    assert line.distance(shapely.Polygon(box.pieces[0].corners)) > 0.05


@pytest.mark.physics
def test_a_path_is_divided_until_the_margin_is_kept_and_refused_if_it_cannot_be():
    asked = {"segments": 2, "path.goal": [0.02, 0.01, 0.0]}
    assert served(load_scenario("line", asked)).setup.scenario.segments == 2
    kept = served(load_scenario("line", asked | {"min_margin": 0.05}))
    assert kept.setup.scenario.segments > 2
    with pytest.raises(PlannerError, match="min_margin of 0.5 m cannot be kept"):
        served(load_scenario("line", asked | {"min_margin": 0.5}))


@pytest.mark.physics
def test_commands_allow_for_a_dead_band_that_is_given():
    """The driven robot has it, whatever is simulated of it."""
    robot = {
        "robot": "hexapod-classroom",
        "segments": 1,
        "path.goal": [0.008, 0.004, 0],
    }

    def commands(**given):
        walk = served(load_scenario("line", robot | given))
        return np.array([angles for _, angles in walk.walk(0)])

    plain, given = commands(), commands(dead_band=0.0087)
    assert (given == commands(assumed_dead_band=0.0087)).all()
    own = SERVO_KINDS["mg90"].dead_band
    assert (commands(dead_band="own") == commands(assumed_dead_band=own)).all()
    assert np.abs(given - plain).max() > 0.001


ZEROS = "\n[fitted]\nzero_offset = [0.03, -0.02" + ", 0.0" * 10 + "]\n"


@pytest.fixture
def fitted(tmp_path):
    """A robot whose card has zeros that were found in its logs."""
    robot = load("hexapod-classroom")
    (tmp_path / "mine.xml").write_text(robot.read().to_xml())
    (tmp_path / "mine.toml").write_text(robot.card_text + ZEROS)
    return str(tmp_path / "mine.xml")


@pytest.mark.physics
def test_commands_have_no_zeros_that_the_robot_has_itself(fitted):
    given = {"segments": 1, "path.goal": [0.005, 0.0, 0.0]}
    plain, own = (
        np.array([row for _, row in served(load_scenario("line", given | one)).stand()])
        for one in ({"robot": "hexapod-classroom"}, {"robot": fitted})
    )
    assert plain == pytest.approx(own, abs=1e-6)  # of a file with fewer digits


@pytest.mark.physics
def test_zeros_in_exported_commands_are_told(fitted, tmp_path, capsys):
    words = ["export", "line", "--segments", "1", "--set", "path.goal=[0.005, 0, 0]"]
    words += ["--format", "csv", "--no-play", "--out"]
    said = "the exported commands have zero_offset of this walk in them"
    for robot, told in (("hexapod-classroom", False), (fitted, True)):
        file = tmp_path / f"{told}.csv"
        assert main([*words, str(file), "--robot", robot]) in (0, 7)
        assert (said in capsys.readouterr().err) == told
