"""Films made later: from any side, of any stretch of time, under any name."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from sim.cli import main
from sim.errors import UsageError
from sim.pictures.camera import HEIGHT, VIEWS, WIDTH, camera, view_of
from sim.pictures.clock import FRAME_RATE, TAIL, clock, rows_of
from sim.pictures.file import count_pictures
from sim.runs.run import read_run
from tests.screen import decode, on_screen


@pytest.mark.parametrize("name", [*VIEWS, "30,-40", "200,-90"])
def test_the_whole_walk_is_seen_from_every_side(walked, name):
    walk = read_run(walked).in_world()
    film = clock(walk.time, walk.scenario.playback)
    view = camera(walk, film, view_of(name))
    feet = np.insert(walk.contact_point[-1], 2, 0.0, axis=1)
    seen = on_screen(view, len(film.rows) - 1, feet)
    assert (seen > 0).all()
    assert (seen < (WIDTH, HEIGHT)).all()


def test_left_and_right_are_those_of_the_robot(walked):
    walk = read_run(walked).in_world()
    film = clock(walk.time, walk.scenario.playback)
    ahead = np.array([[0.0, 0.0, 0.0], [0.05, 0.0, 0.0]])  # the robot walks along x
    for name, sign in (("right", 1), ("left", -1)):
        start, end = on_screen(camera(walk, film, view_of(name)), 0, ahead)
        assert sign * (end[0] - start[0]) > 10


@pytest.mark.parametrize("bad", ["tpo", "30", "30,10", "nan,-30", "1,2,3"])
def test_views_that_are_none_are_refused(bad):
    with pytest.raises(UsageError, match="camera"):
        view_of(bad)


def test_a_stretch_shows_its_rows_alone():
    time = np.linspace(0.0, 10.0, 1001)
    film = clock(time, 2.0, (4.0, 6.0))
    assert (time[film.rows[0]], time[film.rows[-1]]) == (4.0, 6.0)
    assert len(film.rows) == round(1.0 * FRAME_RATE) + round(TAIL * FRAME_RATE)
    assert rows_of(time, (20.0, 30.0)) == (1000, 1000)


@pytest.mark.render
def test_the_command_films_a_stretch_from_above(driver, folder, capsys):
    words = ["film", str(folder), "--camera", "top", "--from", "2", "--to", "8"]
    assert main([*words, "--json"]) == 0
    film = folder.resolve() / "video-2.00-8.00.mp4"
    assert json.loads(capsys.readouterr().out) == {"film": str(film)}
    walk = read_run(folder).in_world()
    shown = clock(walk.time, walk.scenario.playback, (2.0, 8.0))
    assert count_pictures(film) == len(shown.rows)
    view = camera(walk, shown, view_of("top"))
    (x, y), *_ = on_screen(view, 0, np.array([[*walk.achieved[shown.rows[0], :2], 0]]))
    body = decode(film)[0][round(y) - 5 : round(y) + 5, round(x) - 5 : round(x) + 5]
    assert body.mean() < 200  # the robot stands there, and not the pale floor


@pytest.mark.render
def test_a_name_in_webp_makes_a_small_animated_picture(driver, folder, capsys):
    out = folder / "walk.webp"
    words = ["film", str(folder), "--from", "2", "--to", "8", "--out", str(out)]
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"film": str(out.resolve())}
    walk = read_run(folder).in_world()
    shown = clock(walk.time, walk.scenario.playback, (2.0, 8.0))
    seconds = len(shown.rows) / FRAME_RATE
    with Image.open(out) as picture:
        assert (picture.format, picture.size) == ("WEBP", (640, 360))
        assert picture.info["loop"] == 0  # for ever
        frames = ImageSequence.all_frames(picture)
    shown_for = [frame.info["duration"] for frame in frames]
    assert sum(shown_for) == pytest.approx(1000 * seconds, abs=100)  # [ms]
    assert len(shown_for) > 2  # stills are one picture


def test_films_that_cannot_be_are_refused_at_once(folder, tmp_path, capsys):
    (tmp_path / "old.mp4").touch()
    for words in (
        ["--camera", "tpo"],
        ["--from", "99"],
        ["--from", "5", "--to", "4"],
        ["--from", "nan"],
        ["--out", "film.avi"],
        ["--out", str(tmp_path / "old.mp4")],
    ):
        assert main(["film", str(folder), *words]) == 2, words
    assert main(["film", str(tmp_path / "nothing")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 7
    assert "nothing to film between 99 s and the end" in said
    assert "nothing to film between 5 s and 4 s" in said
    assert "inf" not in said


def test_a_film_of_a_run_that_nobody_named_is_said_to_take_minutes(
    walked, tmp_path, monkeypatch, capsys
):
    filmed = []
    module = "sim.pictures.run_film.film_folder"
    monkeypatch.setattr(module, lambda folder, **_: filmed.append(folder))
    monkeypatch.chdir(tmp_path)
    run = Path("runs", "line-001")
    shutil.copytree(walked, run)
    assert main(["film"]) == 0
    assert "film of a whole walk takes minutes" in capsys.readouterr().err
    assert main(["film", str(run)]) == 0  # whoever names it knows
    assert capsys.readouterr().err == ""
    assert filmed == [run, run]
