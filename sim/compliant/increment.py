"""One increment of a walk: joints as springs about their commands, then equilibrium.

Over an increment h from commands c0 to c1 a joint is a spring with its servo's damping,
integrated exactly:

    q1 = free + torque / k,    tau = damping / stiffness,  e = exp(-h / tau),
    k = stiffness / (1 - e),   r = (c1 - c0) / h,
    free = e q + c1 - tau r - e (c0 - tau r)

The levers of feet and joints are taken in the middle of the increment, heights at its
begin. The robot's momentum as one body is part of the balance: it is hardly felt, but
makes the equilibrium unique.
"""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from planner import Array
from sim.compliant.anatomy import ABSENT, Anatomy, Robots
from sim.compliant.equilibrium import (
    Contact,
    Found,
    Give,
    Lanes,
    blocks,
    equilibrium,
    motion,
    torque_of,
)
from sim.compliant.places import UP, Places, Skeleton, cross, rotation, skew

LEAST = 1e-9  # [s]; of a servo's time, where it has no damping
STOP_STIFFNESS = 5e3  # [N m/rad]; stiffness at the ends of backlash
OVERLOADED = 0.1  # [rad/(N m)]; how far a servo gives way beyond its largest torque
ON_EDGE = 1e-10  # [rad]; joints as close to an end of backlash are on either side
LOADED = 0.01  # of the weight, from which on a foot stands


@dataclass(frozen=True, eq=False)
class State(Lanes):
    """The lanes' robots at a moment."""

    place: Array  # of the root, (B, 3) [m]
    turned: Array  # its rotation, (B, 3, 3)
    angles: Array  # of the servos, (B, F, J) [rad]
    loose: Array  # of what is loose behind them, (B, F, J) [rad]
    force: Array  # of the floor on every point, (B, F, K, 3) [N]
    twist: Array  # speed of the body, (B, 6) [m/s], [rad/s]
    bent: Array  # joints off their commands by loads, (B, F, J) [rad]
    gap: Array  # of every point above the floor, (B, F, K) [m]

    def put(self, which: Array, new: "State") -> "State":
        """The same with other states in the lanes that are marked, (B,), bool."""

        def mixed(old: Array, value: Array) -> Array:
            return np.where(which.reshape(-1, *(1,) * (old.ndim - 1)), value, old)

        return State(*map(mixed, vars(self).values(), vars(new).values()))


class Done(NamedTuple):
    """What increments came to."""

    state: State
    slip: Array  # of every foot, (B, F) [m]
    center: Array  # centre of mass about the root, (B, 3) [m]
    arm: Array  # the feet's points about the root, (B, F, K, 3) [m]
    torque: Array  # of every servo, (B, F, J) [N m]
    holds: Array  # whether it is an equilibrium, (B,), bool


