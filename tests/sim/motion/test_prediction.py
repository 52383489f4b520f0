"""Predictions along schedules, against closed forms and a general integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from models.contact.dissipation import foot_velocities
from models.contact.kinematics import Kinematics
from models.contact.sliding import Ground
from models.motion.robot_equations import equations
from models.motion.twists import IdealTwists, QuasiStaticTwists
from planner.systems.flows import Flow
from sim.experiments.identification import twist_model
from sim.motion import prediction
from sim.motion.prediction import Predictor
from sim.motion.schedule import LegState, MotionLimits, Scheduler
from sim.motion.stability import stability_margin
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

LIMITS = MotionLimits(
    swing_speed=0.5,
    swing_acceleration=5.0,
    lift_angle=0.3,
    lift_time=0.2,
    hold=0.1,
    timestep=0.001,
    groups=("1", "2"),
)
UNIT = ((1.0, 0.0), (0.0, 1.0))
FLOWS = (("1", 0, 0.3), ("1", 1, -0.1), ("2", 1, 0.25), ("2", 0, -0.4), ("12", 0, 0.1))


@pytest.fixture(scope="module")
def schedule():
    scheduler = Scheduler(LIMITS, LegState((0.05, -0.1), "12"))
    scheduler.hold(0.1)
    for stratum, group, amount in FLOWS:
        scheduler.flow(Flow(stratum, f"g{stratum}_{group + 1}", amount), UNIT[group])
    scheduler.enter("12")
    return scheduler.finish()


@pytest.fixture(scope="module")
def kinematics(hexapod):
    return Kinematics(hexapod)


@pytest.fixture(scope="module")
def ideal(hexapod):
    return IdealTwists(equations(hexapod))


@pytest.fixture(scope="module")
def quasi_static(kinematics):
    even = Ground(np.full(6, 3e-5), np.full(6, 1000.0), friction=1.0, weight=12.0)
    return QuasiStaticTwists(kinematics, even)


def is_loaded(phase):
    moving = [LIMITS.groups[i] for i in phase.moving]
    return phase.kind == "swing" and any(group in phase.stratum for group in moving)


def exponential(twist):
    """The planar displacement of a constant twist over unit time."""
    forward, left, turn = twist
    if turn == 0:
        return np.array([forward, left, 0.0])
    rotate = np.array(
        [[np.sin(turn), np.cos(turn) - 1], [1 - np.cos(turn), np.sin(turn)]]
    )
    return np.array([*(rotate @ (forward, left) / turn), turn])


def after(pose, displacement):
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    x, y, turn = displacement
    return pose + np.array([cos * x - sin * y, sin * x + cos * y, turn])


def test_constant_twists_compose_as_rigid_motions(schedule, ideal, kinematics):
    ends = np.array([phase.stop - 1 for phase in schedule.phases])
    found = Predictor(schedule, ideal, kinematics)(ends).pose
    pose, expected = np.zeros(3), []
    for phase in schedule.phases:
        if is_loaded(phase):
            twist = np.multiply(ideal.equations.twists[phase.field], phase.amount)
            pose = after(pose, exponential(twist))
        expected.append(pose)
    assert found == pytest.approx(np.array(expected), abs=1e-13)


def test_the_body_stands_while_feet_lift_and_land_and_swing_in_the_air(
    schedule, quasi_static, kinematics
):
    poses = Predictor(schedule, quasi_static, kinematics)(np.arange(schedule.stop)).pose
    for phase in schedule.phases:
        moved = np.ptp(poses[phase.start : phase.stop], axis=0).max()
        assert (moved > 1e-3) == is_loaded(phase)
        assert is_loaded(phase) or moved == 0


@pytest.mark.parametrize("model", ["ideal", "quasi_static"])
def test_pose_and_slip_agree_with_a_general_integrator(
    model, schedule, kinematics, request
):
    twists = request.getfixturevalue(model)
    robot = kinematics.robot
    end = schedule.phases[-1].stop - 1
    found = Predictor(schedule, twists, kinematics)(np.array([end]))
    state, swing = np.zeros(9), np.array(schedule.begin.swing)
    for phase in schedule.phases:
        if phase.kind != "swing":
            continue
        change = np.multiply(phase.direction, phase.amount)
        if is_loaded(phase):

            def rate(s, y, phase=phase, change=change, swing=swing):
                angles = (swing + s * change)[None]
                twist = twists(phase.stratum, angles, change[None])[0]
                cos, sin = np.cos(y[2]), np.sin(y[2])
                stance = kinematics.stance(angles[0])
                moved = stance.rates * change[robot.group_of_leg, None]
                speed = np.linalg.norm(
                    foot_velocities(stance.feet, moved, twist), axis=-1
                )
                slip = speed * robot.planted(phase.stratum)
                forward, left, turn = twist
                drift = (cos * forward - sin * left, sin * forward + cos * left, turn)
                return np.concatenate([drift, slip])

            state = solve_ivp(rate, (0, 1), state, rtol=1e-8, atol=1e-11).y[:, -1]
        swing = swing + change
    assert found.pose[0] == pytest.approx(state[:3], abs=1e-7)
    # speeds have a kink where a foot turns back: inside one panel of 0.05 rad
    assert found.slip[0] == pytest.approx(state[3:], abs=2e-5)


def test_a_swing_of_loaded_and_raised_groups_at_once_moves_the_body(ideal, kinematics):
    """On S1 the group in the air may swing along, and moves nothing."""

    def end(direction):
        scheduler = Scheduler(LIMITS, LegState((0.0, 0.0), "1"))
        scheduler.flow(Flow("1", "g1_1", 0.2), direction)
        schedule = scheduler.finish()
        return Predictor(schedule, ideal, kinematics)(np.array([schedule.stop - 1]))

    alone, together = end((1.0, 0.0)), end((1.0, -1.0))
    # the clock of the motion runs on both groups' angles, and rounds apart
    assert np.abs(alone.pose).max() > 1e-3
    assert together.pose == pytest.approx(alone.pose, abs=1e-12)
    assert together.slip == pytest.approx(alone.slip, abs=1e-6)


def test_a_start_pose_moves_the_whole_prediction(schedule, ideal, kinematics):
    rows, start = np.arange(0, schedule.stop, 50), np.array([0.3, -0.2, 1.1])
    there = Predictor(schedule, ideal, kinematics, start)(rows).pose
    here = Predictor(schedule, ideal, kinematics)(rows).pose
    expected = np.array([after(start, pose) for pose in here])
    assert there == pytest.approx(expected, abs=1e-14)


def test_slip_never_decreases_and_feet_in_the_air_have_none(
    schedule, quasi_static, kinematics
):
    found = Predictor(schedule, quasi_static, kinematics)(np.arange(schedule.stop))
    grown = np.diff(found.slip, axis=0)
    assert (grown >= -1e-12).all()
    assert np.abs(grown[~found.contact[1:]]).max() < 1e-12


def test_margin_is_that_of_the_planned_feet(schedule, ideal, kinematics, hexapod):
    rows = np.arange(0, schedule.stop, 97)
    found = Predictor(schedule, ideal, kinematics)(rows)
    swing, lift = (angles[rows] for angles in schedule.angles())
    stance = kinematics.stance(swing, lift)
    expected = stability_margin(stance.feet, found.contact, stance.center_of_mass)
    assert found.margin == pytest.approx(expected)
    assert {tuple(row) for row in found.contact} == {
        tuple(hexapod.planted(phase.stratum)) for phase in schedule.phases
    }


def test_the_ideal_slip_of_one_small_swing_grows_with_its_square(
    hexapod, ideal, kinematics
):
    """Legs meet at the pivot at angle 0 only; beyond, feet slip in proportion."""
    slips = []
    for amount in (0.1, 0.2):
        scheduler = Scheduler(LIMITS, LegState((0.0, 0.0), "12"))
        scheduler.flow(Flow("1", "g1_1", amount), UNIT[0])
        swing = scheduler.finish()
        slips.append(
            Predictor(swing, ideal, kinematics)(np.array([swing.stop - 1])).slip.sum()
        )
    # next order: a quarter of the angle's square
    assert slips[1] / slips[0] == pytest.approx(4.0, rel=0.02)


def test_predictions_share_what_is_commanded(monkeypatch):
    setup, calls = prepare(load_scenario("line")), []
    margin = prediction.stability_margin
    monkeypatch.setattr(
        prediction, "stability_margin", lambda *a: calls.append(1) or margin(*a)
    )
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.flow(Flow("1", "g1_1", 0.2), (1.0, 0.0))
    schedule, rows = scheduler.finish(), np.arange(0, 400, 50)
    given = prediction.commanded(schedule, rows, setup.kinematics)
    ideal, real = (
        prediction.Predictor(schedule, twist_model(setup, name), setup.kinematics)
        for name in ("ideal", "quasi_static")
    )
    shared = [ideal.along(given), real.along(given)]
    assert len(calls) == 1
    assert shared[0].margin is shared[1].margin
    assert (real(rows).pose == shared[1].pose).all()
    assert (real(rows).margin == shared[1].margin).all()
