"""What stands on the pictures: key, scales, numbers on legs and the inset."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import ImageDraw

from sim import palette
from sim.pictures.camera import HEIGHT, VIEWS, WIDTH, camera, view_of
from sim.pictures.captions import CARDS, SCALE, Captions, _results, scale_bar
from sim.pictures.clock import clock
from sim.pictures.ghost import farthest_ghost
from sim.pictures.inset import APART, BOX, FILL, RIM, TIP, TOP, inset, magnification
from sim.pictures.legend import ENTRIES, PAD, SEEN, SMALL, _lines, fitting, length, nose
from sim.pictures.marks import cell, grid
from sim.pictures.run_film import is_held
from sim.runs.run import read_run
from tests.finished_runs import predicted_elsewhere
from tests.screen import on_screen

PAPER = np.array(palette.PAPER)


@pytest.fixture(scope="module")
def walk(walked):
    return read_run(walked).in_world()


@pytest.fixture(scope="module")
def film(walk):
    return clock(walk.time, walk.scenario.playback)


@pytest.fixture(scope="module")
def view(walk, film):
    return camera(walk, film)


@pytest.mark.parametrize("name", [*VIEWS, "30,-6"])
def test_the_camera_says_where_a_point_is_on_the_picture(walk, film, name):
    view = camera(walk, film, view_of(name))
    points = np.array([[0.0, 0.0, 0.0], [0.2, -0.1, 0.05], [-0.1, 0.3, 0.1]])
    for frame in (0, len(film.rows) - 1):
        np.testing.assert_allclose(
            view.pixels(frame, points), on_screen(view, frame, points), atol=1e-6
        )


@pytest.mark.parametrize("reach", [0.012, 0.2344, 1.0, 37.0])
def test_a_cell_of_the_grid_is_a_round_length_of_about_half_a_reach(reach):
    assert 0.3 < cell(reach) / reach < 0.75
    digits = cell(reach) / 10 ** np.floor(np.log10(cell(reach)) + 1e-9)
    assert digits == pytest.approx(round(digits))
    assert round(digits) in (1, 2, 5)


def test_the_grid_covers_the_floor_in_view(walk, film, view):
    points = grid(view, walk.reach).drawing.points.reshape(-1, 2)
    low, high = points.min(axis=0), points.max(axis=0)
    for frame in (0, len(film.rows) // 2, len(film.rows) - 1):
        for corner in ((0, 0), (WIDTH, 0), (0, HEIGHT), (WIDTH, HEIGHT)):
            place = on_floor(view, frame, corner)
            assert (low < place).all()
            assert (place < high).all()


def test_the_grid_of_a_wide_floor_has_larger_cells(view):
    seen = np.array([-1e5, -10.0]), np.array([1e5, 10.0])
    wide = SimpleNamespace(floor_seen=lambda: seen, azimuth=view.azimuth,
                           eyes=view.eyes, pixel=view.pixel)  # fmt: skip
    assert len(grid(wide, 0.2).drawing) < 5 * 1500 * 12 * 2
    assert len(grid(wide, 0.2).drawing) > 500 * 12 * 2


def test_words_that_fit_nowhere_are_cut_at_once():
    """Letter by letter it would take minutes."""
    cut = fitting("W" * 10**5, 300)
    assert cut.endswith("W...")
    assert length(cut, SMALL) <= 300 < length(f"W{cut}", SMALL)


def on_floor(view, frame, pixel):
    """The point of the floor at a pixel, found by moving three known points about."""
    known = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.1], [0.1, 0.1]])
    seen = on_screen(view, frame, np.insert(known, 2, 0.0, axis=1))
    rows, values = [], []
    for (x, y), (u, v) in zip(known, seen, strict=True):  # a plane's view: homography
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
        values += [u, v]
    matrix = np.append(np.linalg.solve(rows, values), 1.0).reshape(3, 3)
    x, y, scale = np.linalg.solve(matrix, [*pixel, 1.0])
    return np.array([x, y]) / scale


def test_the_scale_bar_is_as_long_as_what_lies_at_its_place(walk, view):
    panel = scale_bar(view, walk.reach)
    dark = np.asarray(panel.still)[..., :3].astype(int)[SCALE - 15]
    drawn = np.flatnonzero((np.abs(dark - palette.TEXT) < 40).all(axis=1))
    y = panel.top + SCALE - 15
    left, right = (on_floor(view, 0, (panel.left + x, y)) for x in drawn[[0, -1]])
    # The panel measures it at two thirds of its own height, a few pixels higher.
    length = np.hypot(*(right - left))
    assert length == pytest.approx(cell(walk.reach), rel=0.03)


def test_the_key_has_six_entries_at_most(walk):
    assert [label for label, _, _ in _lines(walk, scale=1.0)] == [
        "nominal path, goal", "ideal prediction", "compliant prediction",
        "achieved path", "support, centre of mass", "footprints, fading",
    ]  # fmt: skip
    beside = replace(walk, settings={**walk.settings})
    beside.__dict__["thought"] = (walk.nominal[:2, :2],)
    assert len(_lines(beside, scale=1.0)) == ENTRIES == 6
    assert nose(walk) == (242, 140, 38)  # of the file, 0.95 0.55 0.15


def test_the_key_has_a_ghost_only_where_it_is_seen_beside_the_robot(walk):
    off = farthest_ghost(walk)
    unseen, seen = (_lines(walk, share * SEEN / off)[1][0] for share in (0.99, 1.01))
    assert (unseen, seen) == ("ideal prediction", "ideal prediction, ghost")


@pytest.mark.parametrize(("more", "told"), [(1.01, True), (0.99, False)])
def test_the_last_card_says_why_feet_slip_farther_than_the_path_is_long(
    walk, more, told
):
    achieved = replace(walk.summary.achieved, slip=more * walk.summary.path_length)
    other = replace(walk)
    summary = replace(walk.summary, achieved=achieved, verdict="arrived")
    other.__dict__["summary"] = summary
    assert (_results(other)[-1:] == CARDS["slipping"]) == told


def test_the_inset_points_ahead_as_the_body_does_in_the_picture(walk, view):
    turned, angle = walk.achieved.copy(), np.radians(view.azimuth.mean())
    still = inset(walk, view, 100).still
    other = replace(walk)
    other.__dict__["achieved"] = turned
    middle = np.array([PAD + BOX / 2, TOP + BOX / 2])
    for yaw, way in ((angle - np.pi / 2, (1, 0)), (angle, (0, -1))):
        turned[:, 2] = yaw  # to the right, and away
        panel = inset(other, view, 100)
        drawn = panel.still.copy()
        panel.write(ImageDraw.Draw(drawn), 0)
        x, y = (middle + (RIM - TIP / 2) * np.array(way)).astype(int).tolist()
        assert drawn.getpixel((x, y))[:3] == palette.TEXT
        assert still.getpixel((x, y))[:3] != palette.TEXT


def test_cards_say_what_is_walked_and_what_came_of_it(walk, film, view):
    captions, scene = Captions(walk, film, view), film.scene
    behind = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    title, results = behind.copy(), behind.copy()
    captions.lay_card(title, 0)
    captions.lay_card(results, len(film.rows) - 1)
    assert (title != results).any()
    assert (title[0, 0] > 0.9 * np.array(palette.PAPER)).all()
    assert (title[0, -1] < 0.6 * np.array(palette.PAPER)).all()  # a robot is seen
    said = " ".join(_results(walk))
    assert said.count(walk.summary.verdict) == 1
    assert f"slip: {1e3 * walk.summary.achieved.slip:.1f} mm" in said
    assert (scene.start, scene.stop) == (50, len(film.rows) - 75)


def test_the_sentences_of_cards_end_beside_the_robot(walk, film, view):
    other = replace(walk)
    long = "arrived: 0.25 mm from the goal and 0.01 mm from the end of its prediction"
    other.__dict__["summary"] = replace(walk.summary, verdict_text=long)
    plain = np.full((HEIGHT, WIDTH, 3), palette.PAPER, np.uint8)
    for frame in (0, len(film.rows) - 1):
        Captions(other, film, view).lay_card(card := plain.copy(), frame)
        written = np.flatnonzero((card < plain - 9.0).any((0, 2)))
        assert 100 < written[0] < written[-1] < 0.55 * WIDTH  # the picture is there


@pytest.mark.parametrize(
    ("largest", "room", "factor"),
    [(1e-3, 0.0501, 50), (1e-3, 0.049, 20), (0.2, 0.05, 0.2), (2e-4, 0.1, 500)],
)
def test_the_error_is_magnified_by_the_greatest_round_factor_that_fits(
    largest, room, factor
):
    assert magnification(largest, room) == pytest.approx(factor)


def test_the_inset_shows_the_error_turned_and_scaled_as_the_picture_is(walk, view):
    angle = np.radians(view.azimuth.mean())
    right = np.array([np.sin(angle), -np.cos(angle)])  # on the floor
    off = 0.001 * right
    moved = walk.achieved.copy()
    moved[:, :2] -= off
    shown = predicted_elsewhere(walk, lambda poses: moved)
    panel = inset(shown, view, 300)
    scale = 1 / (view.pixel * view.distance)
    factor = magnification(0.001, BOX / 2 * FILL / scale)
    middle = PAD + BOX + APART + BOX / 2, TOP + BOX / 2  # of the best prediction
    place = np.add(middle, (0.001 * factor * scale, 0))
    picture = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    panel.put(picture, 5)
    x, y = np.round(place + (panel.left, panel.top)).astype(int)
    drawn = {tuple(picture[y, x]), tuple(picture[y + 1, x])}
    assert palette.PREDICTED[walk.best].colour in drawn


def test_a_walk_without_error_has_an_inset(walk, view):
    same = predicted_elsewhere(walk, lambda poses: walk.achieved)
    picture = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    inset(same, view, 300).put(picture, 3)
    assert picture.any()


def test_only_pictures_that_change_are_drawn(film, view):
    drawn = [i for i in range(1, len(film.rows)) if not is_held(film, view, i)]
    first, last = film.scene.start, film.scene.stop
    ended = int(np.searchsorted(film.rows, film.rows[-1]))
    assert drawn[0] == first
    assert drawn[-2:] == [ended, last]