@dataclass(frozen=True, eq=False)
class Mechanics:
    """Robots of one anatomy on a floor at a height [m]."""

    anatomy: Anatomy
    height: float = 0.0
    skeleton: Skeleton = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "skeleton", Skeleton(self.anatomy))

    def standing(self, robots: Robots, command: Array, yaw: Array) -> Done:
        """Robots (B,) held by commands (B, F, J), their lowest points on the floor."""
        angles = command + robots.offset
        turned = rotation(yaw[:, None] * UP) @ self.anatomy.turned
        places = self.skeleton.places(robots, turned, angles)
        low, touches = places.arm[..., 2], robots.radius > ABSENT
        place = np.zeros((len(angles), 3))
        place[:, 2] = self.height - low.min(axis=(1, 2))
        force = np.zeros(places.arm.shape)
        force[..., 2] = touches * (robots.weight / touches.sum((1, 2)))[:, None, None]
        still, none = np.zeros((len(angles), 6)), np.zeros_like(angles)
        gap = place[:, 2, None, None] + low - self.height
        state = State(place, turned, angles, none, force, still, none, gap)
        slip = np.zeros(low.shape[:2])
        held = np.ones(len(angles), dtype=bool)
        return Done(state, slip, places.center, places.arm, none, held)

    def increment(
        self, robots: Robots, state: State, begin: Array, end: Array, h: Array
    ) -> Done:
        """Where commands from (B, F, J) to (B, F, J) lead in times (B,) [s]."""
        spring = _spring(robots, state, begin, end, h)
        coast = state.twist * h[:, None]
        middle = rotation(coast[:, 3:] / 2) @ state.turned
        guess = 0.5 * (state.angles + spring.free + spring.share * state.bent)
        places = self.skeleton.places(robots, middle, guess + state.loose)
        heavy = places.weight_torque(self.anatomy, robots.gravity)
        rest = spring.free + spring.yield_ * heavy
        weight = robots.mass[:, None] * robots.gravity
        inertia = self._inertia(robots, places, middle) / (h**2)[:, None, None]
        wrench = np.concatenate([weight, cross(places.center, weight)], axis=1)
        contact = Contact(
            reach=places.reach,
            lever=places.lever,
            yield_=spring.yield_,
            drift=(places.lever @ (rest - state.angles)[..., None])[..., 0],
            gap=state.gap,
            floor=robots.floor,
            friction=robots.friction,
            wrench=wrench + (inertia @ coast[..., None])[..., 0],
            inertia=inertia,
            push=robots.friction * (robots.push / h)[:, None, None],
            side=_side(robots, state.loose),
            number=np.arange(len(h)),
        )
        give = _give(robots, state, spring, heavy, h)
        found = _solved(contact, coast, state.force, give, _grip(robots, places))
        pulled = torque_of(places.lever, found.force)
        if give is None:
            shift, loose = contact.yield_ * pulled, state.loose
        else:
            shift = give(replace(contact, side=None), pulled)[0]
            loose = _loosened(robots, state, pulled + heavy, h)[0]
        u = motion(contact, found.twist, found.force, shift)
        angles = rest + shift - (loose - state.loose)
        new = State(
            place=state.place + found.twist[:, :3],
            turned=rotation(found.twist[:, 3:]) @ state.turned,
            angles=angles,
            loose=loose,
            force=found.force,
            twist=found.twist / h[:, None],
            bent=(pulled + heavy) / robots.stiffness,
            gap=np.empty_like(state.gap),
        )
        after = self.skeleton.places(robots, new.turned, angles + loose)
        new.gap[:] = new.place[:, 2, None, None] + after.arm[..., 2] - self.height
        slip = _slip(robots, state.force, found.force, u)
        return Done(new, slip, after.center, after.arm, -(pulled + heavy), found.holds)

    def _inertia(self, robots: Robots, places: Places, turned: Array) -> Array:
        """The whole robot's about its root, as one rigid body, (B, 6, 6)."""
        M = np.zeros((len(robots.mass), 6, 6))
        mass, K = robots.mass[:, None, None], skew(places.center)
        M[:, :3, :3] = mass * np.eye(3)
        M[:, :3, 3:], M[:, 3:, :3] = -mass * K, mass * K
        own = turned @ self.anatomy.inertia @ np.swapaxes(turned, 1, 2)
        M[:, 3:, 3:] = own - mass * (K @ K)
        return M


def _grip(robots: Robots, places: Places) -> Array | None:
    """Ellipses of friction along legs and across, (B, F, 3, 3); None where discs."""
    if (robots.across == 1).all():
        return None
    x, y, _ = np.moveaxis(places.arm.mean(axis=2) - places.anchor[:, :, 0], -1, 0)
    side = np.stack([-y, x, 0 * x], axis=-1) / np.hypot(x, y)[..., None]
    more = (robots.across - 1)[..., None, None]
    return np.eye(3) + more * side[..., :, None] * side[..., None, :]


