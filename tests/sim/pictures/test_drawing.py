"""What a film shows when: drawing, clock, camera and words; nothing is drawn."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.pictures.camera import HEIGHT, VIEW_DISTANCE, WIDTH, camera
from sim.pictures.captions import describe
from sim.pictures.clock import FILM_LENGTH, FRAME_RATE, RESULTS, TAIL, TITLE, clock
from sim.pictures.drawing import (
    CORNERS,
    MOST_DASHES,
    dashes,
    discs,
    join,
    polygons,
    ribbon,
)
from sim.pictures.legend import noun
from tests.finished_runs import phase
from tests.screen import on_screen

AIR = "tripod 1 waits in the air"
ZIGZAG = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 4.0]])


def area(drawing):
    (ax, ay), (bx, by) = np.moveaxis(
        drawing.points[:, 1:] - drawing.points[:, :1], (1, 2), (0, 1)
    )
    return float((ax * by - ay * bx).sum() / 2)


def test_a_ribbon_covers_its_line_and_half_a_width_beyond_each_piece():
    drawing = ribbon(ZIGZAG, np.arange(4), width=0.1)
    assert area(drawing) == pytest.approx(0.1 * (3.1 + 4.1))


def test_a_ribbon_grows_with_the_points_it_leads_to():
    drawing = ribbon(ZIGZAG, np.array([0, 5, 6, 9]), width=0.1)
    assert [drawing.visible(frame) for frame in (4, 5, 8, 9)] == [
        (0, 0), (0, 2), (0, 2), (0, 4),
    ]  # fmt: skip


def test_a_jump_is_no_path():
    drawing = ribbon(ZIGZAG, np.arange(4), width=0.1, jump=3.5)
    assert area(drawing) == pytest.approx(0.1 * 3.1)


@pytest.mark.parametrize(
    ("life", "discs_seen"), [(1, [0, 0, 1, 1, 0, 1, 0]), (2, [0, 0, 1, 2, 1, 1, 1])]
)
def test_ink_is_gone_after_its_life(life, discs_seen):
    drawing = join([discs(np.zeros((3, 2)), np.array([2, 3, 5]), 1.0)], life=life)
    counts = [drawing.visible(frame)[1] // (CORNERS - 2) for frame in range(7)]
    assert counts == discs_seen


def test_dashes_follow_the_line_round_a_corner_and_cover_half_of_it():
    corner = np.array([[0.0, 0.0], [0.1, 0.0], [0.1, 1.0]])
    drawing = dashes(corner, period=0.11, width=1e-6)
    assert area(drawing) == pytest.approx(1e-6 * 1.1 / 2, rel=1e-3)  # the ends add 2e-5
    assert drawing.points[..., 0].max() == pytest.approx(0.1, abs=1e-5)


def test_a_long_line_has_longer_dashes():
    drawing = dashes(np.array([[0.0, 0.0], [1e5, 0.0]]), period=0.1, width=1.0)
    assert len(drawing) == 2 * MOST_DASHES
    assert area(drawing) == pytest.approx(5000 * (10 + 1))  # of 10 m, and their ends


def test_a_point_has_no_dashes():
    assert len(dashes(np.zeros((5, 2)), period=0.1, width=0.01)) == 0


def test_a_polygon_is_filled():
    square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    assert area(polygons([square, square], [0, 1])) == pytest.approx(8.0)


def test_joined_ink_is_in_the_order_of_its_frames_and_keeps_shapes_apart():
    late = discs(np.zeros((1, 2)), np.array([7]), 1.0)
    early = ribbon(ZIGZAG, np.array([0, 1, 2, 3]), 0.1)
    both = join([late, early])
    assert (np.diff(both.frames) >= 0).all()
    assert area(both) == pytest.approx(area(late) + area(early))
    assert len(np.unique(both.shapes)) == 3


@pytest.mark.parametrize("duration", [0.0, 3.0, 38.0, 39.0, 254.0, 1e4, 1e6])
def test_films_stay_short_and_end_with_the_walk(duration):
    time = np.linspace(0, duration, 1001)
    film = clock(time)
    assert len(film.scene) <= FILM_LENGTH * FRAME_RATE
    assert film.rows[-1] == 1000
    assert (np.diff(film.rows) >= 0).all()


@pytest.mark.parametrize(
    ("duration", "playback"), [(38.0, 1), (39.0, 2), (254.0, 8), (1000.0, 30)]
)
def test_a_film_plays_in_real_time_or_at_the_lowest_round_speed(duration, playback):
    assert clock(np.linspace(0, duration, 1001)).playback == playback


@pytest.mark.parametrize("playback", [0.5, 1.0, 7.0])
def test_a_scenario_can_set_the_speed(playback):
    film = clock(np.linspace(0, 70.0, 7001), playback)
    seconds = len(film.scene) / FRAME_RATE - TAIL
    assert seconds == pytest.approx(70 / playback, abs=1 / FRAME_RATE)


def test_a_picture_shows_its_own_moment():
    time = np.arange(0, 60, 0.01)
    film = clock(time, playback=2.0)
    moving = film.scene[: -round(TAIL * FRAME_RATE)]
    moments = np.arange(len(moving)) * 2.0 / FRAME_RATE
    # A row is at most one sample late.
    assert (np.abs(time[film.rows[moving]] - moments) <= 0.01 + 1e-9).all()


def test_cards_stand_before_and_after_a_whole_walk():
    film = clock(np.linspace(0, 10.0, 1001))
    assert film.scene.start == round(TITLE * FRAME_RATE)
    assert len(film.rows) - film.scene.stop == round(RESULTS * FRAME_RATE)
    assert set(film.rows[: film.scene.start]) == {0}
    assert set(film.rows[film.scene.stop :]) == {1000}


def walk_along(path, reach=0.2):
    """A robot of six feet that slides along a path."""
    angles = np.radians([60, 0, 300, 240, 180, 120])
    ring = reach * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = path[:, None, :2] + ring
    return SimpleNamespace(
        nominal=path,
        achieved=path,
        contact_point=points,
        contact=np.ones(points.shape[:2], dtype=bool),
        reach=reach,
    )


@pytest.mark.parametrize("goal", [(0.2, 0.0), (0.0, 0.3), (-0.15, 0.1), (0.0, 0.0)])
def test_the_whole_walk_is_in_the_picture_clear_of_the_captions(goal):
    s = np.linspace(0, 1, 50)[:, None]
    walk = walk_along(np.hstack([s * goal, 0 * s]))
    view = camera(walk, clock(np.linspace(0, 5, 50)))
    feet = np.insert(walk.contact_point.reshape(-1, 2), 2, 0.0, axis=1)
    for frame in (0, len(view.azimuth) - 1):
        x, y = on_screen(view, frame, feet).T
        assert x.min() > 100
        assert x.max() < WIDTH
        assert y.min() > 0
        assert y.max() < HEIGHT - 112  # the bar at the bottom begins there


def test_a_path_runs_across_the_picture_from_left_to_right():
    s = np.linspace(0, 1, 50)[:, None]
    walk = walk_along(np.hstack([s * (0.2, 0.2), 0 * s]))
    view = camera(walk, clock(np.linspace(0, 5, 50)))
    start, end = on_screen(view, 0, np.insert(walk.nominal[[0, -1], :2], 2, 0, axis=1))
    assert end[0] - start[0] > 4 * abs(end[1] - start[1])


def test_the_camera_follows_a_walk_much_longer_than_the_robot():
    s = np.linspace(0, 1, 400)[:, None]
    walk = walk_along(np.hstack([s * (8.0, 0.0), 0 * s]))
    film = clock(np.linspace(0, 30, 400))
    view = camera(walk, film)
    assert view.distance == pytest.approx(VIEW_DISTANCE * walk.reach)
    for frame in range(0, len(film.rows), 100):
        feet = np.insert(walk.contact_point[film.rows[frame]], 2, 0.0, axis=1)
        pixels = on_screen(view, frame, feet)
        assert ((pixels > 0) & (pixels < (WIDTH, HEIGHT))).all()


def test_the_camera_moves_calmly():
    s = np.linspace(0, 1, 400)[:, None]
    jerky = np.floor(s * 20) / 20
    walk = walk_along(np.hstack([jerky * (8.0, 0.0), 0 * s]))
    view = camera(walk, clock(np.linspace(0, 30, 400)))
    steps = np.linalg.norm(np.diff(view.target, axis=0), axis=1)
    assert steps.max() < 3 * np.median(steps)


@pytest.mark.parametrize(
    ("flow", "words"),
    [
        (phase("hold", "12", ""), "tripods 1 and 2 stand"),
        (phase("lift", "1", "2"), "tripod 1 stands, tripod 2 lifts"),
        (phase("swing", "1", "2"), "tripod 1 stands, tripod 2 swings in the air"),
        (phase("swing", "2", "2"), f"{AIR}, tripod 2 swings the body"),
        (phase("land", "1", "2"), "tripod 1 stands, tripod 2 lands"),
        (phase("swing", "12", "2"), "tripod 1 stands, tripod 2 swings the body"),
        (phase("lift", "", "1"), "tripod 1 lifts, tripod 2 waits in the air"),
    ],
)
def test_a_stratum_is_put_into_words(flow, words):
    assert describe(flow, "12", "tripod") == words


def test_groups_that_swing_together_are_named_together():
    words = describe(phase("swing", "12", "12"), "12", "tripod")
    assert words == "tripods 1 and 2 swing the body"


def test_legs_that_do_the_same_are_named_together():
    words = describe(phase("swing", "134", "2"), "1234", "leg")
    assert words == "legs 1, 3 and 4 stand, leg 2 swings in the air"


@pytest.mark.parametrize(
    ("legs", "called"), [(1, "leg"), (2, "pair"), (4, "tetrapod"), (9, "group")]
)
def test_a_group_is_called_after_its_number_of_legs(legs, called):
    group = SimpleNamespace(legs=range(legs))
    card = SimpleNamespace(groups={"1": group, "2": group})
    assert noun(SimpleNamespace(card=card)) == called
