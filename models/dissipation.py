"""The body twist of feet that slide as little as dry friction allows.

Quasi-static bodies on dry friction move so that least power is dissipated (Murphey and
Burdick, 2006, the power dissipation method). Pure geometry and loads, vectorised over
configurations; where the feet are is for `models.kinematics` to say.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray

# |v| is smoothed to sqrt(|v|^2 + e^2); e falls from the fastest foot's speed by tens.
_SMOOTHING = tuple(10.0**-k for k in range(0, 9))
_NEWTON_STEPS = 12
_HALVINGS = 12


def foot_velocities(feet: Array, rates: Array, twist: Array) -> Array:
    """Velocity of each foot over the ground.

    Args:
        feet: Position of the feet in the body frame, shape (..., F, 2) [m].
        rates: Velocity of the feet relative to the body, shape (..., F, 2) [m/s].
        twist: Body twist (forward, left, yaw), shape (..., 3) [m/s, m/s, rad/s].

    Returns:
        Shape (..., F, 2), in the body frame.
    """
    turned = np.stack([-feet[..., 1], feet[..., 0]], axis=-1)
    return rates + twist[..., None, :2] + twist[..., None, 2:] * turned


def least_dissipation_twist(feet: Array, rates: Array, loads: Array) -> Array:
    """The twist xi that minimises sum_i N_i |v_i(xi)|.

    Args:
        feet: Positions in the body frame, shape (..., F, 2) [m].
        rates: Velocities relative to the body, shape (..., F, 2) [m/s].
        loads: Normal forces, zero for feet in the air, shape (..., F) [N].

    Returns:
        Body twist, shape (..., 3).
    """
    shape = rates.shape[:-2]
    speed = np.linalg.norm(rates * (loads[..., None] > 0), axis=-1).max(axis=-1)
    unit = np.where(speed > 0, speed, 1.0)[..., None]
    reach = np.linalg.norm(feet, axis=-1).max()
    J = _jacobians(feet / reach)  # (..., F, 2, 3), yaw measured in units of reach
    v = np.where(loads[..., None] > 0, rates / unit[..., None], 0.0)
    n = loads / loads.sum(axis=-1, keepdims=True)
    xi = np.zeros((*shape, 3))
    for smoothing in _SMOOTHING:
        xi = _descend(xi, J, v, n, smoothing)
    return xi * unit / np.array([1.0, 1.0, reach])


def _jacobians(feet: Array) -> Array:
    J = np.zeros((*feet.shape[:-1], 2, 3))
    J[..., 0, 0] = J[..., 1, 1] = 1.0
    J[..., 0, 2], J[..., 1, 2] = -feet[..., 1], feet[..., 0]
    return J


def _descend(xi: Array, J: Array, v: Array, n: Array, smoothing: float) -> Array:
    """Newton's method with halving on the smoothed dissipation, all rows at once."""
    for _ in range(_NEWTON_STEPS):
        w = v + np.einsum("...fij,...j->...fi", J, xi)
        s = np.sqrt((w**2).sum(-1) + smoothing**2)
        gradient = np.einsum("...f,...fij,...fi->...j", n / s, J, w)
        I = np.eye(2) / s[..., None, None]
        curvature = I - w[..., :, None] * w[..., None, :] / s[..., None, None] ** 3
        H = np.einsum("...f,...fia,...fij,...fjb->...ab", n, J, curvature, J)
        H = H + 1e-14 * np.trace(H, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
        step = -np.linalg.solve(H, gradient[..., None])[..., 0]
        xi, largest = _halve_until_lower(xi, step, J, v, n, smoothing)
        if largest < 1e-12:
            break
    return xi


def _halve_until_lower(
    xi: Array, step: Array, J: Array, v: Array, n: Array, smoothing: float
) -> tuple[Array, float]:
    def dissipation(x: Array) -> Array:
        w = v + np.einsum("...fij,...j->...fi", J, x)
        return (n * np.sqrt((w**2).sum(-1) + smoothing**2)).sum(-1)

    before = dissipation(xi)
    for _ in range(_HALVINGS):
        worse = dissipation(xi + step) > before * (1 + 1e-15)
        if not worse.any():
            break
        step = np.where(worse[..., None], step / 2, step)
    return xi + step, float(np.abs(step).max(initial=0.0))


def static_loads(
    feet: Array, planted: Array, center_of_mass: Array, compliance: Array
) -> Array:
    """Normal forces that balance a unit weight on the planted feet.

    Three feet leave no choice. On more the ground and servos act as vertical springs
    under a rigid body, and a foot that such springs would pull is taken off the ground.

    Args:
        feet: Shape (..., F, 2) [m].
        planted: Feet in contact, shape (..., F), bool.
        center_of_mass: Shape (..., 2) [m], same frame as the feet.
        compliance: Vertical compliance of each foot, shape (F,) [m/N].

    Returns:
        Share of the weight on each foot, shape (..., F), summing to 1.
    """
    arms = np.concatenate([np.ones((*feet.shape[:-1], 1)), feet], axis=-1)  # (..., F, 3)
    target = np.concatenate(
        [np.ones((*center_of_mass.shape[:-1], 1)), center_of_mass], axis=-1
    )
    standing = np.broadcast_to(planted, feet.shape[:-1])
    for _ in range(feet.shape[-2]):
        k = standing / compliance
        balance = np.einsum("...f,...fi,...fj->...ij", k, arms, arms)
        sink = np.einsum("...ij,...j->...i", np.linalg.pinv(balance), target)
        loads = k * np.einsum("...fi,...i->...f", arms, sink)
        pulled = standing & (loads < -1e-12)
        if not pulled.any():
            break
        standing = standing & ~pulled
    return np.clip(loads, 0.0, None) / np.clip(loads, 0.0, None).sum(-1, keepdims=True)
