"""Servos fitted to logs whose truth is known."""

import json
from dataclasses import replace

import numpy as np
import pytest

from models import load
from sim.cli import main
from sim.errors import UsageError
from sim.fitting.estimate import Estimates, Parameter, estimate, pooled
from sim.fitting.fitting import (
    SERVO,
    JointFit,
    fit_joints,
    fit_servos,
    one_make,
    servos,
)
from sim.fitting.poses import SETTINGS as OF_THE_BODY
from sim.fitting.servo_law import Commanded
from sim.logs.log import Log, written
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import FITTED, drawn

MAKE = (0, 1, 3, 5)  # parameters of a make; dead band and zero are a servo's own

STEP, LASTING, EVERY = 0.004, 6.0, 5  # [s], [s], steps from row to row
NOISE = np.radians(0.05)
NAMES, ONES = ("one", "other", "third"), np.ones(3)


def moves(joints, rng, lasting=LASTING, step=STEP, fast=0.3):
    """Joints that go somewhere else every half second, (T, joints) [rad]."""
    time = np.arange(0, lasting, step)
    places = rng.uniform(-0.4, 0.4, (round(2 * lasting) + 2, joints))
    number = (2 * time).astype(int)
    part = np.clip((time - number / 2) / fast, 0, 1)[:, None]
    return places[number] + (places[number + 1] - places[number]) * part**2 * (
        3 - 2 * part
    )


def hidden(joints, rng, stiffness=9.0, damping=0.1):
    truth = servos(np.full(joints, stiffness), np.full(joints, damping))
    truth[:, 2] = rng.uniform(0.004, 0.02, joints)
    truth[:, 3:] = 0.008, 0.0, 0.02
    truth[:, 4] = rng.uniform(-0.02, 0.02, joints)
    return truth


def commanded(angle, load=0.0, inertia=2e-4):
    joints = angle.shape[1]
    given = np.full(joints, inertia)
    return Commanded(STEP, angle, np.broadcast_to(load, angle.shape), given, given / 4)


@pytest.fixture(scope="module")
def fitted():
    """Lifts that bear loads of both signs, and their truth."""
    rng = np.random.default_rng(5)
    angle = moves(3, rng)
    log = commanded(angle, 0.2 * np.sin(np.arange(len(angle)) / 80)[:, None])
    rows = np.arange(0, LASTING - STEP, EVERY * STEP)
    truth = hidden(3, rng)
    seen = log.answers(truth[None], rows)[0]
    seen += rng.normal(0, NOISE, seen.shape)
    start = servos(np.full(3, 15.0), np.full(3, 0.06))
    return truth, fit_servos(log, rows, seen, start)


def test_a_spring_rests_a_load_over_its_stiffness_and_half_its_band_away():
    servo = servos(np.array([8.0]), np.array([0.1]))
    servo[:, 2:4] = 0.02, 0.006
    still = commanded(np.zeros((500, 1)), load=0.04)
    rests = still.answers(servo[None], np.array([1.9]))[0]
    assert rests == pytest.approx(-0.04 / 8 - 0.01 - 0.003)


def test_a_servo_comes_after_a_steady_command_by_damping_and_delay():
    servo = servos(np.array([8.0]), np.array([0.16]))
    servo[:, 5] = 0.03
    steady = commanded(0.4 * np.arange(0, 2, STEP)[:, None])
    behind = 0.4 * 1.5 - steady.answers(servo[None], np.array([1.5]))[0]
    # half a step: commands are told in the middle of each
    assert behind == pytest.approx(0.4 * (0.16 / 8 + 0.03), abs=0.4 * STEP)


def test_every_servo_is_found_within_its_errors(fitted):
    truth, found = fitted
    off = np.abs(found.value - truth) / found.error
    assert found.seen.all()
    assert off.max() < 3.5  # of 18 numbers; 2.4 was seen
    assert found.noise == pytest.approx(NOISE, rel=0.1)


def test_joints_of_one_make_tell_more_together(fitted):
    truth, found = fitted
    make, own, whole = one_make(found)
    assert (make.error < found.error[:, MAKE]).all()
    assert np.abs(make.value[0] - truth[0, list(MAKE)]).max() < 3.5 * make.error.max()
    assert (np.abs(whole - truth)[:, [2, 4]] < 4 * own.error).all()


