"""Twists and loads of six sliding feet, against theory and against the engine."""

import shutil
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models.contact import sliding
from models.contact.dissipation import (
    ellipses,
    foot_jacobians,
    foot_velocities,
    least_dissipation_twist,
)
from models.contact.kinematics import Kinematics, Stance
from models.contact.sliding import Ground, sliding_twist
from models.description import FOLDER
from models.library import load as load_robot
from planner.systems.flows import Flow
from sim.motion.schedule import LegState, MotionLimits, Scheduler
from sim.physics.engine import Engine
from sim.physics.measure import Sensors
from sim.world.model import build, load
from sim.world.servos import Channels

STRETCH = 4000  # steps of one record at most: a tenth of a second of work as a rule

UNIT = ((1.0, 0.0), (0.0, 1.0))
SWEEP = ((0, 0.2), (0, -0.4))  # group, amount: the second runs without a start-up


@pytest.fixture(scope="module", params=["hexapod", "hexapod-parallel"])
def robot(request):
    return load_robot(request.param)


@pytest.fixture
def world(robot, scenario):
    return load(build(robot, scenario()))


def standing(robot, angles, speed=1.0):
    """Stance on all feet and the rates when the first group swings."""
    swing = np.zeros((len(angles), 2))
    swing[:, 0] = angles
    stance = Kinematics(robot).stance(swing)
    only_first = np.array([speed, 0.0])[robot.group_of_leg]
    return stance, stance.rates * only_first[:, None]


def swing_on_all_feet(robot, model, speed):
    """Twist per radian and loads in the middle of a sweep of the first group."""
    timing = robot.card.lift_time, 0.3, model.opt.timestep
    limits = MotionLimits(speed, 5.0, 0.3, *timing, robot.groups)
    scheduler = Scheduler(limits, LegState((0.0, 0.0), "12"))
    scheduler.hold(0.3)
    for group, amount in SWEEP:
        scheduler.flow(Flow("12", f"g12_{group + 1}", amount), UNIT[group])
    schedule = scheduler.finish()
    swing, lift = schedule.angles()
    ctrl = Channels(robot, model).ctrl(robot.targets(swing, lift))
    engine, sensors = Engine(model), Sensors(model, robot)
    stretches = [ctrl[i : i + STRETCH] for i in range(0, len(ctrl), STRETCH)]
    records = [engine.advance(stretch) for stretch in stretches]
    force = np.concatenate([sensors.read(r.sensordata).force for r in records])
    qvel = np.concatenate([r.qvel for r in records])
    qpos = np.concatenate([r.qpos for r in records])
    last = schedule.phases[-1]
    middle = slice(
        last.start + last.steps // 2 - 100, last.start + last.steps // 2 + 100
    )
    yaw = 2 * np.arctan2(qpos[middle, 6], qpos[middle, 3])
    vx, vy = qvel[middle, 0], qvel[middle, 1]
    cos, sin = np.cos(yaw), np.sin(yaw)
    twist = np.stack([cos * vx + sin * vy, -sin * vx + cos * vy, qvel[middle, 5]])
    return -twist.mean(axis=1) / speed, (force[middle] / sensors.weight).mean(axis=0)


def test_friction_balances_and_loads_carry_the_weight(robot, world):
    stance, rates = standing(robot, np.linspace(-0.3, 0.3, 7))
    ground = Ground.of(robot, world)
    twist, loads = sliding_twist(stance, rates, ground, speed=0.5)
    w = foot_velocities(stance.feet, rates, twist)
    direction = w / np.sqrt((w**2).sum(-1, keepdims=True) + (1e-4 * 0.105) ** 2)
    force = np.einsum("nf,nfij,nfi->nj", loads, foot_jacobians(stance.feet), direction)
    # balanced to 1e-9 of the weight, up to where friction is smoothed: 1e-4 of a rate
    assert force == pytest.approx(np.zeros((7, 3)), abs=1e-4)
    assert loads.sum(axis=1) == pytest.approx(np.ones(7))
    moments = np.einsum("nf,nfi->ni", loads, stance.feet)
    assert moments == pytest.approx(stance.center_of_mass, abs=1e-9)


@pytest.mark.parametrize("high", [-0.09e-3, -2e-6, 2e-6, 0.05e-3, 0.09e-3])
def test_feet_that_start_near_the_floor_are_on_it(high, scenario, tmp_path):
    """Where a file puts the body less than a tenth of a millimetre off."""
    for name in ("scene.xml", "hexapod.toml"):
        shutil.copy(FOLDER / name, tmp_path)
    text = (FOLDER / "hexapod.xml").read_text()
    off = text.replace('qpos="0 0 0.06 ', f'qpos="0 0 {0.06 + high:.9f} ')
    assert off != text
    (tmp_path / "hexapod.xml").write_text(off)
    near, exact = load_robot(str(tmp_path / "hexapod.xml")), load_robot("hexapod")
    found, known = (Ground.of(r, load(build(r, scenario()))) for r in (near, exact))
    assert found.contact == pytest.approx(known.contact, rel=1e-6)
    assert found.push == pytest.approx(known.push, rel=1e-6)


