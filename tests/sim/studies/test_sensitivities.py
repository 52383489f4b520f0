"""Small changes move the end of a walk, and none of them leaves the robot as it is."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from models import MeasurementError
from sim.commands import comparing
from sim.compliant.phases import Phases
from sim.errors import UsageError
from sim.runs.run import read_run
from sim.studies import sensitivities as library
from sim.studies.sensitivities import (
    changes_of,
    course_of_run,
    sensitivities,
)
from tests.planned import course

LEGS = (1, 2, 3, 4, 5, 6)


@pytest.fixture(scope="module")
def begun():
    """The first strokes of a walk on soft servos, and the moment of their end."""
    _, phases, way, _ = course(servo_stiffness=50.0)
    few = replace(way, spans=way.spans[:6], heading=way.heading[:6])
    return phases, few, few.spans[-1, 1:] * 0.001


@pytest.fixture(scope="module")
def chosen(begun):
    wanted = ("zero of joint 2 of leg 3", "payload in the body's middle")
    leaning = "floor that leans down to the left"
    return [c for c in changes_of(begun[0], LEGS) if c.what in (*wanted, leaning)]


def effects(begun, changes):
    phases, way, end = begun
    return sensitivities(phases, way, changes, end).pose[:, 0]


def test_every_leg_has_zeros_and_a_length(begun):
    found = [each.what for each in changes_of(begun[0], LEGS)]
    assert len(found) == len(set(found)) == 12 + 6 + 7
    assert "zero of joint 2 of leg 6" in found
    assert "length of leg 1" in found


def test_robots_side_by_side_move_as_each_does_alone(begun, chosen):
    """Within 0.1 mm and mrad a unit, as increments of pieces differ; measured 0.02."""
    phases, way, end = begun
    level_and_leaning = chosen[::2]
    together = effects(begun, level_and_leaning)
    still = phases.follow(way).at(end).pose[0]
    for each, found in zip(level_and_leaning, together, strict=True):
        alone = Phases(phases.mechanics, each.robot).follow(way).at(end).pose[0]
        assert found == pytest.approx((alone - still) / 0.25, abs=1e-4)


def test_an_effect_is_a_slope(begun, chosen, monkeypatch):
    """Half of the change does half as much, within a fifth where feet slide."""
    payload = chosen[1:2]
    whole = effects(begun, payload)
    monkeypatch.setattr(library, "SHARE", 0.125)
    half = [c for c in changes_of(begun[0], LEGS) if c.what == payload[0].what]
    assert np.abs(effects(begun, half) - whole).max() < 0.2 * np.abs(whole).max()
    assert np.abs(whole).max() > 0


def test_a_robot_that_tips_over_in_the_batch_is_told(begun, chosen):
    ahead = np.array([[0.3, 0.0, 0.05]])  # of all feet
    heavy = replace(chosen[0], robot=replace(chosen[0].robot, body_center=ahead))
    with pytest.raises(MeasurementError, match="the robot tips over"):
        effects(begun, [heavy])


def test_a_finished_run_is_asked_for_some_changes_at_some_times(walked):
    names, run = ["length of leg 2", "friction"], read_run(walked)
    phases, course = course_of_run(run)
    some = [each for each in changes_of(phases, run.legs) if each.what in names]
    found = sensitivities(phases, course, some, run.time[[0, -1]])
    assert [each.what for each in found.changes] == names
    assert found.pose.shape == found.lean.shape == (2, 2, 3)
    assert np.abs(found.unchanged.pose[-1] - run.achieved[-1]).max() < 1e-3
    assert np.abs(found.pose[1, 0]).max() < 1e-12  # friction, before it walks
    assert (found.pose[:, -1] != 0).all()


def test_the_command_gives_a_row_for_each(walked, tmp_path, monkeypatch, capsys):
    some = [{"what": f"length of leg {n}", "unit": "1 mm"} for n in LEGS]
    found = [row | {"x": 1e-3, "y": -1e-3, "yaw": 0.01} for row in some]
    monkeypatch.setattr(comparing, "rows", lambda *_: found)
    drawn = tmp_path / "above.png"
    given = {"run": walked, "out": str(drawn), "json": True, "allow_external": False}
    options = type("O", (), given)
    comparing.sensitivities(options)
    assert json.loads(capsys.readouterr().out) == found
    assert drawn.stat().st_size > 1000
    comparing.sensitivities(type("O", (options,), {"json": False, "out": None}))
    said = capsys.readouterr().out
    assert "1 mm     length of leg 3" in said
    assert said.endswith("joints of a leg are counted outward from the body\n")


@pytest.mark.parametrize("name", ["", "x", "x.xyz", "x.tex", "taken.png"])
def test_a_picture_that_cannot_be_made_is_refused_before_the_work(
    walked, tmp_path, monkeypatch, name
):
    """Neither another name is written nor what a dangling link leads to."""
    monkeypatch.chdir(tmp_path)
    Path("taken.png").symlink_to("elsewhere.png")
    monkeypatch.setattr(comparing, "rows", lambda *_: pytest.fail("it works"))
    options = type("O", (), {"run": walked, "out": name, "json": True})
    said = "already exists" if name == "taken.png" else "not a picture's name: .*; give"
    with pytest.raises(UsageError, match=said):
        comparing.sensitivities(options)
    assert [path.name for path in tmp_path.iterdir()] == ["taken.png"]


def test_kinds_of_change_in_the_picture_differ_in_colour(walked, tmp_path, monkeypatch):
    kinds = [f"kind {number}" for number in range(10)]
    found = [
        {"what": kind, "unit": "1 mm", "x": n, "y": 0} for n, kind in enumerate(kinds)
    ]
    drawn, save = [], Figure.savefig

    def kept(figure, path, **how):
        drawn.append(figure)
        save(figure, path, **how)

    monkeypatch.setattr(Figure, "savefig", kept)
    comparing.draw(read_run(walked), found, tmp_path / "above.png")
    (legend,) = drawn[0].legends
    said = [text.get_text() for text in legend.get_texts()]
    assert said == [f"1 mm: {kind}" for kind in kinds[:3:-1]]  # the farthest first
    assert len({line.get_color() for line in legend.get_lines()}) == len(said)
    names = [text.get_text() for text in drawn[0].axes[0].texts]
    assert [name for name in names if name] == [f"leg {n}" for n in LEGS]
