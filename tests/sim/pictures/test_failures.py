"""Every way in which filming fails: one clear line, and never half a film."""

import json
import os
import re
import time

import numpy as np
import pytest

from sim.errors import ExitCode, FilesError, RenderError, UsageError
from sim.pictures import run_film
from sim.pictures.file import check_encoder, count_pictures, encoding, join
from sim.pictures.run_film import Piece, film_folder
from sim.runs.run import read_run
from tests.commands import FORKS
from tests.finished_runs import sealed
from tests.screen import FFMPEG, decode


@pytest.fixture
def ffmpeg(monkeypatch, tmp_path):
    """Replace ffmpeg by a shell script in which $REAL is the real one."""

    def replace(script):
        path = tmp_path / "ffmpeg"
        path.write_text(f"#!/bin/bash\nREAL='{FFMPEG}'\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(path))

    return replace


@pytest.mark.render
@pytest.mark.parametrize(
    ("script", "error", "message"),
    [
        (  # dies early: its pipe breaks
            '[[ "$*" == *rawvideo* ]] && exit 1; exec "$REAL" "$@"',
            RenderError,
            "drawing the film failed, the encoder died: .*; the run itself is kept",
        ),
        (  # loses pictures, and reports success
            'if [[ "$*" == *rawvideo* ]]; then\n'
            '  { head -c $((5 * 1280 * 720 * 3)) | "$REAL" "$@"; cat > /dev/null; }\n'
            'else exec "$REAL" "$@"; fi',
            RenderError,
            r"film cut short, 5 of \d\d pictures: .*\.mp4; the run itself is kept",
        ),
        (  # writes nothing and reports success
            'if [[ "$*" == *rawvideo* ]]; then cat > /dev/null\n'
            'else exec "$REAL" "$@"; fi',
            RenderError,
            "ffmpeg failed, .*No such file",
        ),
        (
            'if [[ "$*" == *rawvideo* ]]; then\n'
            "  echo 'av_write(): No space left on device' >&2; exit 1\n"
            'else exec "$REAL" "$@"; fi',
            FilesError,
            r"disk full: .*\.mp4; free some space, or write to another disk",
        ),
        (
            'if [[ "$*" == *concat* ]]; then\n'
            "  echo 'av_write(): No space left on device' >&2; exit 1\n"
            'else exec "$REAL" "$@"; fi',
            FilesError,
            r"disk full: .*\.mp4; free some space",
        ),
    ],
    ids=["dies", "loses", "silent", "full", "full at last"],
)
def test_an_encoder_that_fails_leaves_no_film(
    driver, folder, ffmpeg, script, error, message
):
    before = {path.name for path in folder.iterdir()}
    ffmpeg(script)
    with pytest.raises(error, match=message):
        film_folder(folder, stretch=(0.0, 1.0))
    assert {path.name for path in folder.iterdir()} == before


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["sh", "-c", "kill -SEGV $$"], "drawing the film failed, signal 11"),
        (["sh", "-c", "echo 'out of luck' >&2; exit 3"], "failed, out of luck"),
        (["sh", "-c", "exit 3"], "failed, no word"),
        (["sleep", "60"], "no picture for 0.3 s"),
    ],
    ids=["crash", "error", "mute", "hang"],
)
def test_a_process_that_fails_is_reported(walked, monkeypatch, command, message):
    monkeypatch.setattr(Piece, "command", command)
    monkeypatch.setattr(run_film, "SILENCE", 0.3)
    piece = Piece(walked, "draft", range(2), walked / "none.mp4")
    with pytest.raises(RenderError, match=message) as error:
        run_film.draw([piece, piece], "egl", lambda drawn: None)
    assert error.value.exit_code is ExitCode.RENDER


def test_an_unknown_look_is_refused(walked):
    with pytest.raises(
        UsageError, match="unknown look 'fine': film; known are draft, f"
    ):
        film_folder(walked, look="fine")


@pytest.mark.parametrize(
    "name", ["model.xml", "model.toml", "flows.csv", "trajectory.npz"]
)
def test_an_unfinished_run_is_refused(folder, name):
    (folder / name).unlink()
    with pytest.raises(UsageError, match=name):
        read_run(folder).in_world()


def test_a_model_without_a_foot_of_the_card_is_refused(folder):
    """And not by the processes that draw, as a film that fails."""
    model = folder / "model.xml"
    model.write_text(model.read_text().replace('"foot_1"', '"toe_1"'))
    sealed(folder)
    with pytest.raises(UsageError, match="its files do not fit together"):
        film_folder(folder, stretch=(0.0, 1.0))


@pytest.mark.parametrize(
    ("file", "lacks"),
    [("commands.npz", "time"), ("trajectory.npz", "center_of_mass")],
)
def test_a_run_without_what_every_run_has_is_none(folder, file, lacks):
    with np.load(folder / file) as arrays:
        kept = {name: arrays[name] for name in arrays if name != lacks}
    np.savez_compressed(folder / file, **kept)
    sealed(folder)
    with pytest.raises(UsageError, match=f"it lacks '{lacks} in {file}'"):
        read_run(folder)