def _solved(
    contact: Contact, twist: Array, force: Array, give: Give | None, grip: Array | None
) -> Found:
    """The equilibrium; ellipses D of friction become discs for D u and D^-1 f."""
    if grip is None:
        return equilibrium(contact, twist, force, give)
    D = grip[:, :, None]
    turned = {name: blocks(D, getattr(contact, name)) for name in ("reach", "lever")}
    drift = blocks(D, contact.drift[..., None])[..., 0]
    eased = np.linalg.solve(D, force[..., None])[..., 0]
    found = equilibrium(replace(contact, drift=drift, **turned), twist, eased, give)
    return found._replace(force=(D @ found.force[..., None])[..., 0])


class _Spring(NamedTuple):
    """The joints over an increment, (B, F, J) each."""

    free: Array  # where they come to without torque [rad]
    yield_: Array  # how far a torque turns them [rad/(N m)]
    share: Array  # of the way to rest that they come


def _spring(
    robots: Robots, state: State, begin: Array, end: Array, h: Array
) -> _Spring:
    time = h[:, None, None]
    tau = np.maximum(robots.damping / robots.stiffness, LEAST)
    e = np.exp(-time / tau)
    lag = tau * (end - begin) / time
    before = begin + robots.offset - lag
    free = e * (state.angles - before) + end + robots.offset - lag
    return _Spring(free, (1 - e) / robots.stiffness, 1 - e)


def _give(
    robots: Robots, state: State, spring: _Spring, heavy: Array, h: Array
) -> Give | None:
    """The joints' law where they have slack or a largest torque; None where not."""
    if not robots.slack.any() and not np.isfinite(robots.torque).any():
        return None

    def law(contact: Contact, torque: Array) -> tuple[Array, Array, Array]:
        lanes, side = np.asarray(contact.number), contact.side
        own = robots.take(lanes)
        whole = torque + heavy[lanes]
        loose, slope = _loosened(own, state.take(lanes), whole, h[lanes], side)
        over = np.sign(whole) * np.maximum(np.abs(whole) - own.torque, 0.0)
        turned = spring.yield_[lanes] * torque + OVERLOADED * over
        slope = slope + spring.yield_[lanes] + OVERLOADED * (over != 0)
        return turned + loose - state.loose[lanes], slope, _side(own, loose, side)

    return law


def _loosened(
    robots: Robots, state: State, torque: Array, h: Array, side: Array | None = None
) -> tuple[Array, Array]:
    """Angles in the backlash at given stops, else at those they reach; their slope."""
    if not robots.slack.any():
        return state.loose, np.zeros_like(torque)
    end, has = robots.slack / 2, robots.slack > 0
    rubbing = robots.rub / h[:, None, None]
    begin = np.clip(state.loose, -end, end)  # between stops, where only rubbing resists
    inside = np.where(has, begin + torque / rubbing, 0.0)
    side = _side(robots, inside) if side is None else side
    over = torque - (side * end - begin) * rubbing
    loose = np.where(side == 0, inside, side * end + over / STOP_STIFFNESS)
    return loose, has / np.where(side == 0, rubbing, STOP_STIFFNESS)


def _side(robots: Robots, loose: Array, before: Array | None = None) -> Array:
    """The stop at which joints are, -1 or 1, else 0; that of before, where on edge."""
    over = np.abs(loose) - robots.slack / 2
    side = np.sign(loose) * (over > 0)
    return side if before is None else np.where(np.abs(over) < ON_EDGE, before, side)


def _slip(robots: Robots, before: Array, after: Array, moved: Array) -> Array:
    """Slip of every standing foot, (B, F) [m]: of its points on average, by load."""
    size = np.hypot(moved[..., 0], moved[..., 1])
    load = np.maximum(after[..., 2], 0.0)
    whole = load.sum(axis=2)
    share = np.where(whole[..., None] > 0, load / np.maximum(whole, 1e-9)[..., None], 0)
    least = LOADED * robots.weight[:, None]
    stood = np.maximum(before[..., 2], 0.0).sum(axis=2) > least
    return (share * size).sum(axis=2) * (0.5 * ((whole > least) + 0.0 + stood))
