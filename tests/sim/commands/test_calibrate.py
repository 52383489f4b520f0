"""`stratawalk calibrate` between two sessions: what an owner has changed meanwhile."""

import io
import os
import re
import shutil
from contextlib import contextmanager
from fcntl import LOCK_EX, LOCK_NB, flock
from pathlib import Path
from types import SimpleNamespace

import pytest

from models.description import FOLDER
from sim.cli import main
from sim.export import calibration

MG90 = '\n[servo]\nkind = "mg90"\n'


@pytest.fixture
def answered(monkeypatch, capsys):
    """What `calibrate` says where all answers have been used."""
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)

    def words(*given):
        monkeypatch.setattr("sys.stdin", io.StringIO())
        assert main(["calibrate", *map(str, given)]) == 2
        return capsys.readouterr().err

    return words


def test_the_make_is_that_of_the_copy_whose_card_is_written(answered, tmp_path):
    (tmp_path / "jog.ino").write_text("const float RATE = 59.838388;\n")
    (tmp_path / "quadruped.toml").write_text(
        (FOLDER / "quadruped.toml").read_text() + MG90
    )
    shutil.copy(FOLDER / "scene.xml", tmp_path)
    shutil.copy(FOLDER / "quadruped.xml", tmp_path)
    said = answered("quadruped", "--out", tmp_path)
    assert "are assumed" not in said
    assert "answers end" in said


def test_a_sketch_of_other_frames_is_not_counted_by(answered, tmp_path):
    """Its counts would be taken for those of the make that the card names now."""
    out = "quadruped", "--out", tmp_path
    assert "pulses of 500 to 2500 us are assumed" in answered(*out)
    card = tmp_path / "quadruped.toml"
    before = card.read_text()
    card.write_text(before + MG90)
    assert "write 'RATE = 59.838388;' in it, or remove" in answered(*out)
    sketch = tmp_path / "jog.ino"
    own = re.sub("RATE = [0-9.]+", "RATE = 59.838388", sketch.read_text())
    sketch.write_text(own)
    assert "jog.ino stays; remove it to have it written anew" in answered(*out)
    sketch.unlink()
    assert "answers end" in answered(*out)
    assert "RATE = 59.838388;" in sketch.read_text()