def test_a_summary_of_another_form_is_refused_whoever_reads_it(folder):
    path = folder / "summary.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"predicted": 1.5}))
    with pytest.raises(UsageError, match="its files do not fit together"):
        read_run(folder)


def test_a_folder_without_a_scenario_is_no_run(folder):
    (folder / "scenario.toml").unlink()
    with pytest.raises(UsageError, match="not a finished run, it lacks scenario.toml"):
        read_run(folder).in_world()


def test_phases_that_are_cut_or_endless_are_refused(folder):
    path = folder / "flows.csv"
    whole = path.read_text()
    path.write_text(whole[:900])
    with pytest.raises(UsageError, match="flows.csv is incomplete"):
        read_run(folder).in_world()
    path.write_text(whole + "1" * 200_000)
    with pytest.raises(UsageError, match="field larger than field limit"):
        read_run(folder).in_world()


def test_arrays_that_are_no_longer_compressed_are_refused(folder):
    path = folder / "trajectory.npz"
    content = bytearray(path.read_bytes())
    for start in (m.end() for m in re.finditer(rb"PK\x03\x04.{26,60}?npy", content)):
        content[start + 20 : start + 60] = b"\xff" * 40
    path.write_bytes(content)
    with pytest.raises(UsageError, match=r"npz or commands\.npz, are damaged"):
        read_run(folder).in_world()


def test_a_truncated_trajectory_is_refused(folder):
    path = folder / "trajectory.npz"
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(UsageError, match="not a finished run"):
        read_run(folder).in_world()


def test_a_missing_array_is_named(folder):
    with np.load(folder / "trajectory.npz") as file:
        arrays = dict(file)
    del arrays["world_start_pose"]
    np.savez(folder / "trajectory.npz", **arrays)
    sealed(folder)
    with pytest.raises(UsageError, match="it lacks 'world_start_pose'"):
        read_run(folder).in_world()


@pytest.mark.parametrize(
    ("executable", "message"),
    [
        (
            "/nowhere/ffmpeg",
            "no ffmpeg, No such file or directory: /nowhere/ffmpeg; pip",
        ),
        ("/bin/false", "ffmpeg failed, exit code 1: /bin/false; pip install"),
        ("/bin/true", "cannot encode libx264: /bin/true; pip install"),
    ],
)
def test_an_encoder_that_will_not_do_is_refused_beforehand(
    monkeypatch, executable, message
):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", executable)
    with pytest.raises(RenderError, match=message):
        check_encoder()


def test_pieces_are_joined_in_their_order(tmp_path):
    levels = (20, 80, 140, 200)
    pieces = [tmp_path / "0.mp4", tmp_path / "1.mp4"]
    for path, pair in zip(pieces, (levels[:2], levels[2:]), strict=True):
        with encoding(path) as append:
            for level in pair:
                append(np.full((720, 1280, 3), level, np.uint8))
    joined = tmp_path / "joined.mp4"
    join(pieces, joined)
    assert count_pictures(joined) == len(levels)
    seen = decode(joined).mean(axis=(1, 2, 3))
    assert seen == pytest.approx(levels, abs=3)  # the codec's rounding


def test_a_missing_piece_is_an_error(tmp_path):
    with pytest.raises(RenderError, match="ffmpeg failed, .*"):
        join([tmp_path / "0.mp4"], tmp_path / "joined.mp4")


@pytest.mark.parametrize("content", [b"", b"no film", os.urandom(1000)])
def test_what_is_no_film_holds_no_pictures(tmp_path, content):
    path = tmp_path / "film.mp4"
    path.write_bytes(content)
    assert count_pictures(path) == 0


def draw_beside(film, used):
    with run_film._scratch(film) as scratch:
        used.put(scratch)


def test_films_of_one_name_that_are_drawn_at_once_do_not_disturb_each_other(tmp_path):
    film, used = tmp_path / "video.mp4", FORKS.Queue()
    with run_film._scratch(film) as mine:
        (mine / "0.mp4").touch()
        beside = FORKS.Process(target=draw_beside, args=(film, used))
        beside.start()
        assert used.get(timeout=60) != mine
        beside.join(60)
        assert (mine / "0.mp4").exists()
    assert not [*tmp_path.iterdir()]


def test_pieces_of_a_film_that_was_killed_go_as_the_next_one_is_drawn(tmp_path):
    """And not before: a film that is still drawn beside it needs its own."""
    film, used = tmp_path / "video.mp4", FORKS.Queue()
    other = tmp_path / ".another.1.pieces"
    other.mkdir()
    killed = FORKS.Process(target=draw_for_ever, args=(film, used))
    killed.start()
    left = used.get(timeout=60)
    with run_film._scratch(film):
        assert left.exists()
        killed.kill()
        killed.join(60)
    assert left.exists()
    with run_film._scratch(film) as mine:
        assert not left.exists()
        with run_film._scratch(film):
            assert mine.exists()
    assert [*tmp_path.iterdir()] == [other]


def draw_for_ever(film, used):
    with run_film._scratch(film) as scratch:
        used.put(scratch)
        time.sleep(600)
