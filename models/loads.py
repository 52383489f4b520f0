"""Normal forces under the feet of a standing robot: statics, nothing else."""

from __future__ import annotations

import numpy as np

Array = np.ndarray

_PULLED = -1e-12  # share of the weight; a foot that would pull is off the ground


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
    arms = np.concatenate(
        [np.ones((*feet.shape[:-1], 1)), feet], axis=-1
    )  # (..., F, 3)
    ones = np.ones((*center_of_mass.shape[:-1], 1))
    target = np.concatenate([ones, center_of_mass], axis=-1)
    standing = np.broadcast_to(planted, feet.shape[:-1])
    for _ in range(feet.shape[-2]):
        k = standing / compliance
        balance = np.einsum("...f,...fi,...fj->...ij", k, arms, arms)
        sink = np.einsum("...ij,...j->...i", np.linalg.pinv(balance), target)
        loads = k * np.einsum("...fi,...i->...f", arms, sink)
        pulled = standing & (loads < _PULLED)
        if not pulled.any():
            break
        standing = standing & ~pulled
    loads = np.clip(loads, 0.0, None)
    return np.asarray(loads / loads.sum(-1, keepdims=True))
