"""The law of servos against a fine integration of its equation, and loads of joints."""

from dataclasses import replace
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models import load
from models.description import actuators_driving
from sim.fitting import servo_law
from sim.fitting.fitting import servos
from sim.fitting.servo_law import Commanded, known_servos, on_floor, on_stand
from sim.logs.log import Log
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

GOING = 1.0  # [s] in which the robot goes from its start to the log's first row
LAW_STEP = 0.004  # [s] of the law, which is solved exactly in between
SETTLING = 0.5  # [s] that it then stands
RUBBED = 1e-3  # [N m s/rad]; damping of it

STEP, ROWS = 0.002, 400


def law(angle, load=0.0, inertia=2e-3):
    angle = np.reshape(angle, (ROWS, -1)).copy()
    angle[1:] = (angle[1:] + angle[:-1]) / 2  # on the average of a step
    given = np.full(angle.shape[1], inertia)
    loads = np.broadcast_to(np.reshape(load, (-1, 1)), angle.shape)
    return Commanded(STEP, angle, loads, given, given / 4)


def servo(stiffness=9.0, damping=0.1, **faults):
    made = servos(np.array([stiffness]), np.array([damping]))
    for name, value in faults.items():
        made[:, ["band", "backlash", "zero", "delay"].index(name) + 2] = value
    return made


def integrated(angle, load, k, d, inertia, band=0.0, zero=0.0):
    """I a + d v = k (e - clip(e, -w/2, w/2)) - load, begun at rest, (ROWS,)."""
    times = STEP * np.arange(ROWS)
    loads = np.broadcast_to(load, times.shape)

    def rate(t, state):
        e = np.interp(t, times, angle) + zero - state[0]
        spring = k * (e - np.clip(e, -band / 2, band / 2))
        push = loads[min(int(t / STEP) + 1, ROWS - 1)]
        return state[1], (spring - push - d * state[1]) / inertia

    rest = angle[0] + zero - loads[0] / k - np.sign(loads[0]) * band / 2
    found = solve_ivp(
        rate, (0, times[-1]), (rest, 0.0), t_eval=times, max_step=STEP / 2, rtol=1e-7
    )
    return found.y[0]


TIMES = STEP * np.arange(ROWS)
SWINGING = 0.3 * np.sin(9 * TIMES) * np.minimum(TIMES / 0.2, 1)


@pytest.mark.parametrize("load", [0.4, -0.4, 0.4 * np.cos(7 * TIMES)])
@pytest.mark.parametrize(("band", "zero"), [(0.0, 0.0), (0.05, 0.0), (0.02, -0.03)])
def test_angles_are_those_of_the_law_integrated_finely(load, band, zero):
    found = law(SWINGING, load).answers(servo(band=band, zero=zero)[None], TIMES[1:-1])
    best = integrated(SWINGING, load, 9.0, 0.1, 2e-3, band, zero)[1:-1]
    off = np.abs(found[0, :, 0] - best)
    # 4e-5 rad measured of 0.3, and 2e-4 where the load turns: a joint leaves the
    # band within a step
    assert off.max() < (3e-4 if band and np.ndim(load) else 8e-5)


def test_variants_and_joints_are_answered_side_by_side():
    angle = np.stack([SWINGING, 0.5 * SWINGING[::-1]], axis=1)
    both = Commanded(
        STEP, angle, np.stack([0.1 + 0 * TIMES, -0.2 + 0 * TIMES], axis=1),
        np.array([2e-3, 5e-3]), np.array([1e-3, 2e-3]),
    )  # fmt: skip
    ones = [servo(9.0, 0.1, backlash=0.01), servo(20.0, 0.2, band=0.03, delay=0.01)]
    variants = np.stack([np.concatenate(ones), np.concatenate(ones[::-1])])
    found = both.answers(variants, TIMES[:-1])
    for v, order in enumerate((ones, ones[::-1])):
        for p, own in enumerate(order):
            alone = Commanded(
                STEP, angle[:, [p]], both.load[:, [p]], both.inertia[[p]], both.leg[[p]]
            )
            assert found[v, :, p] == pytest.approx(
                alone.answers(own[None], TIMES[:-1])[0, :, 0], abs=1e-12
            )


def test_a_delay_shifts_what_is_answered_and_holds_the_ends():
    log, rows = law(SWINGING), TIMES[50:-1] + 0.3 * STEP
    late = log.answers(servo(delay=0.06)[None], rows)
    assert late == pytest.approx(log.answers(servo()[None], rows - 0.06), abs=1e-12)
    before = log.answers(servo(delay=0.5)[None], np.array([0.0, 0.1]))
    assert before[0, :, 0] == pytest.approx(
        [log.answers(servo()[None], TIMES[:1])[0, 0, 0]] * 2
    )
    after = log.answers(servo()[None], np.array([TIMES[-1], 9.0]))[0, :, 0]
    assert (
        after[0]
        == after[1]
        == pytest.approx(
            log.answers(servo()[None], TIMES[-2:-1] + 0.999 * STEP)[0, 0, 0]
        )
    )


