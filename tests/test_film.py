"""Real films of a real walk, decoded again, and every way in which filming fails."""

import os
import shutil
import subprocess

import numpy as np
import pytest

from sim import film_crew, gl
from sim import film_style as style
from sim.errors import ExitCode, FilesError, RenderError, UsageError
from sim.film import check, film
from sim.film_camera import camera
from sim.film_clock import clock
from sim.film_crew import Piece
from sim.film_file import check_encoder, count_pictures, encoding, join
from sim.film_walk import read_walk
from sim.folder import RunFolder
from sim.nominal import line
from sim.run import run
from sim.scenario import Scenario
from tests.screen import FFMPEG, decode, on_screen

CLOCK = np.s_[20:60, 1110:1260]  # where the time stands
LEGEND = np.s_[90:300, 30:280]
BAR = np.s_[612:650, 30:600]  # where the stratum is put into words


@pytest.fixture(scope="module")
def driver():
    try:
        return check()
    except RenderError as error:
        pytest.skip(f"no films on this machine: {error}")


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """Run folder of 3 cm straight ahead, 15 s played in a quarter of one."""
    folder = tmp_path_factory.mktemp("walked")
    path = line((0.03, 0.0, 0.0))
    run(Scenario(name="short", segments=2, path=path, playback=60.0), RunFolder(folder))
    return folder


@pytest.fixture
def folder(walked, tmp_path):
    """A copy of the run folder, to be spoilt."""
    return shutil.copytree(walked, tmp_path / "it's a: run")


@pytest.fixture(scope="module")
def filmed(driver, walked, tmp_path_factory):
    folder = tmp_path_factory.mktemp("filmed") / "run"
    shutil.copytree(walked, folder)
    return film(folder)


@pytest.fixture(scope="module")
def decoded(filmed):
    return decode(filmed)


@pytest.fixture
def ffmpeg(monkeypatch, tmp_path):
    """Replace ffmpeg by a shell script in which $REAL is the real one."""

    def replace(script):
        path = tmp_path / "ffmpeg"
        path.write_text(f"#!/bin/bash\nREAL='{FFMPEG}'\n{script}\n")
        path.chmod(0o755)
        monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(path))

    return replace


def draw(folder, frames, driver, look="draft"):
    """Some pictures of a film, without the rest."""
    path = folder / f"piece-{look}-{driver}.mp4"
    film_crew.draw([Piece(folder, look, frames, path)], driver, lambda drawn: None)
    return decode(path)


def view_of(folder):
    walk = read_walk(folder)
    film_clock = clock(walk.time, walk.scenario.playback)
    return walk, film_clock, camera(walk, film_clock)


def colours_at(picture, view, frame, point, around=2):
    """Colours of the pixels around a point on the floor, shape (n, 3)."""
    x, y = np.round(on_screen(view, frame, np.append(point, 0.0))).astype(int)
    area = picture[y - around : y + around + 1, x - around : x + around + 1]
    return area.reshape(-1, 3).astype(int)


def difference(one, other):
    return float(np.abs(one.astype(int) - other).mean())


@pytest.mark.render
def test_a_film_holds_every_picture_at_its_size_and_rate(filmed, decoded):
    walk, film_clock, _ = view_of(filmed.parent)
    assert len(decoded) == len(film_clock.rows) == count_pictures(filmed)
    about = subprocess.run(
        [FFMPEG, "-i", filmed], capture_output=True, text=True
    ).stderr
    assert "h264" in about
    assert "1280x720" in about
    assert " 30 fps" in about


@pytest.mark.render
def test_filming_adds_the_film_and_nothing_else(filmed, walked):
    added = {p.name for p in filmed.parent.iterdir()} - {
        p.name for p in walked.iterdir()
    }
    assert added == {"video.mp4"}


@pytest.mark.render
def test_captions_change_with_the_walk_and_the_legend_does_not(decoded):
    # The codec alone changes still areas by less than 1 of 255.
    first, last = decoded[0], decoded[-1]
    assert difference(first[CLOCK], last[CLOCK]) > 5
    assert difference(first[LEGEND], last[LEGEND]) < 2
    words = [picture[BAR] for picture in decoded[:7]]
    assert max(difference(words[0], other) for other in words[1:]) > 5


@pytest.mark.render
def test_feet_leave_prints_where_they_stood_first(filmed, decoded):
    walk, _, view = view_of(filmed.parent)
    last = len(decoded) - 1
    for foot in (1, 5):  # red, on the side of the camera, not under the body
        place = walk.contact_point[0, foot]
        (colour,) = colours_at(decoded[-1], view, last, place, around=0)
        assert np.abs(colour - style.footprint(1)).max() < 25  # 4 measured


@pytest.mark.render
def test_the_support_polygon_is_green_between_the_front_feet(filmed, decoded):
    walk, _, view = view_of(filmed.parent)
    front = walk.contact_point[-1, :2].mean(axis=0)
    inside = 0.9 * front + 0.1 * walk.achieved[-1, :2]
    outside = 1.2 * front - 0.2 * walk.achieved[-1, :2]
    last = len(decoded) - 1
    red, green, _ = colours_at(decoded[-1], view, last, inside).mean(axis=0)
    assert green - red > 25  # 47 measured
    red, green, _ = colours_at(decoded[-1], view, last, outside).mean(axis=0)
    assert abs(green - red) < 5


