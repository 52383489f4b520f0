"""What a phase does is computed once, whatever was walked before it."""

from dataclasses import replace

import numpy as np
import pytest

from models import MeasurementError
from models.adoption.draft import draft_card
from models.adoption.source import source_of
from scripts.adoptees import ADOPTEES
from sim.compliant.march import march
from sim.compliant.phases import Course, Phases
from tests.planned import course

SCORPION = next(a for a in ADOPTEES if a.name == "scorpion")
REPEATED = {"segments": 6, "path.goal": [0.03, 0.03, 0.0], "servo_stiffness": 50.0}


@pytest.fixture(scope="module")
def walk():
    _, phases, way, _ = course(**REPEATED)
    return phases, way, phases.follow(way)


def test_a_walk_of_equal_segments_has_few_kinds_of_phases(walk):
    phases, way, _ = walk
    assert sum(map(len, phases.kinds.values())) < 0.7 * len(way.spans)


def test_phases_that_are_known_are_not_computed_again(walk, monkeypatch):
    phases, way, motion = walk
    monkeypatch.setattr("sim.compliant.phases.march", None)
    again = phases.follow(way)
    assert np.array_equal(again.pose, motion.pose)


def test_phases_that_remember_too_many_commands_are_refused(walk, monkeypatch):
    phases, way, _ = walk
    held = sum(like.looks.size for kinds in phases.kinds.values() for like, _ in kinds)
    fresh = Phases(phases.mechanics, phases.robots)
    monkeypatch.setattr("sim.compliant.phases.MOST_HELD", held - 1)
    with pytest.raises(MeasurementError, match=r"^\d+ phases follow .* so fast that"):
        fresh.follow(way)
    phases.follow(way)  # which are known


@pytest.mark.parametrize(("apart", "same"), [(0.99, True), (1.01, False)])
def test_commands_do_the_same_within_a_hundred_thousandth_of_a_radian(
    walk, monkeypatch, apart, same
):
    phases, way, _ = walk
    rows = way.commands.rows + apart * 1e-5
    other = replace(way, commands=replace(way.commands, rows=rows))
    new = []
    monkeypatch.setattr(Phases, "_computed", lambda self, _, which: new.append(which))
    with pytest.raises(TypeError):  # nothing was computed
        phases._found(other)
    assert (new == [[]]) == same


def test_phases_are_compared_with_those_of_near_commands_alone(walk, monkeypatch):
    """Those of ten minutes took an hour where each was compared with all before it."""
    phases, way, _ = walk
    asked = []
    monkeypatch.setattr(Phases, "_same", lambda *_: asked.append(1))
    monkeypatch.setattr(
        Phases, "_computed", lambda self, _, which: ((n, ()) for n in which)
    )
    rows = way.commands.rows
    drift = np.linspace(0, 0.1, len(rows))[:, None, None]  # far more than is alike
    for away in (0 * drift, drift):
        fresh, commands = (
            Phases(phases.mechanics, phases.robots),
            replace(way.commands, rows=rows + away),
        )
        fresh._found(replace(way, commands=commands))
        assert bool(asked) == (not away.any())
        asked.clear()


def test_a_composed_walk_is_the_one_that_is_walked_through(walk):
    """Within 0.01 mm and 0.1 mrad, measured, where pieces have been joined."""
    phases, way, motion = walk
    one, end = np.zeros(1), way.spans[30, 1:] * 0.001  # of some 12 s
    track, *_ = march(phases.mechanics, phases.robots, way.commands, one, end, one)
    found = motion.at(end)
    assert np.hypot(*(track.place[-1] - found.pose[0])[:2]) < 1e-5
    R = track.turned[-1]
    assert abs(np.arctan2(R[1, 0], R[0, 0]) - found.pose[0, 2]) < 1e-4
    assert track.slip.sum() == pytest.approx(found.slip[0].sum(), rel=0.01)


def test_feet_that_lift_slowly_are_remembered_for_longer(tmp_path):
    """Soft legs strain each other until they lift: 0.6 s up or down, not 0.3 s."""
    source = source_of(str(SCORPION.write(tmp_path)))
    source.path.with_suffix(".toml").write_text(draft_card(source).card)
    soft = {"servo_stiffness": 60.0, "servo_damping": 1.2, "segments": 1}
    goal = {"path.goal": [0.0083, -0.0083, 0.0]}
    _, phases, way, _ = course(robot=str(source.path), **soft, **goal)
    one, end = np.zeros(1), way.spans[-1:, 1] * 0.001
    track, *_ = march(phases.mechanics, phases.robots, way.commands, one, end, one)
    found = phases.follow(way).at(end)
    # 3e-10 m measured, and 5.4e-5 m where 2 s are remembered as at 0.3 s
    assert np.hypot(*(track.place[-1] - found.pose[0])[:2]) < 1e-6


def test_heading_matters_where_the_floor_leans():
    _, phases, way, _ = course(slope=(0.09, 0.0), servo_stiffness=50.0, segments=1)
    here = phases.follow(way)
    turned = {0: np.array([0.0, 0.0, np.pi / 2])}
    there = phases.follow(
        Course(way.commands, way.spans, way.heading + np.pi / 2, turned)
    )
    forward, sideways = here.pose[-1, :2], there.pose[-1, :2] @ [[0, -1], [1, 0]]
    assert np.hypot(*(forward - sideways)) > 1e-4  # downhill is to another side


def test_a_robot_that_tips_over_is_told_with_the_time():
    _, phases, way, _ = course()
    ahead = np.array([[0.3, 0.0, 0.05]])  # of all feet
    heavy = Phases(phases.mechanics, replace(phases.robots, body_center=ahead))
    with pytest.raises(MeasurementError, match=r"the robot tips over at \d+\.\d\d s"):
        heavy.follow(way)
