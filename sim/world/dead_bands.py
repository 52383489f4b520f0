"""Dead bands of servos, which go on braking within them.

A servo gives no torque while its error is within half its band, though its motor brakes
the joint. A second spring on the joint takes the torque of the first one away, and has
no more to give beyond the band. For the law `step` both are steeper by a third spring,
whose torque ends later: at the band's edge the torque rises within a quarter of it.
"""

from dataclasses import replace

import mujoco
import numpy as np

from models import Card, Robot
from models.description import ON_JOINT, actuators_of
from planner import Array
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario
from sim.world.servos import servo_settings

BAND, STEP = "band_", "step_"  # springs, before the names of their joints
STEEP = 4.0  # of the spring at a step, in stiffnesses: a quarter of the band's half


def with_own_band(scenario: Scenario, card: Card) -> Scenario:
    """The scenario with the dead band of its servos' make, where it asks for that."""
    if scenario.dead_band != "own":
        return scenario
    kind = servo_settings(scenario, card).kind
    if kind is None:
        raise UsageError.of("no_make", f"scenario {scenario.name!r}")
    return replace(scenario, dead_band=kind.dead_band)


def dead_bands(scenario: Scenario, joints: int) -> Array:
    """Whole width of each leg joint's band, as it is simulated, shape (J,) [rad]."""
    wanted = np.broadcast_to(np.array(scenario.dead_band, dtype=float), joints)
    spread = abs(scenario.dead_band_spread)  # which may be -0.0
    random = np.random.default_rng((scenario.draw, len(BAND)))
    return wanted * (1 + random.uniform(-spread, spread, joints))


def band_in(model: mujoco.MjModel, joint: str) -> float:
    """Whole width of the dead band that a joint's servo has in a world [rad]."""
    _, *springs = actuators_of(model, joint)
    most, gain = model.actuator_forcerange[:, 1], model.actuator_gainprm[:, 0]
    return sum(float(-2 * most[spring] / gain[spring]) for spring in springs[:1])


def ensure_dead_bands(spec: mujoco.MjSpec, robot: Robot, scenario: Scenario) -> None:
    """Give every leg joint's servo its dead band; its springs follow all actuators."""
    servos = {s.target: s for s in spec.actuators if s.trntype in ON_JOINT}
    widths = dead_bands(scenario, len(robot.card.joints)).tolist()
    for name, width in zip(robot.card.joints, widths, strict=True):
        if not width:
            continue
        servo = servos[name]
        stiffness = float(servo.gainprm[0])
        steep = STEEP * stiffness if scenario.dead_band_law == "step" else 0.0
        most = (stiffness + steep) * width / 2
        for kind, gain in {BAND: -stiffness - steep, STEP: steep}.items():
            if gain:
                on = mujoco.mjtTrn.mjTRN_JOINT
                spring = spec.add_actuator(name=kind + name, target=name, trntype=on)
                spring.set_to_position(kp=gain)
                spring.forcelimited, spring.forcerange = True, [-most, most]
        # beyond the band the spring takes that much from the servo's largest torque
        if not steep and np.any(servo.forcerange):
            servo.forcerange = servo.forcerange + np.array([-most, most])
    (key,) = spec.keys
    added = [robot.standing_angle(s.target) for s in spec.actuators[len(key.ctrl) :]]
    key.ctrl = [*key.ctrl, *added]