def test_rigid_legs_on_soft_ground_slide_with_least_dissipation(robot, world):
    """Without servo compliance friction does not change loads: two solvers agree."""
    stance, rates = standing(robot, np.linspace(-0.3, 0.3, 5))
    soft = np.linspace(1e-5, 3e-5, 6)
    ground = replace(Ground.of(robot, world), contact=soft, servo=np.full(6, np.inf))
    twist, loads = sliding_twist(stance, rates, ground)
    known = least_dissipation_twist(stance.feet, rates, loads)
    # friction is smoothed below 1e-4 of the fastest rate; near a tie that shows tenfold
    assert twist == pytest.approx(known, abs=2e-3)


@pytest.mark.parametrize("uneven", ["feet", "directions"])
def test_uneven_friction_on_rigid_legs_slides_with_least_dissipation(uneven):
    """Less friction of a foot drags as less of a load, and ellipses as they are."""
    stance, rates = standing(load_robot("hexapod"), [-0.2, 0.1])
    soft, rigid = np.linspace(1e-5, 3e-5, 6), np.full(6, np.inf)
    frictions, grip = (), None
    if uneven == "feet":
        frictions = (0.2, 0.8, 0.4, 0.8, 0.1, 0.6)
    else:
        lengthwise = stance.feet / np.linalg.norm(stance.feet, axis=-1)[..., None]
        grip = ellipses(lengthwise, (0.5, 1.0))
    ground = Ground(soft, rigid, 0.8, 20.0, frictions=frictions)
    twist, loads = sliding_twist(stance, rates, ground, grip=grip)
    borne = loads * (np.array(frictions or (0.8,) * 6) / 0.8)
    known = least_dissipation_twist(stance.feet, rates, borne, grip)
    assert twist == pytest.approx(known, abs=2e-3)
    even = least_dissipation_twist(stance.feet, rates, loads)
    assert np.abs(known - even).max() > 0.01


def test_how_a_foot_without_friction_slides_does_not_matter(hexapod):
    stance, rates = standing(hexapod, [0.1])
    frictions = (0.0, 0.8, 0.8, 0.8, 0.8, 0.8)
    given = {"contact": np.full(6, 2e-5), "servo": np.full(6, 40.0), "push": 1e-3}
    ground = Ground(friction=0.8, weight=20.0, frictions=frictions, **given)
    found = sliding_twist(stance, rates, ground, speed=0.5)
    rates = rates.copy()
    rates[:, 0] *= -0.5
    for one, other in zip(
        found, sliding_twist(stance, rates, ground, 0.5), strict=True
    ):
        assert one == pytest.approx(other, abs=1e-6)
    assert found[1].sum() == pytest.approx(1)


def test_the_ground_is_as_rough_as_its_roughest_foot(hexapod, scenario):
    rubbing = (0.5, 0.3, 0.7, 0.4, 0.6, 0.35)
    ground = Ground.of(hexapod, load(build(hexapod, scenario(foot_friction=rubbing))))
    assert ground.frictions == pytest.approx(rubbing)
    assert ground.friction == pytest.approx(0.7)
    assert ground.friction * ground.shares == pytest.approx(rubbing)


def test_small_steps_of_the_smoothing_lead_where_leaps_do(robot, world, monkeypatch):
    stance, rates = standing(robot, np.linspace(-0.3, 0.3, 3))
    ground = Ground.of(robot, world)
    known, loads = sliding_twist(stance, rates, ground)
    monkeypatch.setattr(sliding, "_BALANCED", -1.0)  # so that no leap is trusted
    twist, others = sliding_twist(stance, rates, ground)
    assert twist == pytest.approx(known, abs=1e-8)
    assert others == pytest.approx(loads, abs=1e-8)


def test_twist_turns_round_with_the_swing(robot, world):
    stance, rates = standing(robot, [0.1])
    ground = Ground.of(robot, world)
    there, loads = sliding_twist(stance, rates, ground, speed=0.5)
    # mirrored fore and aft, the legs at -0.1 swing back as those at 0.1 swing forth
    mirrored, backward = standing(robot, [-0.1], speed=-1.0)
    back, others = sliding_twist(mirrored, backward, ground, speed=0.5)
    assert back == pytest.approx(there * [[-1, 1, -1]], abs=1e-9)
    assert others == pytest.approx(loads[:, [4, 5, 2, 3, 0, 1]], abs=1e-9)