def test_backlash_within_two_standard_errors_of_none_is_written_as_none(fitted):
    make, own, _ = one_make(fitted[1])
    told = [
        JointFit(NAMES, make, replace(make, value=value), own, ONES, ONES)
        for value in (make.value, make.value * [1, 1, 0, 1] + make.error)
    ]
    assert told[0].settings(NAMES, {})["backlash"][0] == make.value[0, 2] > 0
    assert told[1].settings(NAMES, {})["backlash"] == (0.0, make.error[0, 2])


def test_a_slow_log_without_loads_tells_damping_over_stiffness_alone():
    rng = np.random.default_rng(1)
    slow = commanded(moves(1, rng, fast=0.5), inertia=1e-6)
    rows = np.arange(0, LASTING - STEP, EVERY * STEP)
    seen = slow.answers(servos(np.array([9.0]), np.array([0.1]))[None], rows)[0]
    seen += rng.normal(0, NOISE, seen.shape)
    found = fit_servos(slow, rows, seen, servos(np.array([15.0]), np.array([0.1])))
    assert "more stiffness with more damping would look the same" in set(found.unseen())
    assert not found.seen[0, 0]


def classroom_log(path, measured=True):
    """A log of the classroom robot on a stand, half a degree off everywhere."""
    robot = load("hexapod-classroom")
    joints = robot.card.joints[:2]
    rng = np.random.default_rng(2)
    angle = moves(2, rng, lasting=4.0, step=0.02)
    angle += [robot.standing_angle(joint) for joint in joints]
    seen = angle + np.radians(0.5) + rng.normal(0, NOISE, angle.shape)
    time = 0.02 * np.arange(len(angle))
    path.write_text(
        written(Log(time, joints, angle, measured=seen if measured else None))
    )
    return joints


def test_joints_that_never_move_tell_no_stiffness_no_damping_and_no_delay():
    classroom = {"robot": "hexapod-classroom"}
    setup = prepare(
        load_scenario("line", classroom), robot := load("hexapod-classroom")
    )
    joints = robot.card.joints
    still = np.tile([robot.standing_angle(joint) for joint in joints], (300, 1))
    off = 0.01 * np.random.default_rng(0).normal(size=len(joints))
    log = Log(np.arange(300) / 100, joints, still, measured=still + off)
    found = fit_joints(setup, [log], walking=False)
    assert not found.make.seen[0, [0, 1, 3]].any()
    unseen = {"servo_stiffness", "servo_damping", "command_delay"}
    assert unseen.isdisjoint(found.settings(joints, {}))