@pytest.mark.render
def test_paths_are_drawn_where_they_were_recorded(driver, folder):
    with np.load(folder / "trajectory.npz") as file:
        arrays = dict(file)
    # Away from the robot, where nothing covers them.
    ahead = {"achieved_pose": 0.2, "predicted_pose": 0.24, "quasi_static_pose": 0.28}
    for key, shift in ahead.items():
        arrays[key] = arrays[key] + (shift, 0.0, 0.0)
    np.savez(folder / "trajectory.npz", **arrays)
    walk, film_clock, view = view_of(folder)
    frame = len(film_clock.rows) - 1
    (picture,) = draw(folder, range(frame, frame + 1), driver)
    expected = (
        (walk.achieved, style.ACHIEVED),
        *zip(walk.predicted.values(), style.PREDICTED, strict=True),
    )
    for poses, colour in expected:
        seen = colours_at(picture, view, frame, poses[len(poses) // 3, :2])
        assert np.abs(seen - colour).max(axis=1).min() < 60  # thin lines lose colour


@pytest.mark.render
def test_the_final_look_has_shadows(driver, walked, tmp_path):
    folder = shutil.copytree(walked, tmp_path / "run")

    def grey(look):
        (picture,) = draw(folder, range(1, 2), driver, look)  # a tripod is raised
        floor = picture[:600].astype(int)
        colourless = np.ptp(floor, axis=2) < 12
        return int((colourless & (floor[..., 0] > 140) & (floor[..., 0] < 200)).sum())

    assert grey("final") > 1.5 * grey("draft")  # 2.9 measured


@pytest.mark.render
def test_every_driver_draws_the_same_picture(walked, tmp_path):
    folder, drawn = shutil.copytree(walked, tmp_path / "run"), {}
    for backend in gl.BACKENDS:
        if reason := gl._trial(backend):
            pytest.skip(f"{backend} does not draw here: {reason}")
        (drawn[backend],) = draw(folder, range(2, 3), backend)
    # Equal to the bit with one Mesa; a graphics card rounds edges differently.
    assert difference(drawn["egl"], drawn["osmesa"]) < 1


@pytest.mark.render
def test_a_film_needs_neither_the_current_folder_nor_an_empty_environment(
    driver, folder, tmp_path, monkeypatch
):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "sim").mkdir()
    (elsewhere / "sim" / "__init__.py").write_text("raise ImportError('not this one')")
    monkeypatch.chdir(elsewhere)
    monkeypatch.setenv("MUJOCO_GL", "banana")
    told = []
    assert film(folder, progress=told.append) == folder / "video.mp4"
    assert told[-1] == pytest.approx(1.0)
    assert told == sorted(told)
    assert [path.name for path in elsewhere.iterdir()] == ["sim"]


def assert_spoilt_without_a_trace(folder, before):
    assert {path.name for path in folder.iterdir()} == before


@pytest.mark.render
@pytest.mark.parametrize(
    ("script", "error", "message"),
    [
        (  # dies early: its pipe breaks
            '[[ "$*" == *rawvideo* ]] && exit 1; exec "$REAL" "$@"',
            RenderError,
            "drawing the film failed, .*; the run itself is kept",
        ),
        (  # loses pictures and reports success
            'if [[ "$*" == *rawvideo* ]]; then\n'
            '  { head -c $((5 * 1280 * 720 * 3)) | "$REAL" "$@"; cat > /dev/null; }\n'
            'else exec "$REAL" "$@"; fi',
            RenderError,
            "film cut short, 5 of 52 pictures: .*video.mp4; the run itself is kept",
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
            "disk full while filming: .*; free some space",
        ),
    ],
    ids=["dies", "loses", "silent", "full"],
)
def test_an_encoder_that_fails_leaves_no_film(
    driver, folder, ffmpeg, script, error, message
):
    before = {path.name for path in folder.iterdir()}
    ffmpeg(script)
    with pytest.raises(error, match=message):
        film(folder)
    assert_spoilt_without_a_trace(folder, before)


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
    monkeypatch.setattr(film_crew, "PATIENCE", 0.3)
    piece = Piece(walked, "draft", range(2), walked / "none.mp4")
    with pytest.raises(RenderError, match=message) as error:
        film_crew.draw([piece, piece], "egl", lambda drawn: None)
    assert error.value.exit_code is ExitCode.RENDER


def test_an_unknown_look_is_refused(walked):
    with pytest.raises(
        UsageError, match="unknown look 'fine': film; known are draft, f"
    ):
        film(walked, look="fine")


@pytest.mark.parametrize(
    "name", ["model.xml", "card.toml", "scenario.toml", "flows.csv", "trajectory.npz"]
)
def test_an_unfinished_run_is_refused(folder, name):
    (folder / name).unlink()
    with pytest.raises(UsageError, match=name):
        read_walk(folder)


def test_a_truncated_trajectory_is_refused(folder):
    path = folder / "trajectory.npz"
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(UsageError, match="no film of an unfinished run"):
        read_walk(folder)


def test_a_missing_array_is_named(folder):
    np.savez(folder / "trajectory.npz", time=np.zeros(3))
    with pytest.raises(UsageError, match="world_start_pose"):
        read_walk(folder)


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
        with encoding(path) as writer:
            for level in pair:
                writer.append_data(np.full((720, 1280, 3), level, np.uint8))
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
