"""One frictional equilibrium: a body on springs, its feet on a floor that gives way.

Unknown are the body's step, a twist of six numbers, and the forces of the floor. With
the feet's motion u = G xi + u0 + C f the floor asks of every point

    normal     0 <= f_n  _|_  z + u_n - p |u_t| + f_n / k_n >= 0
    friction   |f_t| <= mu f_n,  u_t = 0 inside the cone,  u_t = -lambda f_t on it
    body       sum of G^T f + w - M xi = 0

which Alart and Curnier (1991) write as equations that are smooth almost everywhere.
Newton's method solves them: the points of a foot are eliminated, six unknowns are left.
Where p is 0, friction is Coulomb's own law and not the associated one, p = mu. The soft
contacts of the engine are in between: in proportion to its speed, sliding lifts a foot.
All arrays have a leading axis of lanes, problems that are solved side by side.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from planner import Array

FORCE, WAY, ARM = 1e-6, 1e-9, 0.1  # allowed [N], [m]; moments count at an arm [m]
NEWTON_STEPS = 14  # of Newton's method on a scale
TURNING_EVERY = 3  # of its steps, joints go to or from the stops of their backlash
SHORTENED = 7  # steps after which they are shortened
FARTHEST_STEP = 0.004  # [m], and ten times as many radians, of a step
SCALES = (  # of normal and tangential gaps against a leg's own stiffness, in turn
    (0.1, 0.05), (0.02, 0.001), (0.02, 0.02), (1.0, 0.001), (0.02, 1e-4), (1.0, 1.0),
)  # fmt: skip
EASE = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])  # [N/m], [N m/rad], of Newton's step
CREEP = 1e-7  # of a leg's own compliance, where a foot cannot give way along the floor


@dataclass(frozen=True, eq=False)
class Lanes:
    """Arrays with a leading axis of lanes; None where lanes have no such thing."""

    def take(self, which: Array) -> Self:
        """Some of the lanes."""
        kept = {n: None if v is None else v[which] for n, v in vars(self).items()}
        return type(self)(**kept)


@dataclass(frozen=True, eq=False)
class Contact(Lanes):
    """A problem: B lanes, F feet of K points, n = 3 K directions, J joints."""

    reach: Array  # of the points by the body's twist, G, (B, F, n, 6)
    lever: Array  # by the joints, (B, F, n, J) [m/rad]
    yield_: Array  # of the joints, (B, F, J) [rad/(N m)]
    drift: Array  # motion of the points without forces, u0, (B, F, n) [m]
    gap: Array  # height above the floor before, z, (B, F, K) [m]
    floor: Array  # compliance of the floor, 1 / k_n, (B, F, K) [m/N]
    friction: Array  # mu, (B, F, K)
    wrench: Array  # on the body, w, (B, 6) [N], [N m]
    inertia: Array  # M, over the square of the time, (B, 6, 6)
    push: Array  # of sliding over its way, p, (B, F, K)
    side: Array | None = None  # of their backlash where joints are at first, (B, F, J)
    number: Array | None = None  # of the lane, for `Give`, (B,), int


Give = Callable[[Contact, Array], tuple[Array, Array, Array]]
"""Angles by which torques (B, F, J) turn the joints, their slope, and joints' sides.

