"""Small changes move the end of a walk, and none of them leaves the robot as it is."""

import json
from dataclasses import replace

import numpy as np
import pytest

from sim.commands import sensitivities
from sim.compliant.phases import Course
from sim.compliant.variations import effects, variations
from sim.runs.run import read_run
from tests.planned import course

LEGS = (1, 2, 3, 4, 5, 6)


@pytest.fixture(scope="module")
def begun():
    """The first strokes of a walk on soft servos."""
    _, phases, way, _ = course(servo_stiffness=50.0)
    spans, heading = way.spans[:6], way.heading[:6]
    return phases, Course(way.commands, spans, heading, way.restarts)


def test_every_leg_has_zeros_and_a_length(begun):
    found = [each.what for each in variations(begun[0], LEGS)]
    assert len(found) == len(set(found)) == 12 + 6 + 4
    assert "zero of joint 2 of leg 6" in found
    assert "length of leg 1" in found


def test_an_effect_is_a_slope(begun, monkeypatch):
    """Half of the change does half as much, within a fifth where feet slide."""

    def friction():
        last = list(variations(begun[0], LEGS))[-4:-3]  # the payload
        monkeypatch.setattr("sim.compliant.variations.variations", lambda *_: last)
        ((_, moved),) = effects(*begun, LEGS)
        return moved

    whole = friction()
    monkeypatch.undo()
    monkeypatch.setattr("sim.compliant.variations.SHARE", 0.125)
    assert np.abs(friction() - whole).max() < 0.2 * np.abs(whole).max()
    assert np.abs(whole).max() > 0


def test_the_command_gives_a_row_for_each(walked, tmp_path, monkeypatch, capsys):
    some = [{"what": f"length of leg {n}", "unit": "mm"} for n in LEGS]
    found = [row | {"x": 1e-3, "y": -1e-3, "yaw": 0.01} for row in some]
    monkeypatch.setattr(sensitivities, "rows", lambda *_: found)
    drawn = tmp_path / "above.png"
    options = type("O", (), {"run": walked, "out": drawn, "json": True})
    sensitivities.execute(options)
    assert json.loads(capsys.readouterr().out) == found
    assert drawn.stat().st_size > 1000
    sensitivities.execute(type("O", (options,), {"json": False}))
    assert "mm     length of leg 3" in capsys.readouterr().out


def test_a_finished_run_has_the_course_of_its_commands(walked):
    run = read_run(walked)
    phases, way = sensitivities._course(run)
    few = replace(way, spans=way.spans[:4], heading=way.heading[:4])
    motion = phases.follow(few)
    assert np.abs(motion.pose[-1, :2]).max() < 0.05
