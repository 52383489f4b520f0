"""The actuators of a compiled model: which drive a joint, and how far they turn it."""

from collections.abc import Iterable

import mujoco
import numpy as np

from models.errors import ModelError
from planner import Array

ON_JOINT = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


def is_position_servo(gain: Array, bias: Array, bias_type: int) -> bool:
    """Whether an actuator's force is a gain times what is left to its command.

    Gain `gainprm`, of which the first number alone is no slope, and bias `biasprm`, the
    second of which is per unit of the joint's angle.
    """
    if bias_type != mujoco.mjtBias.mjBIAS_AFFINE or gain[1:3].any():
        return False
    return bool(gain[0] > 0 and abs(bias[1] + gain[0]) <= 1e-5 * gain[0])  # rounded


def actuators_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Indices of the actuators that drive a joint."""
    driven, kinds = model.actuator_trnid[:, 0], model.actuator_trntype
    own = np.flatnonzero(driven == model.joint(joint).id).tolist()
    return [i for i in own if mujoco.mjtTrn(kinds[i]) in ON_JOINT]


def position_servos_of(model: mujoco.MjModel, joint: str) -> list[int]:
    """Indices of the position servos that drive a joint."""
    gain, bias = model.actuator_gainprm, model.actuator_biasprm
    own = [i for i in actuators_of(model, joint) if model.actuator_plugin[i] < 0]
    kind = model.actuator_biastype
    return [i for i in own if is_position_servo(gain[i], bias[i], kind[i])]


def span_of(model: mujoco.MjModel, joint: str, free: float) -> tuple[float, float]:
    """Angles that a hinge and its servos allow, `free` either way if all [rad]."""
    index = model.joint(joint).id
    spans = [model.jnt_range[index]] if model.jnt_limited[index] else []
    for servo in position_servos_of(model, joint):
        if model.actuator_ctrllimited[servo]:
            gear = model.actuator_gear[servo, 0]
            spans.append(np.sort(model.actuator_ctrlrange[servo] / gear))
    low = max((float(span[0]) for span in spans), default=-free)
    return low, min((float(span[1]) for span in spans), default=free)


def actuator_of(model: mujoco.MjModel, joint: str) -> int:
    """Index of the first actuator that drives a joint; refused if there is none."""
    found = actuators_of(model, joint)
    if not found:
        raise ModelError(f"no actuator drives joint {joint!r}: give it a servo")
    return found[0]


def actuators_driving(model: mujoco.MjModel, joints: Iterable[str]) -> np.ndarray:
    """These indices for several joints, shape (J,)."""
    return np.array([actuator_of(model, joint) for joint in joints])
