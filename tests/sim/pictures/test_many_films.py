"""Films from any thread, and many of them: each is drawn by processes of its own."""

import resource
from threading import Thread

import pytest

from planner.support import remove_unfinished
from sim.pictures import run_film
from sim.pictures.file import count_pictures
from sim.pictures.run_film import film_folder

SHORT = (0.0, 5.0)  # [s] of the walk


@pytest.mark.render
def test_a_film_may_be_drawn_from_any_thread(folder, driver):
    films = []
    thread = Thread(target=lambda: films.append(film_folder(folder, stretch=SHORT)))
    thread.start()
    thread.join()
    assert count_pictures(films[0]) > 0


@pytest.mark.render
def test_pieces_of_a_film_that_ends_at_once_are_removed(folder, driver, monkeypatch):
    before = {entry.name for entry in folder.iterdir()}

    def end_at_once(pieces, *_):
        assert pieces[0].path.parent.parent == folder
        remove_unfinished()
        assert {entry.name for entry in folder.iterdir()} == before
        raise KeyboardInterrupt

    monkeypatch.setattr(run_film, "draw", end_at_once)
    with pytest.raises(KeyboardInterrupt):
        film_folder(folder, stretch=SHORT)


@pytest.mark.full
@pytest.mark.render
def test_films_one_after_another_take_no_more_memory(folder, driver):
    used = []
    for _ in range(4):
        film_folder(folder, stretch=SHORT)
        used.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
    assert used[-1] - used[0] < 20  # MB; a renderer that is left open takes 25