Sides are -1 or 1 at a stop, else 0; the angles are those on `contact.side`, if given.
"""


class Found(NamedTuple):
    """The equilibria of B lanes."""

    twist: Array  # step of the body, (B, 6) [m], [rad]
    force: Array  # of the floor on every point, (B, F, K, 3) [N]
    error: Array  # the largest violation, of what is allowed, (B,)

    @property
    def holds(self) -> Array:
        """Which lanes are in equilibrium, (B,), bool."""
        return self.error <= 1


def equilibrium(
    contact: Contact, twist: Array, force: Array, give: Give | None = None
) -> Found:
    """Solve, from a guess of twist (B, 6) and forces (B, F, K, 3).

    Lanes that do not converge on one scale are tried on the next. `give` replaces the
    linear springs where joints have slack or a largest torque, from `contact.side`.
    """
    found = _newton(contact, twist, force, SCALES[0], give)
    for attempt, scale in enumerate(SCALES[1:]):
        if not len(left := np.flatnonzero(~found.holds)):
            break
        guess = twist[left] * (attempt % 2)
        again = _newton(contact.take(left), guess, force[left], scale, give)
        better = again.error < found.error[left]
        for mine, new in zip(found, again, strict=True):
            mine[left[better]] = new[better]
    return found


def motion(
    contact: Contact, twist: Array, force: Array, turned: Array | None = None
) -> Array:
    """Motion u of every point at a twist and forces, (B, F, K, 3) [m].

    `turned` are the angles by which the forces turn the joints, where they are known.
    """
    if turned is None:
        turned = contact.yield_ * torque_of(contact.lever, force)
    by_body = (contact.reach @ twist[:, None, :, None])[..., 0]
    by_joints = (contact.lever @ turned[..., None])[..., 0]
    return (by_body + contact.drift + by_joints).reshape(force.shape)


def torque_of(lever: Array, force: Array) -> Array:
    """Torques of forces (B, F, K, 3) about the joints, (B, F, J) [N m]."""
    return (_flat(force)[:, :, None] @ lever)[:, :, 0]


def _compliance(contact: Contact, slope: Array) -> Array:
    """The points' compliance with the floor's, (B, F, n, n) [m/N]."""
    lever, points = contact.lever, contact.gap.shape[-1]
    C = (lever * slope[:, :, None]) @ np.swapaxes(lever, 2, 3)
    along = np.arange(3 * points)
    own = np.maximum(C[..., along, along].max(axis=-1), 1e-12)
    C[..., along, along] += CREEP * own[..., None]
    C[..., 2::3, 2::3][..., np.arange(points), np.arange(points)] += contact.floor
    return C


def _newton(
    contact: Contact,
    twist: Array,
    force: Array,
    scale: tuple[float, float],
    give: Give | None,
) -> Found:
    """Newton's method on one scale; lanes that are done are left out.

    Joints go to or from their stops when feet have settled: as they are thousands of
    times as soft in between, they would go to and fro for ever.
    """
    best = Found(twist.copy(), force.copy(), np.full(len(twist), np.inf))
    lanes = np.arange(len(twist))
    compliance = _compliance(contact, contact.yield_)
    law = _Law.of(contact, compliance, scale)
    for step in range(NEWTON_STEPS if give is None else 2 * NEWTON_STEPS):
        turned, settled = None, np.ones(len(lanes), dtype=bool)
        turning = give is None or (step > 0 and step % TURNING_EVERY == 0)
        if give is not None:
            torque = torque_of(contact.lever, force)
            if turning:
                contact = replace(contact, side=give(contact, torque)[2])
            turned, slope, side = give(contact, torque)
            settled = np.all(side == contact.side, axis=(1, 2))
            compliance = _compliance(contact, slope)
            law = _Law.of(contact, compliance, scale)
        state = law.at(contact, twist, force, motion(contact, twist, force, turned))
        state.error[~settled] = np.inf
        better = state.error < best.error[lanes]
        for mine, new in zip(best, (twist, force, state.error), strict=True):
            mine[lanes[better]] = new[better]
        if not (left := best.error[lanes] > 1).any():
            break
        if left.mean() < 0.7:
            lanes, twist, force = lanes[left], twist[left], force[left]
            contact, law, state = contact.take(left), law.take(left), state.take(left)
            compliance = compliance[left]
        dx, df = _step(contact, law, state, compliance)
        size = np.maximum(np.abs(dx[:, :3]).max(1), 0.1 * np.abs(dx[:, 3:]).max(1))
        cut = np.minimum(1.0, FARTHEST_STEP / np.maximum(size, 1e-12))
        cut *= 0.6 if step >= SHORTENED and turning else 1.0
        twist = twist + cut[:, None] * dx
        force = force + cut[:, None, None, None] * df.reshape(force.shape)
    return best


@dataclass(frozen=True, eq=False)
class _State(Lanes):
    """How far a guess is from equilibrium, and which part of the law holds where."""

    wrong: Array  # Alart and Curnier's function, (B, F, K, 3) [N]
    unbalanced: Array  # (B, 6) [N], [N m]
    error: Array  # (B,)
    sticks: Array  # (B, F, K), bool
    slides: Array
    lifted: Array
    along: Array  # where it would slide, of length 1, (B, F, K, 2)
    share: Array  # bound of friction over the force that is tried, (B, F, K)
    closes: Array  # derivative of the gap by the motion, (B, F, K, 3)


@dataclass(frozen=True, eq=False)
class _Law(Lanes):
    """Alart and Curnier's function on a scale."""

    normal: Array  # (B, F, K) [N/m]
    tangent: Array

    @classmethod
    def of(
        cls, contact: Contact, compliance: Array, scale: tuple[float, float]
    ) -> "_Law":
        own = np.diagonal(compliance, axis1=2, axis2=3).reshape(*contact.gap.shape, 3)
        return cls(scale[0] / own[..., 2], 2 * scale[1] / (own[..., 0] + own[..., 1]))

    def at(self, contact: Contact, twist: Array, force: Array, u: Array) -> _State:
        tried = force[..., :2] - self.tangent[..., None] * u[..., :2]
        size = np.sqrt((tried * tried).sum(axis=-1)) + 1e-200
        along = tried / size[..., None]
        way = np.maximum(-(along * u[..., :2]).sum(axis=-1), 0.0)
        gap = contact.gap + u[..., 2] + contact.floor * force[..., 2]
        gap -= contact.push * way
        pressed = force[..., 2] - self.normal * gap
        bound = contact.friction * np.maximum(pressed, 0.0)
        on = pressed > 0
        sticks = on & (size <= bound)
        slides = on & ~sticks
        wrong = force.copy()
        wrong[..., 2] = np.where(on, self.normal * gap, force[..., 2])
        limit = np.where(slides, bound, 0.0)[..., None] * along
        wrong[..., :2] -= np.where(sticks[..., None], tried, limit)
        pull = (np.swapaxes(contact.reach, 2, 3) @ _flat(force)[..., None]).sum(axis=1)
        rest = (pull - contact.inertia @ twist[..., None])[..., 0] + contact.wrench
        off = np.abs(wrong)
        ways = off[..., :2].max(axis=-1) / np.where(sticks, WAY * self.tangent, FORCE)
        gaps = off[..., 2] / np.where(on, WAY * self.normal, FORCE)
        rubbing = np.sqrt((force[..., :2] ** 2).sum(axis=-1))
        beyond = rubbing - contact.friction * np.maximum(force[..., 2], 0.0)
        law = np.maximum(np.maximum(ways, gaps), beyond / FORCE)
        turned = np.abs(rest[:, 3:]).max(axis=1) / ARM
        balance = np.maximum(np.abs(rest[:, :3]).max(axis=1), turned) / FORCE
        error = np.maximum(law.max(axis=(1, 2)), balance)
        closes = np.ones_like(force)
        closes[..., :2] = (contact.push * (way > 0))[..., None] * along
        part = bound / size
        return _State(wrong, rest, error, sticks, slides, ~on, along, part, closes)


