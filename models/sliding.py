"""Body twist and loads together, where more feet stand than statics can load.

On more than three feet the loads depend on how floor and servos give way, that on the
friction which bends the legs and on the sliding which lifts the feet, and friction on
the loads and the very twist that is sought. For a given twist, though, the loads follow
from linear equations, so what is left is to balance the friction: three equations for
the three numbers of the twist. Friction is smoothed near rest, ever less. Vectorised
over configurations; on three feet `models.dissipation` is exact and faster.
"""

from __future__ import annotations

import numpy as np

from models.dissipation import foot_jacobians
from models.ground import Ground
from models.kinematics import Stance

Array = np.ndarray

_SMOOTHINGS = (1.0, 0.1, 0.01, 1e-3, 1e-4)  # of the fastest rate
_NEWTON_STEPS = 12
_HALVINGS = 10
_BALANCED = 1e-9  # of the weight
_LEAST_COMPLIANCE = 0.1  # of a leg's own, where friction would jam it


def sliding_twist(
    stance: Stance, rates: Array, ground: Ground, speed: float = 0.0
) -> tuple[Array, Array]:
    """The twist at which friction balances, and the loads that go with it.

    Args:
        stance: Feet in contact, N configurations of F feet.
        rates: Velocities of the feet relative to the body, shape (N, F, 2).
        ground: Compliance under the same feet.
        speed: What a rate of 1 stands for when sliding pushes feet apart; 0 leaves
            that out, as Coulomb's law does.

    Returns:
        Twist, shape (N, 3), and share of the weight on each foot, shape (N, F).
    """
    fastest = np.linalg.norm(rates, axis=-1).max(axis=-1)
    unit = np.where(fastest > 0, fastest, 1.0)[:, None]
    balance = _Balance(stance, rates / unit[..., None], ground, speed * unit)
    xi = balance.solve()
    loads, _ = balance.loads(xi, _SMOOTHINGS[-1])
    return xi * unit / np.array([1.0, 1.0, balance.reach]), loads


class _Balance:
    """Friction on all feet; units are the fastest rate, the weight and the reach."""

    def __init__(
        self, stance: Stance, rates: Array, ground: Ground, speed: Array
    ) -> None:
        self.reach = float(np.linalg.norm(stance.feet, axis=-1).max())
        feet, center = stance.feet / self.reach, stance.center_of_mass / self.reach
        self.rates, self.ground, self.speed = rates, ground, speed
        self.J = foot_jacobians(feet)  # (N, F, 2, 3)
        self.arms = np.concatenate([np.ones((*feet.shape[:-1], 1)), feet], axis=-1)
        self.moments = np.concatenate([np.ones((len(feet), 1)), center], axis=-1)
        self.sideways = stance.gives[..., :2]  # (N, F, 2)
        self.upward = stance.gives[..., 2]  # (N, F)

    def solve(self) -> Array:
        """Newton's method on ever less smoothed friction."""
        xi = np.zeros((len(self.rates), 3))
        for smoothing in _SMOOTHINGS:
            for _ in range(_NEWTON_STEPS):
                rest = self.force(xi, smoothing)
                if np.abs(rest).max() < _BALANCED:
                    break
                step = -np.linalg.solve(self._slope(xi, smoothing), rest[..., None])
                xi = xi + self._shortened(xi, step[..., 0], rest, smoothing)
        return xi

    def force(self, xi: Array, smoothing: float) -> Array:
        """Sum of friction forces and their moment, shape (N, 3)."""
        loads, direction = self.loads(xi, smoothing)
        force = np.einsum("nf,nfij,nfi->nj", loads, self.J, direction)
        return np.asarray(force)

    def loads(self, xi: Array, smoothing: float) -> tuple[Array, Array]:
        """Share of the weight on each foot, and the direction in which it slides.

        Leg i sinks by (upward N - sideways . friction) upward / servo + contact N; the
        sliding pushes it up, and the body stays plane.
        """
        ground = self.ground
        w = self.rates + np.einsum("nfij,nj->nfi", self.J, xi)
        speed = np.sqrt((w**2).sum(axis=-1) + smoothing**2)
        direction = w / speed[..., None]
        dragged = ground.friction * (self.sideways * direction).sum(axis=-1)
        own = self.upward**2 / ground.servo + ground.contact
        compliance = (
            self.upward * (self.upward - dragged) / ground.servo + ground.contact
        )
        k = 1 / np.maximum(compliance, _LEAST_COMPLIANCE * own) / ground.weight
        pushed = k * ground.friction * ground.push * self.speed * speed
        return self._planar(k, pushed), direction

    def _planar(self, k: Array, pushed: Array) -> Array:
        """Loads of springs under a plane body; none of them pulls."""
        standing = np.ones(k.shape, dtype=bool)
        for _ in range(k.shape[-1] - 3):
            loads = self._springs(
                np.where(standing, k, 0), np.where(standing, pushed, 0)
            )
            if not (loads < 0).any():
                break
            standing &= loads >= 0
        return np.asarray(np.maximum(loads, 0.0))

    def _springs(self, k: Array, pushed: Array) -> Array:
        stiffness = np.einsum("nf,nfi,nfj->nij", k, self.arms, self.arms)
        missing = self.moments - np.einsum("nf,nfi->ni", pushed, self.arms)
        sunk = np.linalg.solve(stiffness, missing[..., None])[..., 0]
        return np.asarray(k * np.einsum("nfi,ni->nf", self.arms, sunk) + pushed)

    def _slope(self, xi: Array, smoothing: float) -> Array:
        """Derivative of the force by central differences, shape (N, 3, 3)."""
        d = 1e-4 * smoothing
        ahead, behind = (
            [self.force(xi + sign * d * axis, smoothing) for axis in np.eye(3)]
            for sign in (1, -1)
        )
        slope = np.subtract(ahead, behind) / (2 * d)  # (3, N, 3)
        return np.moveaxis(slope, 0, -1) + 1e-12 * np.eye(3)

    def _shortened(
        self, xi: Array, step: Array, rest: Array, smoothing: float
    ) -> Array:
        """The step, halved where it does not bring the force closer to balance."""
        before = np.linalg.norm(rest, axis=-1)
        for _ in range(_HALVINGS):
            after = np.linalg.norm(self.force(xi + step, smoothing), axis=-1)
            worse = (after >= before) & (before > _BALANCED)
            if not worse.any():
                break
            step = np.where(worse[:, None], step / 2, step)
        return step