@pytest.mark.filterwarnings("ignore:Mean of empty slice")
def test_a_joint_that_was_not_measured_to_the_end_is_not_checked(tmp_path, capsys):
    joints = classroom_log(tmp_path / "log.csv")
    lines = (tmp_path / "log.csv").read_text().splitlines()
    late = [line.rpartition(",")[0] + "," for line in lines[len(lines) // 2 :]]
    (tmp_path / "log.csv").write_text("\n".join(lines[: len(lines) // 2] + late))
    words = ["fit", "hexapod-classroom", str(tmp_path / "log.csv")]
    assert main([*words, "--json"]) == 0
    assert [*json.loads(capsys.readouterr().out)["servos"]["held_out"]] == [joints[0]]
    assert main(words) == 0
    assert "nan" not in capsys.readouterr().out


def test_a_card_is_written_that_walks_use(tmp_path, capsys):
    joints = classroom_log(tmp_path / "log.csv")
    card = tmp_path / "mine.toml"
    words = ["fit", "hexapod-classroom", str(tmp_path / "log.csv"), "--out", str(card)]
    assert main([*words, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    zeros = told["settings"]["zero_offset"]["value"]
    robot = load(str(card.with_suffix(".xml")))
    assert robot.card.fitted["zero_offset"] == zeros
    assert robot.card.fitted["source"] == words[1:3]
    assert zeros[:2] == pytest.approx([np.radians(0.5)] * 2, abs=0.003)
    assert zeros[2:] == [0.0] * 10
    assert all(told["servos"]["held_out"][j]["after"] < 0.002 for j in joints)
    scenario = load_scenario("line", {"robot": str(robot.path)})
    assert prepare(scenario).scenario.zero_offset == tuple(zeros)
    given = replace(scenario, zero_offset=0.01)
    assert drawn(given, robot).zero_offset == 0.01


def test_logs_in_counts_are_fitted_as_those_in_radians(tmp_path, capsys):
    classroom_log(tmp_path / "log.csv")
    names, *rows = (tmp_path / "log.csv").read_text().splitlines()
    table = np.array([row.split(",") for row in rows], dtype=float)
    table[:, 1:] = 2048 + table[:, 1:] * 4096 / (2 * np.pi)
    log = str(tmp_path / "counts.csv")
    np.savetxt(log, table, "%.9g", ",", header=names, comments="")
    assert main(["fit", "hexapod", log, "--units", "counts", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    zeros = told["settings"]["zero_offset"]["value"]
    assert zeros[:2] == pytest.approx([np.radians(0.5)] * 2, abs=0.003)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["log.csv"],
            "'log.csv' is neither a robot nor a run, and a log names no",
        ),
        (["hexapod-classroom"], "nothing to fit: hexapod-classroom; name a LOG"),
        (
            ["hexapod-classroom", "log.csv"],
            "nothing was measured: log.csv; give columns",
        ),
        (
            ["hexapod-classroom", "log.csv", "--out", "card.xml"],
            "no place for a card: card.xml; give --out FOLDER/NAME.toml",
        ),
        (
            ["hexapod-classroom", "log.csv", "--out", "log.toml"],
            "already exists: log.toml; give --out another name",
        ),
        (
            ["hexapod-classroom", "log.csv", "--out", "body.toml"],
            "already exists: body.xml; give --out another name",
        ),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    words, message, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    classroom_log(tmp_path / "log.csv", measured=False)
    (tmp_path / "log.toml").touch()
    (tmp_path / "body.xml").touch()
    assert main(["fit", *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("part", ["start", "end"])
def test_a_log_that_measured_too_little_to_fit_or_to_check_is_refused(
    part, tmp_path, capsys
):
    classroom_log(tmp_path / "log.csv")
    head, *rows = (tmp_path / "log.csv").read_text().splitlines()
    if part == "start":
        rows = rows[:19]
    else:
        first = len(rows) * 3 // 4
        rows[first:] = [
            ",".join([*row.split(",")[:-2], "", ""]) for row in rows[first:]
        ]
    (tmp_path / "log.csv").write_text("\n".join([head, *rows]))
    assert main(["fit", "hexapod-classroom", str(tmp_path / "log.csv")]) == 2
    said = capsys.readouterr().err
    assert "fewer than 20 rows, or no angles to its end, which check: " in said
    assert "log.csv; leave out rows in which none was measured" in said


REFUSED = {
    "an unknown key": ({"frictoin": 0.5}, r"\[fitted\] has no key 'frictoin'.*'fricti"),
    "a file to open": ({"motion": "a.csv"}, "no key 'motion': the card of hexapod; "),
    "an imperfection that no fit finds": ({"imperfect": "hobby"}, "no key 'imperfect'"),
    "a load in words": ({"payload": "big"}, "payload = 'big' is .*: the card of hexa"),
}


@pytest.mark.parametrize(("fitted", "said"), REFUSED.values(), ids=REFUSED)
def test_a_card_with_a_setting_that_no_fit_writes_is_refused(fitted, said):
    robot = load("hexapod")
    odd = replace(robot, card=replace(robot.card, fitted=fitted))
    with pytest.raises(UsageError, match=said):
        drawn(load_scenario("line"), odd)


def test_cards_may_have_all_settings_that_a_fit_writes():
    assert {*FITTED} == {*(p.setting for p in SERVO), *OF_THE_BODY}


def test_exact_measurements_of_what_looks_the_same_can_still_be_pooled():
    unseen = [Parameter(name=name, unit="rad", spread=1.0, step=1e-3) for name in "abc"]
    rows = np.linspace(0, 1, 50)[:, None]

    def model(tried):
        return np.stack([0.1 * one.sum(axis=1) * rows for one in tried])

    start = np.zeros((2, 3))
    found = estimate(model, np.zeros((50, 2)), unseen, start, start)
    make, own = pooled(found, [0])
    assert np.isfinite(make.error).all()
    assert np.isfinite(own.error).all()


def test_errors_are_numbers_where_measurements_see_one_direction_sharply():
    names = [Parameter(name=name, unit="rad", spread=1.0, step=1e-3) for name in "abc"]
    sharp = np.array([1.0, 1.0 / 3.0, 1.0 / 7.0])
    one = np.zeros((1, 3))
    found = Estimates(tuple(names), one, one, 1e22 * np.outer(sharp, sharp)[None], one)
    across = 1 - sharp**2 / (sharp @ sharp)  # what is left of each, of the others
    assert found.error[0] == pytest.approx(np.sqrt(across), rel=1e-6)
