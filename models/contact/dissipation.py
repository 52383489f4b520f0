"""The body twist at which the feet dissipate the least power in dry friction.

A quasi-static body on dry friction moves so that it dissipates the least power (Murphey
and Burdick 2006): its twist xi minimises the convex function sum_i N_i |D_i v_i(xi)|,
which has an edge wherever a foot sticks. Each foot is tried in turn as the one that
sticks and about which the body turns; the subgradient tells whether this is the
minimum. Where every foot slides, Newton's method finds it. The symmetric D_i maps the
unit disc to the ellipse of the foot's friction (Hatton, Salaman and Revzen 2025).
"""

from dataclasses import dataclass

import numpy as np

from planner import Array

_STICKS = 1e-9  # slower than this share of the fastest rate, a foot sticks


def foot_velocities(feet: Array, rates: Array, twist: Array) -> Array:
    """Velocity of each foot over the ground, shape (..., F, 2), in the body frame.

    Feet [m] and their velocities relative to the body have shape (..., F, 2), the body
    twist (forward, left, yaw) has shape (..., 3).
    """
    turned = np.stack([-feet[..., 1], feet[..., 0]], axis=-1)
    return rates + twist[..., None, :2] + twist[..., None, 2:] * turned


def foot_jacobians(feet: Array) -> Array:
    """Derivative of each foot's velocity by the twist, shape (..., F, 2, 3)."""
    J = np.zeros((*feet.shape[:-1], 2, 3))
    J[..., 0, 0] = J[..., 1, 1] = 1.0
    J[..., 0, 2], J[..., 1, 2] = -feet[..., 1], feet[..., 0]
    return J


def ellipses(along: Array, friction: tuple[float, float]) -> Array:
    """Ellipses D of friction along unit vectors (..., 2) and across, (..., 2, 2)."""
    lengthwise = along[..., :, None] * along[..., None, :]
    return friction[0] * lengthwise + friction[1] * (np.eye(2) - lengthwise)


def viscous_twist(
    feet: Array, rates: Array, loads: Array, grip: Array | None = None
) -> Array:
    """The body twist xi that minimises sum_i N_i |D_i v_i(xi)|^2, shape (N, 3).

    Arguments are those of `least_dissipation_twist`. Two feet at one place are a
    LinAlgError: drag does not tell how the body turns about them.
    """
    J = foot_jacobians(feet)
    if grip is not None:
        J, rates = grip @ J, (grip @ rates[..., None])[..., 0]
    H = np.einsum("nf,nfij,nfik->njk", loads, J, J)
    drag = np.einsum("nf,nfij,nfi->nj", loads, J, rates)
    return -np.linalg.solve(H, drag[..., None])[..., 0]


def least_dissipation_twist(
    feet: Array, rates: Array, loads: Array, grip: Array | None = None
) -> Array:
    """The body twist xi that minimises sum_i N_i |D_i v_i(xi)|, shape (N, 3).

    Feet [m] and their velocities [m/s] are those in the body frame, shape (N, F, 2),
    normal forces are zero for feet in the air, shape (N, F) [N]. Ellipses D_i of
    friction have shape (N, F, 2, 2); without them feet rub alike in all directions.
    """
    on = loads[..., None] > 0
    speed = np.linalg.norm(rates * on, axis=-1).max(axis=-1)
    unit = np.where(speed > 0, speed, 1.0)[:, None]
    reach = float(np.linalg.norm(feet, axis=-1).max())
    moved = np.where(on, rates / unit[..., None], 0.0)
    shares = loads / loads.sum(axis=-1, keepdims=True)
    xi = _Problem(feet / reach, moved, shares, grip).solve()
    return xi * unit / np.array([1.0, 1.0, reach])