def test_between_steps_angles_lie_on_a_line():
    log = law(SWINGING)
    ends = log.answers(servo()[None], TIMES[[100, 101]])[0, :, 0]
    (found,) = log.answers(servo()[None], np.array([TIMES[100] + 0.25 * STEP]))[0, :, 0]
    assert found == pytest.approx(ends @ [0.75, 0.25])


@pytest.mark.parametrize("side", [1, -1])
def test_a_leg_falls_through_its_backlash_as_its_load_turns(side):
    """It is pulled by the load, and braked by what rubs in the gears."""
    load, slack = 0.02, 0.04
    pulls = side * np.where(np.arange(ROWS) < 100, load, -load)
    log = law(np.zeros(ROWS), pulls)
    log = replace(log, leg=np.full(1, 4e-4))
    found = log.answers(servo(1e5, 1.0, backlash=slack)[None], TIMES[:-1])[0, :, 0]
    assert found[:100] == pytest.approx(np.full(100, -side * slack / 2), abs=1e-5)
    assert found[-1] == pytest.approx(side * slack / 2, abs=1e-5)
    slowed = 4e-4 / RUBBED  # [s]
    time = STEP * np.arange(1, ROWS - 100)
    fallen = load / RUBBED * (time - slowed * (1 - np.exp(-time / slowed)))
    under_way = fallen < 0.9 * slack
    moved = side * found[100 : 99 + ROWS - 100] + slack / 2
    assert under_way.sum() > 5
    assert moved[under_way] == pytest.approx(fallen[under_way], abs=0.1 * slack)


@pytest.fixture(scope="module")
def standing():
    robot = load("hexapod")
    return prepare(load_scenario("line"), robot), robot


def logged(robot, joints, angle, lasting=0.5, step=0.02):
    """A log of joints at angles off their standing ones, given as rows or numbers."""
    time = np.arange(0, lasting + step / 2, step)
    rest = [robot.standing_angle(joint) for joint in joints]
    return Log(time, joints, np.broadcast_to(angle, (len(time), len(joints))) + rest)


def test_loads_on_a_stand_are_the_slopes_of_the_potential_energy(standing):
    setup, robot = standing
    joints, model = robot.card.joints[:4], setup.as_planned.model
    time = np.linspace(0, 1, 26)[:, None]
    log = logged(robot, joints, 0.3 * np.sin(4 * time + np.arange(4)))
    found = on_stand(setup, log)
    data = mujoco.MjData(model)

    def energy(angles):
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        for joint, angle in zip(joints, angles, strict=True):
            data.qpos[model.joint(joint).qposadr[0]] = angle
        mujoco.mj_kinematics(model, data)
        return -float(model.body_mass @ (data.xipos @ model.opt.gravity))

    assert found.step == LAW_STEP
    assert len(found.angle) == int(log.duration / LAW_STEP) + 1
    for row in (0, 40, 80, len(found.angle) - 1):
        before, angles = log.at(np.array([row - 1, row]) * LAW_STEP)
        assert found.angle[row] == pytest.approx((before + angles) / 2)
        for k, slope in enumerate(found.load[row]):
            up, down = (angles + s * 1e-5 * np.eye(4)[k] for s in (1, -1))
            best = (energy(up) - energy(down)) / 2e-5
            assert slope == pytest.approx(best, rel=0.02, abs=1e-3)


def test_inertia_is_of_rotor_and_leg_and_the_leg_alone_is_loose(standing):
    setup, robot = standing
    joints, model = robot.card.joints[:2], setup.as_planned.model
    found = on_stand(setup, logged(robot, joints, 0.0))
    rotors = [float(model.joint(joint).armature[0]) for joint in joints]
    assert found.inertia - found.leg == pytest.approx(rotors)
    assert (found.leg > 0).all()


def test_servos_are_known_as_the_scenario_has_them():
    robot = load("hexapod")
    changes = {"servo_stiffness": 33.0, "servo_damping": 0.7}
    setup = prepare(load_scenario("line", changes), robot)
    log = logged(robot, robot.card.joints[3:5], 0.0)
    stiffness, damping = known_servos(setup, log)
    assert stiffness == pytest.approx([33.0, 33.0])
    assert damping == pytest.approx([0.7, 0.7], abs=0.1)
    made = servos(stiffness, damping)
    assert np.exp(made[:, 0]) == pytest.approx(stiffness)
    assert np.exp(made[:, 1]) == pytest.approx(damping)
    assert (made[:, 2:] == 0).all()
    assert made.shape == (2, 6)
    bare = prepare(load_scenario("line", {"servo_damping": 0.0}), robot)
    stiffness, damping = known_servos(bare, log)
    assert damping == pytest.approx(1e-3 * stiffness)  # of nothing is no logarithm


