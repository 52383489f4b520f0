"""The engine against a bare loop, and what it does when physics goes wrong."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

import models
from sim.errors import SimulationError
from sim.physics.engine import Engine
from sim.world.model import build, load

STRETCH = 4000  # steps of one record at most: a tenth of a second of work as a rule


@pytest.fixture(scope="module")
def model(hexapod):
    from sim.scenarios.body_path import line
    from sim.scenarios.scenario import Scenario

    return load(
        build(hexapod, Scenario(name="stand", segments=1, path=line((0, 0, 0))))
    )


@pytest.fixture
def wobble(model):
    time = np.arange(STRETCH + 500) * model.opt.timestep
    return 0.2 * np.sin(3 * time)[:, None] * np.ones(model.nu)


def bare_loop(model, ctrl):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    qpos = np.empty((len(ctrl), model.nq))
    for k, row in enumerate(ctrl):
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
        qpos[k] = data.qpos
    return qpos


@pytest.mark.physics
def test_stretches_are_bit_for_bit_a_bare_loop_over_mj_step(model, wobble):
    engine = Engine(model)
    cuts = np.split(wobble, [700, STRETCH])
    records = [engine.advance(part) for part in cuts]
    assert np.array_equal(
        np.concatenate([r.qpos for r in records]), bare_loop(model, wobble)
    )
    assert engine.steps == len(wobble)
    assert np.array_equal(engine.state.qpos, records[-1].qpos[-1])


@pytest.mark.physics
def test_an_engine_of_a_slow_model_gives_python_its_turn(model, wobble, monkeypatch):
    """Between two of its calls Ctrl-C is answered; the states do not depend on them."""
    whole, calls = Engine(model).advance(wobble[:300]), []
    monkeypatch.setattr("sim.physics.engine.BUSY_TIME", 0.0)  # as if very slow
    engine = Engine(model)
    rollout = engine._batch.rollout

    def counted(steps, **rest):
        calls.append(steps)
        return rollout(steps, **rest)

    engine._batch = SimpleNamespace(rollout=counted, warning=engine._batch.warning)
    pieces = engine.advance(wobble[:300])
    assert calls == [50] + 250 * [1]
    assert np.array_equal(pieces.qpos, whole.qpos)
    assert np.array_equal(pieces.sensordata, whole.sensordata)


@pytest.mark.physics
def test_two_runs_are_identical(model, wobble):
    first, second = (Engine(model).advance(wobble[:500]) for _ in range(2))
    assert np.array_equal(first.qpos, second.qpos)
    assert np.array_equal(first.sensordata, second.sensordata)


@pytest.mark.physics
def test_a_diverging_simulation_stops_with_time_and_warning(hexapod, scenario, capfd):
    wild = scenario(timestep=0.01, servo_stiffness=1e6, servo_damping=0.0)
    engine = Engine(load(build(hexapod, wild)))
    with pytest.raises(
        SimulationError, match=r"diverged.*BADQ.*: t = 0\.\d+ s; try a small"
    ):
        engine.advance(np.full((400, 12), 0.4))
    assert capfd.readouterr().err == ""


@pytest.mark.physics
def test_after_a_divergence_the_steps_are_those_that_were_made(hexapod, scenario):
    """The engine stops in the step that goes bad, which a bare loop finds alike."""
    wild = scenario(timestep=0.01, servo_stiffness=1e6, servo_damping=0.0)
    model = load(build(hexapod, wild))
    engine, data = Engine(model), mujoco.MjData(model)
    still, pushed = (np.full((n, 12), angle) for n, angle in ((3, 0.0), (400, 0.4)))
    engine.advance(still)
    with pytest.raises(SimulationError, match="diverged") as stop:
        engine.advance(pushed)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    made = 0
    for row in (*still, *pushed):
        data.ctrl[:] = row
        mujoco.mj_step(model, data)
        made += 1
        if data.warning.number.any():
            break
    assert engine.steps == made > 3
    assert f"t = {(made - 1) * 0.01:.4f} s" in str(stop.value)


def test_a_divergence_is_laid_to_the_joint_that_was_too_fast_first(model):
    engine, qvel = Engine(model), np.zeros((4, model.nv))
    assert engine._runaway(qvel) == ""
    qvel[1:, 0] = 1e12  # of the root, which is thrown
    qvel[2, model.joint("swing_5").dofadr] = -150.0
    qvel[2, model.joint("lift_2").dofadr] = 120.0
    qvel[3, model.joint("lift_1").dofadr] = 1e9
    assert engine._runaway(qvel) == " at joint 'swing_5'"


def test_what_turns_fast_on_purpose_has_not_run_away():
    spec = models.load("hexapod").read()
    for number, hub in enumerate(("fan", "wheel")):
        body = spec.body("torso").add_body(name=hub)
        body.add_joint(name=hub)
        body.add_geom(size=[0.01, 0, 0], mass=0.001)
        fan = spec.add_actuator(name=hub, target=hub, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        fan.set_to_motor() if number else fan.set_to_velocity(kv=1e-4)
    model = spec.compile()
    engine, qvel = Engine(model), np.zeros((3, model.nv))
    for hub in ("fan", "wheel"):
        qvel[:, model.joint(hub).dofadr] = 150.0
    assert engine._runaway(qvel) == ""
    qvel[2, model.joint("lift_3").dofadr] = 110.0
    assert engine._runaway(qvel) == " at joint 'lift_3'"


def test_a_command_that_is_not_finite_is_stopped_before_the_engine(model):
    ctrl = np.zeros((10, model.nu))
    ctrl[4, 3] = np.nan
    name = model.actuator(3).name
    with pytest.raises(
        SimulationError, match=rf"command of '{name}' is nan: t = 0.0040 s"
    ):
        Engine(model).advance(ctrl)