@dataclass(frozen=True, eq=False)
class _Problem:
    """Dissipation scaled so that speeds, lengths and loads are of order one."""

    feet: Array
    rates: Array
    loads: Array
    grip: Array | None = None

    def solve(self) -> Array:
        """The best twist about a foot that sticks, the heaviest first, or better."""
        xi, least = np.zeros((len(self.feet), 3)), np.full(len(self.feet), np.inf)
        rest = np.arange(len(self.feet))
        for foot in np.argsort(-self.loads, axis=1, kind="stable").T:
            part, about = self.take(rest), foot[rest]
            turn = part.turning_about(about)
            bears = part.loads[np.arange(len(about)), about] > 0
            power = np.where(bears, part.dissipation(turn), np.inf)
            better = power < least[rest]
            xi[rest[better]], least[rest[better]] = turn[better], power[better]
            rest = rest[~part.is_minimum(turn, about)]
            if not rest.size:
                return xi
        xi[rest] = self.take(rest).improve(xi[rest])
        return xi

    def take(self, rows: Array) -> "_Problem":
        """Some of the configurations."""
        grip = None if self.grip is None else self.grip[rows]
        return _Problem(self.feet[rows], self.rates[rows], self.loads[rows], grip)

    def gripped(self, ways: Array) -> Array:
        """Motions of the feet as their friction weighs them, (N, F, 2, ...)."""
        return ways if self.grip is None else self.grip @ ways

    def sliding(self, xi: Array) -> Array:
        """Velocities of the feet as their friction weighs them, (N, F, 2)."""
        velocities = foot_velocities(self.feet, self.rates, xi)
        return self.gripped(velocities[..., None])[..., 0]

    def dissipation(self, xi: Array, smoothing: float = 0.0) -> Array:
        """Smoothed power, shape (N,)."""
        square = (self.sliding(xi) ** 2).sum(-1)
        return (self.loads * np.sqrt(square + smoothing**2)).sum(-1)

    def turning_about(self, foot: Array) -> Array:
        """The best twist at which a given foot (N,) sticks, shape (N, 3).

        With foot i at rest, foot j moves at |a + omega b|, a the difference of their
        rates and b at right angles to the line between them: |b| times the distance of
        omega, on the real axis, from the complex number -a / b. The sum over j is
        convex in omega; the sign of its slope is bisected.
        """
        at = np.arange(len(foot)), foot
        r = self.feet[..., 0] + 1j * self.feet[..., 1]
        v = self.rates[..., 0] + 1j * self.rates[..., 1]
        a, b = v - v[at][:, None], 1j * (r - r[at][:, None])  # (N, F)
        if (D := self.grip) is not None:
            a, b = (
                D[..., 0, 0] * z.real + D[..., 0, 1] * z.imag
                + 1j * (D[..., 1, 0] * z.real + D[..., 1, 1] * z.imag)
                for z in (a, b)
            )  # fmt: skip
        far = np.abs(b) > 0
        z = -a / np.where(far, b, 1.0)
        p, q2 = z.real, z.imag**2
        weight = self.loads * np.abs(b)
        carrying = far & (weight > 0)
        alone = ~carrying.any(axis=-1)  # all weight on one foot: any turn will do
        low = np.where(alone, 0.0, np.where(carrying, p, np.inf).min(axis=-1))
        high = np.where(alone, 0.0, np.where(carrying, p, -np.inf).max(axis=-1))
        p, q2, weight = (np.ascontiguousarray(each.T) for each in (p, q2, weight))
        for _ in range(52):  # digits of a double; on long rows, (F, N), which is faster
            omega = (low + high) / 2  # (N,)
            d = omega - p
            length = np.sqrt(d**2 + q2)
            slope = (weight * d / np.where(length > 0, length, 1.0)).sum(axis=0)
            low = np.where(slope < 0, omega, low)
            high = np.where(slope > 0, omega, high)
        omega = (low + high) / 2
        (x, y), (forward, left) = self.feet[at].T, self.rates[at].T
        return np.stack([-forward + omega * y, -left - omega * x, omega], axis=-1)

    def is_minimum(self, xi: Array, sticking: Array) -> Array:
        """Whether friction at the sticking foot balances that of the sliding ones.

        A foot that sticks bears any friction up to its load. Where several stick the
        answer is no unless nothing slides at all: then there is nothing to improve.
        """
        w = self.sliding(xi)
        speed = np.linalg.norm(w, axis=-1)
        sliding = (speed > _STICKS) & (self.loads > 0)
        force = self.loads[..., None] * w / np.where(sliding, speed, np.inf)[..., None]
        alone = ((self.loads > 0) & ~sliding).sum(axis=-1) == 1
        rows = np.arange(len(xi))
        total = self.gripped(force[..., None]).sum(axis=1)
        if self.grip is not None:
            total = np.linalg.solve(self.grip[rows, sticking], total)
        needed = np.linalg.norm(total[..., 0], axis=-1)
        held = needed <= self.loads[rows, sticking] * (1 + 1e-12)
        return (alone & held) | ~sliding.any(axis=-1)

    def improve(self, start: Array) -> Array:
        """Newton's method on ever less smoothed dissipation; the start if worse."""
        J = self.gripped(foot_jacobians(self.feet))
        xi = start
        for smoothing in (10.0**-k for k in range(1, 9, 2)):
            for _ in range(12):  # steps of Newton's method
                step = self._newton_step(xi, J, smoothing)
                xi = xi + step
                if np.abs(step).max() < 1e-3 * smoothing:
                    break
        better = self.dissipation(xi) < self.dissipation(start)
        return np.where(better[:, None], xi, start)

    def _newton_step(self, xi: Array, J: Array, smoothing: float) -> Array:
        """Newton's step, halved until the power is lower, and 0 where it never is."""
        w = self.sliding(xi)
        s = np.sqrt((w**2).sum(-1) + smoothing**2)[..., None]  # (N, F, 1)
        Jw = np.einsum("nfij,nfi->nfj", J, w / s)
        gradient = (self.loads[..., None] * Jw).sum(axis=1)
        H = np.einsum("nf,nfij,nfik->njk", self.loads / s[..., 0], J, J)
        H -= np.einsum("nf,nfj,nfk->njk", self.loads / s[..., 0], Jw, Jw)
        H += 1e-14 * np.trace(H, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        step = -np.linalg.solve(H, gradient[..., None])[..., 0]
        before = self.dissipation(xi, smoothing) * (1 + 1e-15)
        for _ in range(12):  # halvings of a step
            worse = self.dissipation(xi + step, smoothing) > before
            if not worse.any():
                return step
            step = np.where(worse[:, None], step / 2, step)
        worse = self.dissipation(xi + step, smoothing) > before
        return np.where(worse[:, None], 0.0, step)
