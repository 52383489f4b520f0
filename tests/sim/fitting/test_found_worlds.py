"""The world of servos that were found, and where a card that was fitted is written."""

from types import SimpleNamespace

import numpy as np
import pytest

from models import load
from sim.errors import UsageError
from sim.fitting import fitting
from sim.fitting.fitting import write_card
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from sim.world.dead_bands import band_in

NARROWEST = 1e-5  # [rad]; a band that all joints have, so that all are built alike


def test_a_fitted_world_has_the_stiffness_damping_slack_and_bands_that_were_found():
    """One joint has no log, and one no band: theirs is the narrowest there is."""
    setup = prepare(load_scenario("line"))
    joints = setup.robot.card.joints
    whole = np.zeros((len(joints) - 1, 6))
    whole[:, 0], whole[:, 1], whole[:, 3] = np.log(8.0), np.log(0.3), 0.006
    whole[:, 2] = 0.01 + 0.001 * np.arange(len(whole))
    whole[4, 2] = 0.0
    log = SimpleNamespace(joints=joints[:-1])
    model = fitting._fitted_model(setup, log, whole)
    bands = [*whole[:, 2], 0.0]
    for joint, band in zip(joints, bands, strict=True):
        servo = model.actuator(joint)
        assert servo.gainprm[0] == pytest.approx(8.0)
        assert servo.biasprm[1:3] == pytest.approx([-8.0, -0.3])
        slack = model.joint(f"backlash_{joint}").range
        assert slack == pytest.approx([-0.003, 0.003])
        assert band_in(model, joint) == pytest.approx(band or NARROWEST)
    whole[:, 3] = 4e-12  # which no scenario takes
    assert fitting._fitted_model(setup, log, whole).njnt == setup.model.njnt


def test_a_robot_of_several_files_or_one_with_its_card_keeps_its_model(tmp_path):
    def robot(shipped=False, files=(), inside=False):
        return SimpleNamespace(
            is_shipped=shipped,
            path="own.xml",
            opened=SimpleNamespace(files=files),
            has_card_inside=inside,
            read=lambda: SimpleNamespace(to_xml=lambda: "<mujoco/>"),
        )

    told = "; put it in the place of the robot's own card"
    for number, (given, alone) in enumerate((
        ({"files": ("own.xml", "mesh.stl")}, False),
        ({"files": ("own.xml",), "inside": True}, False),
        ({"inside": True}, False),
        ({"files": ("own.xml",)}, True),
        ({}, True),
        ({"shipped": True, "files": ("own.xml", "mesh.stl")}, True),
    )):  # fmt: skip
        card = tmp_path / f"{number}.toml"
        model = card.with_suffix(".xml")
        said = write_card(robot(**given), card, "a = 1\n")
        assert card.read_text() == "a = 1\n"
        assert said == (
            f"{card}; use it as --robot {model}" if alone else f"{card}{told}"
        )
        assert model.exists() == alone


def test_a_card_whose_robot_cannot_be_written_is_not_left_alone(tmp_path):
    """Or the command that is told to go on is refused because of it."""
    (tmp_path / "found.xml").touch()
    with pytest.raises(UsageError, match="found.xml"):
        write_card(load("hexapod"), tmp_path / "found.toml", "a = 1\n")
    assert not (tmp_path / "found.toml").exists()


def test_a_walk_is_fitted_in_rounds_each_in_the_world_that_the_last_one_found(
    monkeypatch,
):
    """Three rounds on the floor; on a stand one, for nothing moves there."""
    logs, stood, walked = [SimpleNamespace(joints=("a", "b"))], [], []
    setup = SimpleNamespace(as_planned=SimpleNamespace(model="described"))
    rounds = iter(range(9))

    def on_floor(setup, model, log, whole):
        walked.append((model, whole))
        return "on the floor"

    for name, stub in (
        ("known_servos", lambda *_: ("known",)), ("servos", lambda _: "start"),
        ("on_floor", on_floor), ("on_stand", lambda *_: stood.append("stood")),
        ("_rows", lambda *_: ()), ("fit_servos", lambda *_: "fitted"),
        ("together", lambda each: "each"),
        ("one_make", lambda _: ("make", "own", f"found {next(rounds)}")),
        ("shared_make", lambda *_: ("reaching", "make", "own", "found together")),
        ("_fitted_model", lambda _, log, whole: (log, f"world of {whole}")),
        ("_missed", lambda commanded, log, servo: np.full(2, 4.0)),
    ):  # fmt: skip
        monkeypatch.setattr(fitting, name, stub)
    found = fitting.fit_joints(setup, logs, walking=True)
    assert walked == [
        ("described", "start"),
        ((logs[0], "world of found 0"), "found 0"),
        ((logs[0], "world of found 1"), "found 1"),
    ]
    assert (found.joints, found.make, found.own) == (("a", "b"), "make", "own")
    assert found.before.tolist() == found.after.tolist() == [2.0, 2.0]
    assert not stood
    assert fitting.fit_joints(setup, logs, walking=False).each == "reaching"
    assert (len(stood), len(walked)) == (1, 3)
