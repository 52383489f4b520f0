"""Dead bands of servos, which go on braking within them.

A servo gives no torque while its error is within half its band, and beyond it the
stiffness times the rest of the error, or by the law `step` times all of it. Its motor
brakes the joint all the while, and its rotor turns with it. The engine has no such
servo. Its spring is therefore put on a joint of its own, which weighs next to nothing,
follows the command, and holds the leg's joint by a stop on either side; rotor and
damping act on the sum of both angles. A step is a second spring on that joint, steeper
and of limited torque.
"""

from __future__ import annotations

import mujoco
import numpy as np

from models import Robot
from models.description import ON_JOINT, compile_model
from planner import Array
from sim.scenarios.scenario import Scenario
from sim.world.imperfections import add_loose_joint

BAND = "band_"  # before the name of the joint whose servo has one
BRAKE = "brake_"  # tendon on which the servo's rotor and damping act
STEP = "step_"  # before it, of the spring that makes the torque jump at the band's edge
# solimp; the stops give way by as much as the spring's own joint is light, and softer
# ones would be felt
UNYIELDING = (0.9999, 0.9999, 0.001, 0.5, 2.0)
STEEP = 4.0  # of the spring at a step, in stiffnesses: a quarter of the band's half
FOLLOWS = 2.0  # time steps after which the spring has followed its command
ROTOR_SHARE = 0.1  # of the rotor, that turns with the spring and not with the leg


def dead_bands(scenario: Scenario, joints: int) -> Array:
    """Whole width of each leg joint's band, as it is simulated, shape (J,) [rad]."""
    wanted = np.broadcast_to(np.array(scenario.dead_band, dtype=float), joints)
    spread = scenario.dead_band_spread
    random = np.random.default_rng((scenario.draw, len(BAND)))
    drawn: Array = wanted * (1 + random.uniform(-spread, spread, joints))
    return drawn


def ensure_dead_bands(spec: mujoco.MjSpec, robot: Robot, scenario: Scenario) -> None:
    """Give every leg joint's servo its dead band."""
    widths = dead_bands(scenario, len(robot.card.joints))
    if not widths.any():
        return
    model, step = compile_model(spec.copy(), str(robot.path)), scenario.timestep
    servos = {s.target: s for s in spec.actuators if s.trntype in ON_JOINT}
    for name, width in zip(robot.card.joints, widths.tolist(), strict=True):
        if not width:
            continue
        joint, servo = spec.joint(name), servos[name]
        number = model.actuator(servo.name).id
        stiffness = model.actuator_gainprm[number, 0]
        braking = float(np.ravel(joint.damping)[0]) - model.actuator_biasprm[number, 2]
        steep = 0.0
        if scenario.dead_band_law == "step":
            steep = STEEP * stiffness
            most = stiffness * width / 2
            spec.add_tendon(name=STEP + name).wrap_joint(name, 1.0)
            spec.add_actuator(
                name=STEP + name,
                target=STEP + name,
                trntype=mujoco.mjtTrn.mjTRN_TENDON,
                forcelimited=True,
                forcerange=[-most, most],
            ).set_to_position(kp=steep)
        # damping of the springs' own joint
        follow = FOLLOWS * step * (stiffness + steep)
        rotor = float(joint.armature + servo.armature)
        # what an explicit step can follow
        own = max(step**2 * (stiffness + steep), ROTOR_SHARE * rotor)
        brake = spec.add_tendon(
            name=BRAKE + name,
            armature=max(rotor - own, 0.0),
            damping=[max(braking - follow, 0.0), 0.0, 0.0],
        )
        add_loose_joint(joint, BAND, width, solimp_limit=UNYIELDING)
        for part in (name, BAND + name):
            brake.wrap_joint(part, 1.0)
        servo.armature = servo.biasprm[2] = 0.0
        joint.armature, joint.damping = own, [follow, 0.0, 0.0]