def _flat(force: Array) -> Array:
    """Forces of all points of a foot in a row, (B, F, n)."""
    return force.reshape(*force.shape[:2], -1)


def _step(
    contact: Contact, law: _Law, state: _State, compliance: Array
) -> tuple[Array, Array]:
    """Newton's step of the twist, (B, 6), and of the forces, (B, F, n).

    A df + Q du = -wrong with du = G dxi + D df; every foot is eliminated on its own.
    """
    A, Q = _derivatives(contact, law, state)
    each = range(contact.gap.shape[-1])
    QD, QG = blocks(Q, compliance), blocks(Q, contact.reach)
    block = QD.reshape(*QD.shape[:2], len(each), 3, len(each), 3)
    block[:, :, each, :, each] += np.moveaxis(A, 2, 0)
    P = np.linalg.inv(QD)
    PQG, PF = P @ QG, (P @ _flat(state.wrong)[..., None])
    GT = np.swapaxes(contact.reach, 2, 3)
    K = (GT @ PQG).sum(axis=1) + contact.inertia
    K[:, range(6), range(6)] += EASE
    dx = np.linalg.solve(K, state.unbalanced[..., None] - (GT @ PF).sum(axis=1))
    return dx[..., 0], (-PF - PQG @ dx[:, None])[..., 0]


def blocks(Q: Array, other: Array) -> Array:
    """Blocks (B, F, K, 3, 3) on the diagonal times matrices (B, F, n, m)."""
    rows = other.reshape(*other.shape[:2], -1, 3, other.shape[3])
    return (Q @ rows).reshape(other.shape)


def _derivatives(contact: Contact, law: _Law, state: _State) -> tuple[Array, Array]:
    """Derivatives of the function by forces and by motions, (B, F, K, 3, 3) each."""
    shape = (*state.lifted.shape, 3, 3)
    A, Q = np.zeros(shape), np.zeros(shape)
    A[..., 2, 2] = A[..., 0, 0] = A[..., 1, 1] = state.lifted
    by_gap = law.normal[..., None] * state.closes
    Q[..., 2, :] = np.where(state.lifted[..., None], 0.0, by_gap)
    Q[..., 0, 0] = Q[..., 1, 1] = np.where(state.sticks, law.tangent, 0.0)
    if state.slides.any():
        e, slides = state.along, state.slides[..., None, None]
        turn = state.share[..., None, None] * (
            np.eye(2) - e[..., :, None] * e[..., None, :]
        )
        A[..., :2, :2] += np.where(slides, np.eye(2) - turn, 0.0)
        Q[..., :2, :2] += np.where(slides, turn, 0.0) * law.tangent[..., None, None]
        cone = np.where(state.slides, contact.friction, 0.0)[..., None] * e
        A[..., :2, 2] -= cone
        Q[..., :2, :] += cone[..., None] * by_gap[..., None, :]
    return A, Q
