"""Plans of systems: their pictures, and what their coordinates come to."""

import math

import pytest

from tests.sim.commands.test_systems import LINE, facts, stratawalk

__all__ = ["facts", "stratawalk"]


def test_a_picture_shows_headings_and_tells_start_goal_and_end_apart(
    stratawalk, tmp_path
):
    """Of 81 states of the four flows every fifth has an arrow, and the goal has one."""
    (tmp_path / "track.toml").write_text(LINE.replace('"x", "y"', '"x"'))
    for words, arrows in {
        "unicycle --segments 1": 18,
        "heisenberg": 0,
        "track.toml": 0,
    }.items():
        name = words.split(".")[0].split()[0]
        assert stratawalk("plan", *words.split(), "--out", f"{name}.svg")[0] == 0
        drawn = (tmp_path / f"{name}.svg").read_text()
        _, _, quiver = drawn.partition('<g id="Quiver_1">')
        assert quiver.partition("</g>")[0].count("<path ") == arrows
        assert all(f"<!-- {mark} -->" in drawn for mark in ("start", "goal", "end"))


def test_the_title_of_a_picture_counts_all_coordinates(facts, stratawalk, tmp_path):
    error = facts("plan", "car", "--segments", "2", "--out", "e.svg")["error"]
    title = f"<!-- car, ends {error:.2g} off its goal -->"
    assert title in (tmp_path / "e.svg").read_text()


def test_the_largest_value_of_each_coordinate_on_the_way_is_told(facts, stratawalk):
    """A wheel that turns by a radian, drives by one, turns back and drives back."""
    largest = facts("plan", "unicycle", "--segments", "1")["largest"]
    expected = {"x": math.cos(1), "y": math.sin(1), "theta": 1}
    assert largest == pytest.approx(expected)
    code, out, _ = stratawalk("plan", "unicycle", "--segments", "1")
    assert "at most   x 0.5403, y 0.8415, theta 1.0000\n" in out


def test_one_system_is_listed_with_the_coordinates_of_its_goals(stratawalk):
    _, out, _ = stratawalk("systems", "car-trailers")
    assert "coordinates x, y, theta_0, theta_1, phi\n" in out


def test_a_plan_is_saved_last_so_that_the_command_can_be_given_again(
    stratawalk, tmp_path, monkeypatch
):
    """Whoever is interrupted while the picture is drawn has no plan in the way."""

    def interrupted(*_):
        raise KeyboardInterrupt

    words = (
        "plan",
        "unicycle",
        "--segments",
        "1",
        "--out",
        "u.svg",
        "--save",
        "u.json",
    )
    with monkeypatch.context() as patched:
        patched.setattr("sim.commands.plan._draw", interrupted)
        code, _, err = stratawalk(*words)
    assert (code, "again: stratawalk plan unicycle" in err) == (130, True)
    assert not (tmp_path / "u.json").exists()
    assert stratawalk(*words)[0] == 0
    assert (tmp_path / "u.json").exists()


def test_saved_plan_has_a_name(stratawalk):
    code, _, err = stratawalk("plan", "car", "--save", "")
    assert (code, "an empty name: --save; give a name" in err) == (2, True)


def test_a_picture_has_the_plan_s_name_as_text(stratawalk, tmp_path):
    """What stands between two dollar signs is no mathematics."""
    stratawalk("plan", "heisenberg", "--segments", "1", "--save", "$^$.json")
    code, *_ = stratawalk("plan", "$^$.json", "--out", "drawn.png")
    assert (code, (tmp_path / "drawn.png").exists()) == (0, True)