def test_a_robot_beside_nothing_is_calibrated(answered, tmp_path, monkeypatch):
    """Named as an owner does who stands in its folder."""
    for name in ("quadruped.xml", "quadruped.toml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    assert "answers end" in answered("quadruped.xml", "--out", "c")


@pytest.mark.parametrize("way", ["relative", "link", "card"])
def test_the_card_of_a_shipped_robot_is_not_written_however_it_is_named(
    answered, tmp_path, monkeypatch, way
):
    monkeypatch.chdir(FOLDER.parent)
    (tmp_path / "robots").symlink_to(FOLDER)
    above = "" if way == "relative" else tmp_path
    named = Path(above, "robots", "quadruped.xml")
    if way == "card":
        (tmp_path / "own").mkdir()
        for name in ("quadruped.xml", "quadruped.toml", "scene.xml"):
            (tmp_path / "own" / name).symlink_to(FOLDER / name)
        named = tmp_path / "own" / "quadruped.xml"
    external = ["--allow-external"] * (way == "card")
    assert "answers end" in answered(named, "--out", tmp_path / "c", *external)
    assert (tmp_path / "c" / "quadruped.toml").exists()


def test_strokes_of_a_robot_are_not_written_beside_the_page_of_another(
    answered, tmp_path
):
    out = tmp_path / "c"
    answered("hexapod", "--out", out)
    card = (FOLDER / "quadruped.toml").read_text()
    joints = [j for leg in range(1, 5) for j in (f"swing_{leg}", f"lift_{leg}")]
    tables = (f"\n[servo.{joint}]\nchannel = {n}\n" for n, joint in enumerate(joints))
    for name in ("scene.xml", "quadruped.xml"):
        (tmp_path / name.replace("quadruped", "own")).write_bytes(
            (FOLDER / name).read_bytes()
        )
    (tmp_path / "own.toml").write_text(card + MG90 + "".join(tables))
    said = answered(tmp_path / "own.xml", "--check", "--out", out)
    assert f"already exists: {out / 'feet.svg'}" in said
    assert not (out / "check.h").exists()


def test_a_card_that_is_a_link_stays_one_and_keeps_who_may_read_it(answered, tmp_path):
    for name in ("scene.xml", "quadruped.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    real = tmp_path / "real.toml"
    real.write_text((FOLDER / "quadruped.toml").read_text() + MG90)
    real.chmod(0o660)
    (card := tmp_path / "quadruped.toml").symlink_to(real)
    file = tmp_path / "answers.txt"
    file.write_text("\nswing_1\n+\n321\n421\n")
    answered(card.with_suffix(".xml"), "--out", tmp_path / "c", "--answers", file)
    assert card.is_symlink()
    assert "[servo.swing_1]" in real.read_text()
    assert real.stat().st_mode & 0o777 == 0o660


def test_the_copy_of_a_robot_in_a_run_is_left_as_it_was_sealed(answered, tmp_path):
    copies = tmp_path / "run" / "robot"
    copies.mkdir(parents=True)
    (tmp_path / "run" / "summary.json").touch()
    for name in ("quadruped.xml", "quadruped.toml", "scene.xml"):
        shutil.copy(FOLDER / name, copies)
    said = answered(copies / "quadruped.xml", "--out", tmp_path / "c")
    assert "as a run has walked it, which is sealed: " in said
    assert "; calibrate your own quadruped.xml, and walk again" in said


@pytest.mark.parametrize(("kind", "given"), [("sts3215", 102), ("mg90", 0)])
def test_counts_of_another_kind_of_servo_are_not_gone_on_with(
    kind, given, tmp_path, answered
):
    """Ticks of a bus would become pulses, by the divider that is written over them."""
    for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    card, robot = tmp_path / "hexapod.toml", tmp_path / "hexapod.xml"
    counted = "[servo.swing_1]\nchannel = 3\ncenter = 512\ncounts_per_radian = 195.6\n"
    board = f"[board]\ndivider = {given}\n" if given else ""
    was = f'{card.read_text()}\n[servo]\nkind = "{kind}"\n{board}{counted}'
    card.write_text(was)
    said = (
        "counts of its servos are of pulses" if given else "the counts of swing_1 are"
    )
    assert said in answered(robot, "--out", tmp_path / "c")
    assert card.read_text() == was


def test_a_card_that_is_no_text_any_more_is_said_to_be_none(tmp_path, monkeypatch):
    for name in ("hexapod-classroom.xml", "hexapod-classroom.toml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    card = tmp_path / "hexapod-classroom.toml"

    def readline(_):
        if given[0] == "400":
            card.write_bytes(b"\xe9" + card.read_bytes())
        return f"{given.pop(0)}\n"

    given = ["25", "swing_1", "+", "200", "400"]
    answers = SimpleNamespace(readline=readline, isatty=lambda: False)
    monkeypatch.setattr("sim.export.calibration.draw", lambda *_, **__: None)
    monkeypatch.setattr("sys.stdin", answers)
    robot = str(tmp_path / "hexapod-classroom.xml")
    assert main(["calibrate", robot, "--out", str(tmp_path / "c")]) == 3


def test_pictures_of_axes_that_were_turned_round_since_are_not_gone_on_with(
    answered, tmp_path
):
    """Every sense that an owner told by them would be the wrong one."""
    for name in ("hexapod.xml", "hexapod.toml", "scene.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    robot, out = tmp_path / "hexapod.xml", tmp_path / "c"
    assert "answers end" in answered(robot, "--out", out)
    turned = robot.read_text().replace('axis="0 0 1"', 'axis="0 0 -1"')
    robot.write_text(turned)
    assert f"already exists: {out / 'index.html'}" in answered(robot, "--out", out)


def test_of_two_calibrations_of_one_card_one_alone_writes_at_a_time(
    answered, tmp_path, monkeypatch
):
    for name in ("scene.xml", "quadruped.xml"):
        shutil.copy(FOLDER / name, tmp_path)
    (tmp_path / "quadruped.toml").write_text(
        (FOLDER / "quadruped.toml").read_text() + MG90
    )
    card_with, kept_out = calibration.card_with, []

    def watched(text, servos, *given):
        if any(servo.center for servo in servos.values()):  # a card that is written
            with pytest.raises(BlockingIOError), opened(tmp_path) as folder:
                flock(folder, LOCK_EX | LOCK_NB)
            kept_out.append(len(servos))
        return card_with(text, servos, *given)

    monkeypatch.setattr(calibration, "card_with", watched)
    file = tmp_path / "answers.txt"
    file.write_text("\nswing_1\n+\n321\n421\n-\n")
    robot = tmp_path / "quadruped.xml"
    answered(robot, "--out", tmp_path / "c", "--answers", file)
    assert kept_out
    with opened(tmp_path) as folder:
        flock(folder, LOCK_EX | LOCK_NB)  # which is free again


@contextmanager
def opened(folder):
    handle = os.open(folder, os.O_RDONLY)
    try:
        yield handle
    finally:
        os.close(handle)
