"""What the engine says of a divergence, and what recordings make of sensors."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from mujoco import batch

from sim.errors import SimulationError
from sim.physics.engine import STRETCH, Engine, Record
from sim.physics.measure import (
    ContactLog,
    bridge,
    count_bounces,
    decided,
    last_touched,
)
from sim.physics.recording import Marks, Moments, Recorder, Recording
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.world.model import build, load

LAST_STATES = 100  # states before a divergence
NEAR_END = 1e-6  # of a range of forces, within which its end counts as reached


@pytest.fixture(scope="module")
def model(hexapod):
    return load(build(hexapod, Scenario(name="s", segments=1, path=line((0, 0, 0)))))


@pytest.mark.parametrize(
    ("warning", "address"),
    [("BADQVEL", "dofadr"), ("BADQACC", "dofadr"), ("BADQPOS", "qposadr")],
)
def test_a_warning_is_laid_to_the_joint_whose_coordinate_it_tells(
    model, warning, address
):
    engine = Engine(model)
    number = int(getattr(mujoco.mjtWarning, f"mjWARN_{warning}"))
    for joint in ("swing_1", "lift_3", "lift_6"):
        place = int(getattr(model.joint(joint), address)[0])
        assert engine._joint(number, place) == f" at joint {joint!r}"
    root = model.joint(0).name
    last = int(getattr(model.joint(1), address)[0]) - 1
    assert (
        engine._joint(number, 0) == engine._joint(number, last) == f" at joint {root!r}"
    )
    assert engine._joint(number, -1) == ""
    assert engine._joint(int(mujoco.mjtWarning.mjWARN_INERTIA), 7) == ""


def record(count, first=0.0):
    rows = first + np.arange(float(count))[:, None]
    return Record(rows, -rows, rows, rows)


def test_the_last_hundred_states_before_a_divergence_are_kept(model):
    engine = Engine(model)
    assert engine._last(record(30), 20).qpos[:, 0].tolist() == list(range(20))
    long = engine._last(record(300), 250)
    assert long.qpos[:, 0].tolist() == list(range(250 - LAST_STATES, 250))
    assert (long.qvel == -long.qpos).all()
    engine._recent = engine._last(record(80), 80)
    joined = engine._last(record(50, first=80.0), 30)
    assert joined.qpos[:, 0].tolist() == list(range(110 - LAST_STATES, 110))
    exact = engine._last(record(LAST_STATES, first=500.0), LAST_STATES)
    assert exact.qpos[0, 0] == 500.0
    assert len(exact.qpos) == 100


@pytest.mark.parametrize(("speed", "said"), [(99.0, ""), (101.0, " at joint 'lift_2'")])
def test_a_joint_runs_away_beyond_a_hundred_radians_a_second(model, speed, said):
    qvel = np.zeros((3, model.nv))
    qvel[1, model.joint("lift_2").dofadr] = -speed
    assert Engine(model)._runaway(qvel) == said


def test_a_divergence_is_laid_to_the_joint_of_the_warning_and_to_its_last_step(model):
    """A warning tells its kind, then the place of a coordinate and a count."""
    engine = Engine(model)
    engine.steps, place = 400, int(model.joint("lift_3").qposadr[0])
    warned = engine._batch.warning.copy()
    warning = int(mujoco.mjtWarning.mjWARN_BADQPOS)
    warned[0, warning] = place, 1
    engine._batch = SimpleNamespace(warning=warned)
    qpos = np.cumsum([0.0, 0.1, 0.1, 0.0, 0.0])[:, None]  # two steps that moved
    seen = Record(qpos, np.zeros((5, model.nv)), qpos, qpos)
    with pytest.raises(SimulationError) as caught:
        engine._check_warnings(seen)
    found = caught.value
    assert found.what == "simulation diverged at joint 'lift_3', warning BADQPOS"
    assert found.where == f"t = {(400 + 2) * model.opt.timestep:.4f} s"
    assert engine.steps == 403  # the third is the last that was carried out


def test_what_the_engine_refuses_is_told_with_the_time(model):
    engine = Engine(model)
    engine.steps = 1000

    def rollout(*_, **__):
        raise batch.SimulationError([0], "no such thing")

    engine._batch = SimpleNamespace(rollout=rollout)
    with pytest.raises(SimulationError) as caught:
        engine._play(np.zeros((3, model.nu)))
    assert "no such thing" in caught.value.what
    assert caught.value.where == f"t = {1000 * model.opt.timestep:.4f} s"


@pytest.mark.physics
def test_commands_are_handed_over_in_longer_pieces_up_to_a_stretch(model, monkeypatch):
    """Four times as many at most, and as many as take 0.3 s."""
    engine, clock, calls = Engine(model), [0.0], []
    out = {name: np.zeros((1, 1, 1)) for name in Record._fields}

    def rollout(steps, **rest):
        calls.append(steps)
        clock[0] += 1e-4 * steps  # [s]
        return out

    engine._batch = SimpleNamespace(rollout=rollout, warning=engine._warnings)
    monkeypatch.setattr("sim.physics.engine.time.perf_counter", lambda: clock[0])
    for _ in range(5):
        engine._play(np.zeros((engine._piece, model.nu)))
    assert calls == pytest.approx([50, 200, 800, 3000, 3000], abs=1)  # of 0.1 ms each
    assert engine.steps == sum(calls)
    assert STRETCH == 4000


@pytest.mark.physics
def test_a_simulation_goes_on_from_an_earlier_moment(model):
    engine, ctrl = Engine(model), np.full((20, model.nu), 0.1)
    engine.advance(ctrl)
    moment = engine.moment
    first = engine.advance(ctrl).qpos
    engine.rewind(moment)
    assert engine.steps == 20
    assert np.array_equal(engine.advance(ctrl).qpos, first)


def flags(text):
    return np.array([[c == "#"] for c in text])


@pytest.mark.parametrize(
    ("loaded", "contact", "bounces"),
    [
        ("##.##", "#####", 1), ("##..#", "#####", 1), ("##...#", "##...#", 0),
        ("#.#.#", "#####", 2), (".#.", ".#.", 0), ("..##", "..##", 0),
        ("##..", "##..", 0),
    ],
)  # fmt: skip
def test_interruptions_shorter_than_three_steps_are_bridged(loaded, contact, bounces):
    found = bridge(flags(loaded), 3)
    assert "".join(np.where(found[:, 0], "#", ".")) == contact
    assert count_bounces(flags(loaded), found).tolist() == [bounces]


def test_an_interruption_may_begin_before_the_first_step():
    found = bridge(flags("..##"), 3, before=flags("#"))
    assert found.all()
    assert not bridge(flags("...#"), 3, before=flags("#"))[:3].any()
    assert not bridge(flags("..#"), 3, before=flags("."))[:2].any()


@pytest.mark.parametrize(
    ("loaded", "count"),
    [("####", 4), ("##..", 2), ("#...", 4), ("....", 4), ("###.", 3), ("..#.", 3)],
)
def test_steps_are_decided_once_nothing_later_can_make_them_a_bounce(loaded, count):
    assert decided(flags(loaded), 3) == count


def test_a_point_is_kept_from_the_last_touch_on():
    point = np.arange(8.0).reshape(4, 1, 2)
    found = last_touched(point, flags(".#.#"))
    assert found[:, 0, 0].tolist() == [0, 2, 2, 6]
    before = np.full((1, 1, 2), 9.0)
    assert last_touched(point, flags("..#."), before)[:, 0, 0].tolist() == [9, 9, 4, 4]


def test_contacts_between_two_steps_are_those_in_force_and_every_change():
    log = ContactLog(np.array([0, 5, 9]), flags("#.#"))
    assert log.between(0, 4)[:, 0].tolist() == [True]
    assert log.between(4, 5)[:, 0].tolist() == [True, False]
    assert log.between(5, 8)[:, 0].tolist() == [False]
    assert log.between(6, 9)[:, 0].tolist() == [False, True]


def test_an_actuator_is_at_its_limit_within_a_millionth_of_its_range():
    model = SimpleNamespace(
        actuator_forcerange=np.array([[-2.0, 2.0], [-1.0, 3.0], [-1.0, 1.0]]),
        actuator_forcelimited=np.array([1, 1, 0]),
    )
    recorder = SimpleNamespace(engine=SimpleNamespace(model=model))
    near = NEAR_END * 4
    force = np.array([
        [2.0, 3.0, 5.0], [-2.0, -1.0, 5.0], [2 - 0.9 * near, 3 - 1.1 * near, 5.0],
        [-2 + 0.9 * near, -1 + 1.1 * near, 5.0], [0.0, 1.0, 5.0], [-1.9, 2.9, 5.0],
    ])  # fmt: skip
    assert Recorder._at_limit(recorder, force).tolist() == [4, 2, 0]


def test_moments_are_those_after_steps_and_slip_is_found_by_its_step():
    step = np.array([1, 4, 9])
    columns = {name: np.arange(3.0) for name in Moments._fields} | {"step": step}
    columns["slip"] = np.array([[0.0, 0.1], [0.2, 0.3], [0.4, 0.5]])
    nothing = np.zeros(0)
    marks = Marks(nothing, nothing)
    log = ContactLog(nothing, nothing)
    made = Recording(
        0.001, 9, Moments(**columns), marks, log, np.array([1, 4]), nothing, 0.0, 0, 0
    )
    assert made.during.tolist() == [0, 3, 8]
    assert made.bounces == 5
    assert made.slip_after(4).tolist() == [0.2, 0.3]
    assert Moments(**columns).at(np.array([2])).step.tolist() == [9]