def test_twist_has_the_unit_of_the_rates(robot, world):
    """One group swings, so that the slowest rate is zero."""
    ground = Ground.of(robot, world)
    stance, rates = standing(robot, [0.1])
    twist, loads = sliding_twist(stance, rates, ground)
    faster, same = sliding_twist(stance, 1000 * rates, ground)
    assert faster == pytest.approx(1000 * twist, rel=1e-9, abs=1e-9)
    assert same == pytest.approx(loads, abs=1e-9)


def test_a_foot_that_would_pull_hangs_free_and_the_others_bear_the_weight():
    feet = np.array([[[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]])
    stance = Stance(
        feet=feet,
        rates=np.zeros((1, 4, 2)),
        gives=np.zeros((1, 4, 3)),
        height=np.zeros((1, 4)),
        center_of_mass=np.array([[0.7, 0.7]]),
    )
    ground = Ground(np.full(4, 1e-5), np.full(4, 100.0), friction=1.0, weight=10.0)
    _, loads = sliding_twist(stance, stance.rates, ground)
    assert loads == pytest.approx(np.array([[0.7, 0.15, 0.15, 0.0]]))


def test_the_friction_under_some_feet_is_that_of_the_roughest_of_them():
    springs, stiffness = np.arange(1.0, 5.0), np.arange(5.0, 9.0)
    own = (0.3, 0.9, 0.5, 1.2)
    ground = Ground(springs, stiffness, friction=1.2, weight=10.0, frictions=own)
    under = ground.under(np.array([True, False, True, False]))
    assert (under.friction, under.frictions) == (0.5, (0.3, 0.5))
    assert under.shares.tolist() == [0.6, 1.0]
    assert (under.contact.tolist(), under.servo.tolist()) == ([1.0, 3.0], [5.0, 7.0])
    alike = Ground(springs, stiffness, friction=1.2, weight=10.0)
    assert alike.under(np.array([True, False, True, False])).friction == 1.2


@pytest.mark.physics
@pytest.mark.parametrize("speed", [0.5, 0.1])
def test_the_engine_slides_as_predicted(robot, world, speed):
    twist, loads = swing_on_all_feet(robot, world, speed)
    stance, rates = standing(robot, [0.0], speed=-1.0)
    predicted, shares = sliding_twist(stance, rates, Ground.of(robot, world), speed)
    # at most 0.2 mm/rad, 1 mrad/rad and 0.0005 of the weight measured, out of
    # 50 mm/rad, 0.25 rad/rad and 0.17
    assert twist[:2] == pytest.approx(-predicted[0, :2], abs=1e-3)
    assert twist[2] == pytest.approx(-predicted[0, 2], abs=0.01)
    assert loads == pytest.approx(shares[0], abs=0.003)


@pytest.mark.physics
def test_feet_sink_into_the_floor_as_far_as_its_compliance_says(robot, world):
    data = mujoco.MjData(world)
    mujoco.mj_resetDataKeyframe(world, data, world.key("start").id)
    mujoco.mj_step(world, data, nstep=2000)
    force = Sensors(world, robot).read(data.sensordata[None]).force[0]
    feet = [world.geom(f"foot_{leg}").id for leg in robot.legs]
    sunk = world.geom_size[feet, 0] - data.geom_xpos[feet, 2]
    # standing still to 1e-6 m/s, which the contact's damping turns into 1e-9 m
    assert sunk == pytest.approx(Ground.of(robot, world).contact * force, abs=1e-8)


def test_ground_takes_stiffness_friction_and_weight_from_the_world(robot, scenario):
    model = load(build(robot, scenario(servo_stiffness=70.0, friction=0.4)))
    ground = Ground.of(robot, model)
    assert (ground.servo == 70.0).all()
    assert ground.friction == pytest.approx(0.4)
    assert ground.weight == pytest.approx(1.27 * 9.81)


@pytest.mark.parametrize(
    "wrong",
    [
        {"weight": np.nan}, {"weight": 0.0}, {"weight": -1.0}, {"weight": np.inf},
        {"friction": -0.1}, {"friction": np.nan}, {"push": -1.0}, {"push": np.nan},
        {"contact": np.array([1e-6, np.nan])}, {"servo": np.array([-1.0, 1.0])},
    ],
    ids=str,
)  # fmt: skip
def test_a_ground_of_impossible_numbers_is_refused(wrong):
    given = {"contact": np.full(2, 1e-6), "servo": np.full(2, 9.0), "friction": 1.0}
    Ground(**given, weight=1.0)
    Ground(**given | {"servo": np.full(2, np.inf)}, weight=1.0)
    with pytest.raises(ValueError, match="numbers below 0 or none, or no weight"):
        Ground(**{**given, "weight": 1.0, **wrong})
