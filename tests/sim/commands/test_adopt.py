"""`stratawalk adopt`: writes a card and a picture beside a file, and nothing else."""

import json

import pytest

from models.library import load
from scripts.adoptees import ADOPTEES
from sim.cli import main

SPIDER, BOX = ADOPTEES[0], ADOPTEES[-1]


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_card_and_picture_are_written_and_the_file_is_left_alone(tmp_path, capsys):
    path = SPIDER.write(tmp_path)
    before = path.read_bytes()
    assert main(["adopt", str(path)]) == 0
    out = capsys.readouterr().out
    assert "guessed     its feet are not on one floor" in out
    assert "legs 1 4 5: turned by up to" in out
    assert path.read_bytes() == before
    assert names(tmp_path) == ["spider.png", "spider.toml", "spider.xml"]
    assert load(str(path)).card.groups.keys() == {"1", "2"}


def test_urdf_is_given_an_mjcf(tmp_path, capsys):
    path = BOX.write(tmp_path)
    assert main(["adopt", str(path), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert names(tmp_path) == ["box.png", "box.toml", "box.urdf", "box.xml"]
    assert len(report["robot"]["legs"]) == 6


def test_a_model_folder_with_a_scene_is_adopted_by_its_name(tmp_path, capsys):
    SPIDER.write(tmp_path)
    (tmp_path / "scene.xml").write_text(
        '<mujoco><include file="spider.xml"/><worldbody><geom name="floor" '
        'type="plane" size="0 0 0.05"/></worldbody></mujoco>'
    )
    assert main(["adopt", str(tmp_path)]) == 0
    assert f"--robot {tmp_path / 'spider.xml'}\n" in capsys.readouterr().out
    assert (tmp_path / "spider.toml").is_file()


@pytest.mark.parametrize("name", ["spider.toml", "spider.png"])
def test_nothing_is_written_over(tmp_path, capsys, name):
    path = SPIDER.write(tmp_path)
    (tmp_path / name).write_text("mine")
    assert main(["adopt", str(path)]) == 2
    assert "already exists" in capsys.readouterr().err
    assert names(tmp_path) == sorted([name, "spider.xml"])
    assert (tmp_path / name).read_text() == "mine"


def test_refused_robot_leaves_no_file(tmp_path, capsys):
    path = SPIDER.write(tmp_path)
    # a trunk that touches things, and reaches to the floor on which it would stand
    text = path.read_text().replace('contype="0" conaffinity="0"/>\n', "/>\n", 1)
    path.write_text(text.replace('0.02" density', '0.5" density'))
    assert main(["adopt", str(path)]) == 3
    assert names(tmp_path) == ["spider.xml"]


def test_missing_file_is_refused(tmp_path, capsys):
    assert main(["adopt", str(tmp_path / "gone.xml")]) == 2
    assert "no such robot" in capsys.readouterr().err