@pytest.mark.physics
def test_joints_of_a_standing_robot_bear_its_weight(standing):
    """By virtual work: all lift joints together raise the body."""
    setup, robot = standing
    log = logged(robot, robot.card.joints, 0.0)
    model = setup.as_planned.model
    known = servos(*known_servos(setup, log))
    found = on_floor(setup, model, log, known)
    assert found.step == LAW_STEP
    assert found.angle.shape == found.load.shape
    assert len(found.angle) == pytest.approx(log.duration / LAW_STEP, abs=2)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    torques = found.load[-1]
    lifted = 0.0
    for leg in robot.leg_cards:
        joint = model.joint(leg.lift)
        tip = max(
            (g for g in range(model.ngeom) if model.geom_bodyid[g] == joint.bodyid[0]),
            key=lambda g: np.linalg.norm(data.geom_xpos[g] - data.xanchor[joint.id]),
        )
        arm = data.geom_xpos[tip] - data.xanchor[joint.id]
        lever = np.cross(data.xaxis[joint.id], arm)[2]
        lifted -= torques[robot.card.joints.index(leg.lift)] / lever
    weight = 9.81 * model.body_mass.sum()
    assert lifted == pytest.approx(weight, rel=0.35)
    assert np.ptp(found.load[20:], axis=0).max() < 0.1 * np.abs(torques).max()


@pytest.mark.physics
def test_a_robot_goes_to_its_first_row_and_stands_before_the_log_begins(standing):
    """It asks servos for what their zeros will make the angles of the log."""
    setup, robot = standing
    log = logged(robot, robot.card.joints, 0.05)
    model = setup.as_planned.model
    known = servos(*known_servos(setup, log))
    known[:, 4] = 0.01
    asked = []

    class Engine:
        def __init__(self, model):
            self.real = type(self).original(model)

        def advance(self, rows):
            """Keep what is asked."""
            asked.append(rows.copy())
            return self.real.advance(rows)

    Engine.original = servo_law.Engine
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(servo_law, "Engine", Engine)
        on_floor(setup, model, log, known)
    rows, dt = np.concatenate(asked), model.opt.timestep
    start = model.key("start").ctrl
    there = log.commanded[0] + 0.01
    actuators = actuators_driving(setup.model, log.joints)
    before = round((GOING + SETTLING) / dt)
    assert len(rows) == before + round(log.duration / dt) + 1
    assert rows[0] == pytest.approx(start)
    gone = rows[:, actuators] - start[actuators]
    half = round(GOING / 2 / dt)
    assert gone[half] == pytest.approx((there - start[actuators]) / 2, rel=1e-6)
    for row in (round(GOING / dt), before, len(rows) - 1):
        assert rows[row, actuators] == pytest.approx(there, abs=1e-9)
    assert np.abs(np.diff(gone, axis=0)).max() < 1.6 * np.abs(gone).max() * dt / GOING


def test_a_servo_bears_nothing_within_its_dead_band_and_beyond_it_the_rest(monkeypatch):
    """Of robots that stand still whatever they are told; 1 rad/s is not fast enough."""
    setup = prepare(load_scenario("line", {"dead_band": 0.02, "servo_stiffness": 50.0}))
    model, robot = setup.model, setup.robot
    rest = model.key("start").qpos

    def advance(ctrl):
        return SimpleNamespace(qpos=np.tile(rest, (len(ctrl), 1)))

    monkeypatch.setattr(servo_law, "Engine", lambda _: SimpleNamespace(advance=advance))
    joints = robot.card.joints[:3]
    log = logged(robot, joints, np.array([0.006, -0.03, 0.03]), lasting=0.1)
    still = servos(np.full(3, 50.0), np.full(3, 1.0))
    load = on_floor(setup, model, log, still).load
    assert load[-1] == pytest.approx([0.0, -50 * 0.02, 50 * 0.02], abs=1e-9)


@pytest.mark.parametrize(("rows", "held"), [(60, True), (59.84, True), (62.5, False)])
def test_rows_that_come_as_servos_take_commands_are_held(rows, held):
    """Taken for a slope, steps would come half a row late, and be called a delay."""
    setup = SimpleNamespace(servo=SimpleNamespace(rate=59.84))
    time = np.arange(6) / rows
    log = Log(time, ("a",), np.arange(6.0)[:, None])
    asked = servo_law._asked(setup, log, np.array([0.0, 0.75, 1.5, 2.25, 3.0]) / rows)
    means = [0, 0, 2 / 3, 4 / 3, 2] if held else [0, 0.375, 1.125, 1.875, 2.625]
    assert asked[:, 0] == pytest.approx(means)
    asked = servo_law._asked(setup, log, np.array([5.0, 9.0]) / rows)
    assert asked[-1, 0] == pytest.approx(5)  # beyond the last row
