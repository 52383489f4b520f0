"""Body twist and loads on more than three feet, which statics alone does not determine.

There the loads depend on the compliance of floor and servos, on friction, which bends
the legs, and on sliding, which lifts the feet. For a given twist they solve linear
equations; the twist is the one that balances friction, which is smoothed near rest less
and less. For three feet `contact.dissipation` is exact and faster.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import mujoco
import numpy as np

from models.contact.dissipation import foot_jacobians
from models.contact.kinematics import Kinematics, Stance
from models.description.actuators import actuators_driving
from models.description.robot import Robot
from models.errors import message
from planner import Array


@dataclass(frozen=True, eq=False)
class Ground:
    """Springs under the feet, and the effect of sliding on them.

    Example:
        >>> import numpy as np
        >>> from models import Ground
        >>> Ground(np.full(6, 1e-6), np.full(6, 1e3), friction=1.0, weight=12.5).push
        0.0
    """

    contact: Array  # compliance of floor and foot, (F,) [m/N]
    servo: Array  # stiffness of the lift joint, (F,) [N m/rad]
    friction: float  # where feet differ, that of the roughest
    weight: float  # of the robot [N]
    # Sliding pushes a contact apart by friction * push * speed: a property of the
    # engine's soft contacts, not of Coulomb's law.
    push: float = 0.0  # [s]
    frictions: tuple[float, ...] = ()  # of every foot, where they are read

    def __post_init__(self) -> None:
        springs = *self.contact, *self.servo, self.friction, self.weight, self.push
        if not (all(x >= 0 for x in springs) and 0 < self.weight < np.inf):
            raise ValueError(message("no_ground", ground=self))

    @property
    def shares(self) -> Array:
        """Friction of every foot over that of the roughest, (F,)."""
        rubbing = np.array(self.frictions or (1.0,) * len(self.contact))
        return rubbing / max(float(rubbing.max()), 1e-300)

    def under(self, feet: Array) -> "Ground":
        """The ground under some of the feet, (F,), bool."""
        own = tuple(np.array(self.frictions)[feet]) if self.frictions else ()
        most, springs = max(own, default=self.friction), self.contact[feet]
        return Ground(springs, self.servo[feet], most, self.weight, self.push, own)

    @classmethod
    def of(cls, robot: Robot, model: mujoco.MjModel) -> "Ground":
        """The ground in a world with robot, floor and servos, at keyframe `start`."""
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
        height = robot.root_address_in(model) + 2
        rounded = 1e-5 * max(0.1, data.qpos[height])  # [m], and more, so that all touch
        data.qpos[height] -= np.ptp(Kinematics(robot).standing.height) + rounded
        mujoco.mj_forward(model, data)
        springs, frictions = [], []
        for leg in robot.leg_cards:
            geoms = {model.geom(name).id for name in leg.foot}
            own = [contact for contact in data.contact if geoms & {*contact.geom}]
            rows = [contact.efc_address for contact in own]
            stiffness, damping, impedance, _ = np.transpose(data.efc_KBIP[rows])
            spring = float((stiffness * impedance / data.efc_R[rows]).sum())
            springs.append((spring, float((damping / (stiffness * impedance)).mean())))
            frictions.append(float(np.mean([contact.friction[0] for contact in own])))
        lifts = actuators_driving(model, robot.lift_joints)
        stiffnesses, pushes = np.transpose(springs)
        return cls(
            contact=1 / stiffnesses,
            servo=model.actuator_gainprm[lifts, 0],
            friction=max(frictions),
            weight=robot.weight_in(model),
            push=float(pushes.mean()),
            frictions=tuple(frictions),
        )


_SMOOTHINGS = (1.0, 0.1, 0.01, 1e-3, 1e-4)  # of the fastest rate
_CAREFUL = tuple(10.0 ** (-k / 4) for k in range(17))  # where leaps by tens fail
_BALANCED = 1e-9  # of the weight
_LEAST_COMPLIANCE = 0.1  # of a leg's own, where friction would jam it


def sliding_twist(
    stance: Stance,
    rates: Array,
    ground: Ground,
    speed: float = 0.0,
    grip: Array | None = None,
) -> tuple[Array, Array]:
    """The twist (N, 3) at which friction balances, and the feet's shares of the weight.

    Those and the velocities of the feet relative to the body have shape (N, F) and
    (N, F, 2). The speed is what a rate of 1 stands for when sliding pushes feet apart;
    0 leaves that out, as Coulomb's law does. Without a speed friction may jam a leg, at
    one in fifty poses of a hexapod, and then the twist is the closest to balance found.
    Ellipses of the feet's friction, as in `contact.dissipation`, have shape
    (N, F, 2, 2).
    """
    fastest = np.linalg.norm(rates, axis=-1).max(axis=-1)
    unit = np.where(fastest > 0, fastest, 1.0)[:, None]
    reach = float(np.linalg.norm(stance.feet, axis=-1).max())
    feet, center = stance.feet / reach, stance.center_of_mass / reach
    balance = _Balance(
        ground=ground,
        rates=rates / unit[..., None],
        speed=speed * unit,
        J=foot_jacobians(feet),
        arms=np.concatenate([np.ones((*feet.shape[:-1], 1)), feet], axis=-1),
        moments=np.concatenate([np.ones((len(feet), 1)), center], axis=-1),
        gives=stance.gives,
        grip=grip,
    )
    xi = balance.follow(_SMOOTHINGS)
    rest = np.abs(balance.force(xi, _SMOOTHINGS[-1])).max(axis=-1)
    if len(astray := np.flatnonzero(rest > _BALANCED)):
        xi[astray] = balance.take(astray).follow(_CAREFUL)
    loads, _ = balance.loads(xi, _SMOOTHINGS[-1])
    return xi * unit / np.array([1.0, 1.0, reach]), loads


@dataclass(frozen=True, eq=False, slots=True)
class _Balance:
    """Friction on all feet; units are the fastest rate, the weight and the reach."""

    ground: Ground
    rates: Array  # (N, F, 2)
    speed: Array  # that a rate of 1 stands for, (N, 1) [m/s]
    J: Array  # of the feet's velocities by the twist, (N, F, 2, 3)
    arms: Array  # 1, x, y of each foot, (N, F, 3)
    moments: Array  # 1, x, y of the centre of mass, (N, 3)
    gives: Array  # of the soles by the lift joints, (N, F, 3) [m/rad]
    grip: Array | None

    def take(self, rows: Array) -> "_Balance":
        """Some of the configurations."""
        arrays = ((f.name, getattr(self, f.name)) for f in fields(self)[1:])
        return replace(self, **{n: a[rows] for n, a in arrays if a is not None})

    def follow(self, smoothings: Sequence[float]) -> Array:
        """Twists for friction smoothed less and less, (N, 3), by Newton's method."""
        xi = np.zeros((len(self.J), 3))
        for smoothing in smoothings:
            rows, part = np.arange(len(xi)), self
            for _ in range(12):  # steps of Newton's method
                rest = part.force(xi[rows], smoothing)
                left = np.flatnonzero(np.abs(rest).max(axis=-1) > _BALANCED)
                if not len(left):
                    break
                if len(left) < len(rows):
                    rows, part, rest = rows[left], part.take(left), rest[left]
                xi[rows] += part._step(xi[rows], rest, smoothing)
        return xi

    def _step(self, xi: Array, rest: Array, smoothing: float) -> Array:
        """Newton's step, shortened where it does not bring the force closer to zero."""
        d = 1e-5 * smoothing
        ahead = [self.force(xi + d * axis, smoothing) for axis in np.eye(3)]
        slope = np.moveaxis((np.array(ahead) - rest) / d, 0, -1) + 1e-9 * np.eye(3)
        step = -np.linalg.solve(slope, rest[..., None])[..., 0]
        longest = np.abs(step).max(axis=-1, keepdims=True)
        step *= np.minimum(1.0, 0.5 / np.maximum(longest, 1e-300))
        before = np.linalg.norm(rest, axis=-1)
        for _ in range(6):  # halvings of a step
            worse = np.linalg.norm(self.force(xi + step, smoothing), axis=-1) >= before
            if not worse.any():
                break
            step = np.where(worse[:, None], step / 2, step)
        return step

    def force(self, xi: Array, smoothing: float) -> Array:
        """Sum of friction forces and their moment, shape (N, 3)."""
        loads, direction = self.loads(xi, smoothing)
        dragging = (loads * self.ground.shares)[..., None] * direction  # (N, F, 2)
        return (dragging[..., None, :] @ self.J)[..., 0, :].sum(axis=-2)

    def loads(self, xi: Array, smoothing: float) -> tuple[Array, Array]:
        """Share of the weight on each foot, and the direction in which it slides.

        A leg sinks by (upward N - sideways . friction) upward / servo + contact N; the
        sliding pushes it up, and the body stays plane.
        """
        ground, upward = self.ground, self.gives[..., 2]
        friction = ground.friction * ground.shares
        w = self.rates + (self.J @ xi[:, None, :, None])[..., 0]
        if self.grip is not None:
            w = (self.grip @ w[..., None])[..., 0]
        speed = np.sqrt((w**2).sum(axis=-1) + smoothing**2)
        direction = w / speed[..., None]
        if self.grip is not None:
            direction = (self.grip @ direction[..., None])[..., 0]
        dragged = friction * (self.gives[..., :2] * direction).sum(axis=-1)
        own = upward**2 / ground.servo + ground.contact
        compliance = upward * (upward - dragged) / ground.servo + ground.contact
        k = 1 / np.maximum(compliance, _LEAST_COMPLIANCE * own) / ground.weight
        pushed = k * friction * ground.push * self.speed * speed
        standing = np.ones(k.shape, dtype=bool)
        for _ in range(k.shape[-1] - 2):  # on fewer than three feet, no body does
            loads = self._springs(np.where(standing, [k, pushed], 0))
            pulled = standing & (loads < 0)
            pulled &= (standing & ~pulled).sum(axis=-1, keepdims=True) >= 3
            if not pulled.any():
                break
            standing &= ~pulled
        return np.maximum(loads, 0.0), direction

    def _springs(self, springs: Array) -> Array:
        """Loads of springs under a rigid body, by stiffness and push, (2, N, F)."""
        k, pushed = springs
        turned = np.swapaxes(self.arms, -1, -2)  # (N, 3, F)
        stiffness = turned @ (k[..., None] * self.arms)
        missing = self.moments[..., None] - turned @ pushed[..., None]
        return k * (self.arms @ np.linalg.solve(stiffness, missing))[..., 0] + pushed
