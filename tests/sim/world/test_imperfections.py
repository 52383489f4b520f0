"""Imperfections stand in the model, and predictions know nothing of them."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest

from models.description import actuators_driving, actuators_of
from sim.drive.drive import Drive
from sim.errors import UsageError
from sim.preparation.setup import prepare
from sim.world.imperfections import BACKLASH, _require_hold
from tests.walks import simulated


@pytest.fixture(scope="module")
def standing():
    from sim.scenarios.body_path import line
    from sim.scenarios.scenario import Scenario

    def make(**changes):
        given = {"name": "short", "segments": 2, "path": line((0.01, 0.01, 0.0))}
        return prepare(Scenario(**given | changes))

    return make


def test_a_payload_moves_the_centre_of_mass_by_its_share(standing):
    bare, loaded = standing(), standing(payload=[0.2, 0.05, -0.02, 0.03])

    def center(model):
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_forward(model, data)
        root = model.body("torso").id
        return model.body_subtreemass[root], data.subtree_com[root]

    (m, c), (total, moved) = center(bare.model), center(loaded.model)
    assert total == pytest.approx(m + 0.2)
    torso = np.array([0.05, -0.02, 0.03 + 0.06])  # the body's frame is 60 mm up
    assert moved == pytest.approx((m * c + 0.2 * torso) / total, abs=1e-9)


def test_a_slope_turns_gravity_and_keeps_its_size(standing):
    gravity = standing(slope=[0.1, np.pi / 2]).model.opt.gravity
    assert gravity == pytest.approx(9.81 * np.array([0, np.sin(0.1), -np.cos(0.1)]))


def test_a_soft_floor_keeps_the_proportion_of_its_damping(standing):
    stiff, soft = standing().model, standing(floor_stiffness=3000.0).model
    before, after = (model.geom("floor").solref for model in (stiff, soft))
    assert after[0] == -3000.0
    assert after[1] / after[0] == pytest.approx(before[1] / before[0])


def test_a_stiffer_floor_is_damped_no_more(standing):
    """More than 2 / h would make standing feet swing about their places."""
    stiff = standing(floor_stiffness=3e5).model
    stiffness, damping = stiff.geom("floor").solref
    assert (stiffness, damping) == (-3e5, standing().model.geom("floor").solref[1])
    assert -damping / stiff.geom("floor").solimp[0] * stiff.opt.timestep < 2


def test_the_floor_pushes_loose_legs_as_it_pushes_rigid_ones(standing):
    """What the engine makes of stiffness, damping, impedance and mobility."""
    loose, rigid = standing(backlash=0.01).model, standing().model
    feet = [rigid.geom(f"foot_{leg}").bodyid[0] for leg in range(1, 7)]

    def pushes(model):
        floor, mobility = model.geom("floor"), model.body_invweight0[feet, 0].mean()
        d = floor.solimp[0]
        give = (1 - d) / d * mobility  # acceleration that a force does not hold up
        return [*(floor.solref / d), give]

    # numbers of six digits in the text of the model
    assert pushes(loose) == pytest.approx(pushes(rigid), rel=1e-5)


@pytest.mark.physics
def test_a_robot_with_play_stands_without_rattling(standing):
    model = standing(backlash=0.01).model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_step(model, data, nstep=1000)
    assert np.abs(data.qvel).max() < 0.01  # 0.5 rad/s with a floor damped too much


def test_friction_of_a_foot_wins_over_that_of_the_floor(standing):
    values = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    model = standing(foot_friction=values).model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[2] -= 1e-4
    mujoco.mj_forward(model, data)
    names = [model.geom(int(max(c.geom))).name for c in data.contact]
    found = {n: c.friction[0] for n, c in zip(names, data.contact, strict=True)}
    assert found == pytest.approx({f"foot_{i + 1}": v for i, v in enumerate(values)})


@pytest.mark.parametrize("stiffness", [None, 3000.0])
def test_contacts_of_feet_with_friction_of_their_own_are_as_stiff(standing, stiffness):
    models = [
        standing(floor_stiffness=stiffness, foot_friction=given).model
        for given in (None, [0.7] * 6)
    ]

    def contacts(model):
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.qpos[2] -= 1e-4
        mujoco.mj_forward(model, data)
        return [(*c.solref, *c.solimp, c.dim, c.friction[0]) for c in data.contact]

    plain, own = map(contacts, models)
    assert len(plain) == len(own) == 6
    for before, now in zip(plain, own, strict=True):
        assert before[:-1] == now[:-1]
        assert (before[-1], now[-1]) == (1.0, 0.7)


def test_as_many_frictions_as_feet_are_asked_for(standing):
    with pytest.raises(UsageError, match="there are 6 feet, and foot_friction lists 2"):
        standing(foot_friction=[0.5, 0.6])


def test_play_is_a_joint_behind_each_leg_joint(standing):
    model = standing(backlash=0.02).model
    own = [model.joint(i).name for i in range(model.njnt)]
    legs = [n for n in own if n.startswith(("swing", "lift"))]
    assert [n for n in own if n.startswith(BACKLASH)]
    for name in legs:
        assert model.joint(BACKLASH + name).range == pytest.approx([-0.01, 0.01])
        assert model.joint(BACKLASH + name).axis == pytest.approx(
            model.joint(name).axis
        )
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    assert data.joint("root").qpos[2] == pytest.approx(0.06)


def test_zeros_of_servos_are_off_by_a_draw_that_can_be_repeated(standing):
    def offsets(**changes):
        setup = standing(zero_offset=0.02, **changes)
        scheduler_rows = next(iter(Drive(setup).commands(_hold(setup), None)))
        plain = next(iter(setup.commands(_hold(setup))))
        return (scheduler_rows - plain)[0][
            actuators_driving(setup.model, setup.robot.card.joints)
        ]

    first, again, other = offsets(draw=1), offsets(draw=1), offsets(draw=2)
    assert (first == again).all()
    assert np.abs(first - other).max() > 1e-3
    assert 0.005 < np.abs(first).max() <= 0.02


def _hold(setup):
    from sim.motion.schedule import Scheduler

    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(0.01)
    return scheduler.finish()


@pytest.mark.physics
@pytest.mark.parametrize(
    "feet", [{"friction": 0.3}, {"foot_friction": [0.1, 0.2, 0.3, 0.1, 0.2, 0.3]}]
)
def test_a_floor_too_steep_for_its_friction_is_refused_by_its_setting(standing, feet):
    with pytest.raises(UsageError, match="too steep for a friction of 0.3") as refusal:
        standing(slope=[0.35, 0.0], **feet)
    assert "less than 0.291 rad" in refusal.value.remedy  # atan(0.3)
    assert "above 0.365" in refusal.value.remedy  # tan(0.35)


def test_a_walk_with_play_on_a_slope_is_walked_and_its_prediction_is_not_met(scenario):
    bent = {"backlash": 0.01, "slope": [0.03, 1.0], "zero_offset": 0.01}
    off, true = (
        simulated(scenario(**changes)).summary["error"]["quasi_static"]["farthest"]
        for changes in (bent, {})
    )
    assert off > 3 * true
    assert off < 0.01  # and yet it walks


def test_bumps_are_as_high_as_asked_for_and_differ_from_draw_to_draw(standing):
    models = [standing(bumps=0.002, draw=draw).model for draw in (1, 1, 2)]
    first, again, other = (model.hfield_data for model in models)
    assert (first == again).all()
    assert np.abs(first - other).max() > 0.1
    floor = models[0].geom("floor")
    assert (first.min(), first.max()) == (0, 1)
    assert models[0].hfield_size[0, 2] == 0.002
    assert floor.pos[2] == -0.002  # their tops are where the plane was
    reach = models[0].hfield_size[0, :2] - np.abs(floor.pos[:2])
    assert (reach > 0.4).all()


@pytest.mark.physics
def test_feet_on_bumps_carry_the_weight_and_the_walk_strays(scenario):
    summary = simulated(scenario(bumps=0.001)).summary
    plain = simulated(scenario()).summary
    off = [s["error"]["quasi_static"]["farthest"] for s in (summary, plain)]
    assert off[0] > 2 * off[1]
    assert summary["achieved"]["min_margin"] > 0.02  # so contacts are seen
    assert summary["verdict"] in ("arrived", "drifted", "slipped")


@pytest.mark.parametrize(("kind", "gap"), [("dead_band", ""), ("backlash", BACKLASH)])
def test_standing_legs_give_way_by_half_the_slack_and_what_loads_bend(
    standing, kind, gap
):
    width, stiffness = 0.02, 50.0
    model = standing(**{kind: width}, servo_stiffness=stiffness).model
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for _ in range(2000):
        mujoco.mj_step(model, data)
    for leg in range(1, 7):
        servos = actuators_of(model, f"lift_{leg}")
        bent = abs(data.actuator_force[servos].sum()) / stiffness
        joints = {f"lift_{leg}", f"{gap}lift_{leg}"}
        given = sum(float(data.joint(name).qpos[0]) for name in joints)
        # the stop gives way by the torque, 0.3 N m, over some 5,000 N m/rad
        assert given == pytest.approx(width / 2 + bent, abs=1e-4)
        assert bent > 1e-3


def test_zeros_of_servos_are_given_joint_by_joint(standing):
    given = [round(0.001 * n - 0.006, 3) for n in range(12)]
    setup = standing(zero_offset=given)
    told = next(iter(Drive(setup).commands(_hold(setup), None)))
    plain = next(iter(setup.commands(_hold(setup))))
    order = actuators_driving(setup.model, setup.robot.card.joints)
    assert (told - plain)[0][order] == pytest.approx(given, abs=1e-15)
    names = [setup.model.actuator(int(i)).name for i in order[:4]]
    assert names == ["swing_1", "lift_1", "swing_2", "lift_2"]


def test_a_zero_for_each_joint_is_asked_for(standing):
    with pytest.raises(
        UsageError, match="there are 12 joints, and zero_offset lists 2"
    ):
        standing(zero_offset=[0.01, 0.02])
    with pytest.raises(UsageError, match="a number from 0 to 0.2, or a list of num"):
        standing(zero_offset=[0.3] * 12)


def test_a_floor_gives_way_to_loose_legs_as_far_as_to_rigid_ones(standing):
    def sunk(**changes):
        model = standing(floor_stiffness=1e4, **changes).model
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        for _ in range(2000):
            mujoco.mj_step(model, data)
        return -np.mean([contact.dist for contact in data.contact])

    rigid, loose = sunk(), sunk(backlash=0.01)
    assert rigid == pytest.approx(0.6e-3, rel=0.05)
    # the mobility of feet is that of bodies on average: 0.65 mm was measured
    assert loose == pytest.approx(rigid, rel=0.15)


def test_a_level_floor_holds_a_robot_on_hardly_any_friction():
    def held(slope, *feet, friction=0.2):
        rub = {"friction": friction, "foot_friction": feet}
        given = {"slope": slope, **rub, "name": "it"}
        _require_hold(SimpleNamespace(**given))

    held(None)
    held((0.0, 1.0), 0.01, 0.02)
    held((0.0, 0.0), friction=0.0)
    held((0.19, 0.0))
    held((0.29, 0.0), 0.1, 0.3)  # by the foot that rubs most
    with pytest.raises(UsageError, match="too steep for a friction of 0.2") as caught:
        held((0.3, 0.0))
    assert "by less than 0.197 rad, or give a friction above 0.309" in str(caught.value)
