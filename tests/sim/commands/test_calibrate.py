"""`stratawalk calibrate` between two sessions: what an owner has changed meanwhile."""

import io
import re
import shutil

import pytest

from models.description import FOLDER
from sim.cli import main

MG90 = '\n[servo]\nkind = "mg90"\n'


@pytest.fixture
def answered(monkeypatch, capsys):
    """What `calibrate` says where all answers have been used."""
    monkeypatch.setattr("sim.commands.calibrate.draw", lambda *_, **__: None)

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


def test_the_copy_of_a_robot_in_a_run_is_left_as_it_was_sealed(answered, tmp_path):
    copies = tmp_path / "run" / "robot"
    copies.mkdir(parents=True)
    (tmp_path / "run" / "summary.json").touch()
    for name in ("quadruped.xml", "quadruped.toml", "scene.xml"):
        shutil.copy(FOLDER / name, copies)
    said = answered(copies / "quadruped.xml", "--out", tmp_path / "c")
    assert "as a run has walked it, which is sealed: " in said
    assert "; calibrate your own quadruped.xml, and walk again" in said
