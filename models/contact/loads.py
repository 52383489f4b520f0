"""Normal forces under the feet of a standing robot, from statics."""

from __future__ import annotations

import numpy as np

from planner import Array

ROUNDING = 1e-12  # share of the weight that counts as zero


def static_loads(feet: Array, center_of_mass: Array) -> Array:
    """Normal forces that balance a unit weight.

    On three feet the forces are determined. On more feet, a rigid body is taken to
    stand on equal vertical springs; on fewer, the forces balance the weight as well as
    possible in the sense of least squares.

    Args:
        feet: Feet in contact, shape (N, F, 2) [m].
        center_of_mass: Shape (N, 2) [m], same frame as the feet.

    Returns:
        Share of the weight on each foot, shape (N, F), summing to 1; a foot that would
        have to pull gets none.
    """
    arms = np.concatenate([np.ones((*feet.shape[:-1], 1)), feet], axis=-1)
    target = np.concatenate([np.ones((len(feet), 1)), center_of_mass], axis=-1)
    standing = np.ones(feet.shape[:-1], dtype=bool)
    for _ in range(max(feet.shape[-2] - 2, 1)):
        G = arms * standing[..., None]
        balance = np.einsum("nfi,nfj->nij", G, G)
        sink = np.einsum("nij,nj->ni", np.linalg.pinv(balance), target)
        loads = np.einsum("nfi,ni->nf", G, sink)
        pulled = standing & (loads < -ROUNDING)
        if not pulled.any():
            break
        standing &= ~pulled
    loads = np.maximum(loads, 0.0)
    return loads / loads.sum(axis=-1, keepdims=True)
