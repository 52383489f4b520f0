"""Static loads of a robot's feet on level ground, and whether it stands on them.

A card may demand a least share of the weight on every foot on the ground. The paper's
stance on three legs (Fig. 5, Sec. 6) has its bounds in closed form.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from models.contact.kinematics import Kinematics
from models.description.robot import Robot
from planner import Array


def static_loads(feet: Array, center_of_mass: Array) -> Array:
    """Share of the weight on each of the feet in contact, shape (N, F), summing to 1.

    Feet (N, F, 2) and centre of mass (N, 2) are in one frame [m]. Three feet determine
    the forces. On more, a rigid body is taken to stand on equal vertical springs; on
    fewer, the forces balance the weight in the sense of least squares. A foot that
    would have to pull gets none.
    """
    arms = np.concatenate([np.ones((*feet.shape[:-1], 1)), feet], axis=-1)
    target = np.concatenate([np.ones((len(feet), 1)), center_of_mass], axis=-1)
    standing = np.ones(feet.shape[:-1], dtype=bool)
    for _ in range(max(feet.shape[-2] - 2, 1)):
        G = arms * standing[..., None]
        balance = np.einsum("nfi,nfj->nij", G, G)
        sink = np.einsum("nij,nj->ni", np.linalg.pinv(balance), target)
        loads = np.einsum("nfi,ni->nf", G, sink)
        pulled = standing & (loads < -1e-12)  # of the weight; as good as zero
        if not pulled.any():
            break
        standing &= ~pulled
    loads = np.maximum(loads, 0.0)
    return loads / loads.sum(axis=-1, keepdims=True)


@dataclass(frozen=True)
class StaticStability:
    """Loads of a robot's feet with some of them in the air.

    Example:
        >>> from models import StaticStability, load
        >>> rest, best = StaticStability(load("quadruped")).at_rest_and_best()["123"]
        >>> rest < 0 < best  # it tips unless its legs are moved before a hind leg lifts
        True
    """

    robot: Robot

    def stands(self, strata: Sequence[str], places: Mapping[str, Array]) -> Array:
        """Whether every foot on the ground bears the card's least load.

        For S strata and all combinations of places, the angles of each group by its
        coordinate `phi_G` [rad]: shape (S, P_1, ..., P_G).
        """
        angles = [places[f"phi_{group}"] for group in self.robot.groups]
        return self.least_loads(strata, angles) >= self.robot.card.least_load

    def least_loads(self, strata: Sequence[str], angles: Sequence[Array]) -> Array:
        """Smallest share on a foot on the ground, likewise; 0 or less where it tips."""
        feet, center = self._combined(angles)
        standing = map(self.robot.planted, strata)
        return np.stack([least_load(feet[..., on, :], center) for on in standing])

    def at_rest_and_best(self) -> dict[str, tuple[float, float]]:
        """Least share at angle 0, and anywhere, by stratum with feet in the air."""
        card, spans = self.robot.card, self.robot.swing_range.values()
        strata = [name for name in dict.fromkeys(card.gait) if name != card.bottom]
        rest = self.least_loads(strata, [np.zeros(1)] * len(spans))
        anywhere = self.least_loads(strata, [np.array([a, 0.0, b]) for a, b in spans])
        found = zip(strata, rest, anywhere, strict=True)
        return {name: (float(r.max()), float(a.max())) for name, r, a in found}

    def _combined(self, angles: Sequence[Array]) -> tuple[Array, Array]:
        """Feet (P_1, ..., P_G, F, 2) and centre of mass (P_1, ..., P_G, 2).

        Each leg moves only its own foot and its own share of the weight.
        """
        shape = [len(angle) for angle in angles]
        groups = np.arange(len(shape))
        owner = np.repeat(groups, shape)
        alone = np.concatenate(angles)[:, None] * (owner[:, None] == groups)
        stance = self._kinematics.stance(alone)
        middle = self._kinematics.standing.center_of_mass
        moved = stance.center_of_mass - middle
        feet = np.empty((*shape, len(self.robot.legs), 2))
        center = np.broadcast_to(middle, (*shape, 2)).copy()
        for g in groups:
            along = np.where(groups == g, -1, 1)
            own = self.robot.group_of_leg == g
            center += moved[owner == g].reshape(*along, 2)
            placed = stance.feet[owner == g][:, own]
            feet[..., own, :] = placed.reshape(*along, own.sum(), 2)
        return feet, center

    @cached_property
    def _kinematics(self) -> Kinematics:
        return Kinematics(self.robot)


def lift_torques(kinematics: Kinematics, stratum: str, friction: float) -> Array:
    """Torques that lift joints bear as the robot stands on a stratum, (F,) [N m].

    A foot that slides toward its hip or away from it adds friction.
    """
    robot, stance = kinematics.robot, kinematics.standing
    on, loads = robot.planted(stratum), np.zeros(len(robot.legs))
    loads[on] = static_loads(stance.feet[None, on], stance.center_of_mass[None])[0]
    level = np.linalg.norm(stance.gives[:, :2], axis=-1)
    arms = np.abs(stance.gives[:, 2]) + friction * level
    return robot.weight_in(robot.model) * loads * arms


def least_load(feet: Array, center: Array) -> Array:
    """Smallest share of the weight on any of the feet; 0 or less where they tip.

    Feet on the ground have shape (..., F, 2), the centre of mass (..., 2), the shares
    (...). On three feet they are the weight's barycentric coordinates: the triangle
    that it makes with the other two feet over the whole one.
    """
    if feet.shape[-2] != 3:
        rows = static_loads(feet.reshape(-1, *feet.shape[-2:]), center.reshape(-1, 2))
        return rows.min(axis=-1).reshape(center.shape[:-1])
    spokes = feet - center[..., None, :]
    after = np.roll(spokes, -1, axis=-2)
    areas = spokes[..., 0] * after[..., 1] - spokes[..., 1] * after[..., 0]
    opposite, whole = np.roll(areas, -1, axis=-1), areas.sum(axis=-1, keepdims=True)
    on_a_line = np.zeros_like(areas)
    return np.divide(opposite, whole, out=on_a_line, where=whole != 0).min(axis=-1)


_ROWS = np.array([0.5, 0.0, -0.5])  # front, middle, rear [body lengths]
_SIDES = {1: np.array([1.0, -1.0, 1.0]), 2: np.array([-1.0, 1.0, -1.0])}


@dataclass(frozen=True)
class PaperStance:
    """Lengths of the paper's hexapod, in any one unit.

    Attributes:
        body_length: Distance from the front hips to the rear hips, l_b.
        leg_length: Distance from hip to foot, l.
        half_width: Distance of the hips from the middle line of the body.

    Raises:
        ValueError: A length is not positive.

    Example:
        >>> from models import PaperStance
        >>> low, high = PaperStance(3.0, leg_length=1.0, half_width=0.5).bounds(0.0)
        >>> float(low), float(high)
        (0.75, 2.25)
    """

    body_length: float
    leg_length: float
    half_width: float

    def __post_init__(self) -> None:
        for name in ("body_length", "leg_length", "half_width"):
            if not (value := getattr(self, name)) > 0:
                raise ValueError(f"{name} must be positive, got {value}")

    def hips(self, tripod: int) -> Array:
        """Hips of tripod 1 or 2, x forward from the body's middle, shape (3, 2)."""
        x, y = self.body_length * _ROWS, self.half_width * _SIDES[tripod]
        return np.stack([x, y], axis=-1)

    def feet(self, tripod: int, phi: ArrayLike) -> Array:
        """Feet of tripod 1 or 2 at angles of shape (...), shape (..., 3, 2)."""
        phi = np.asarray(phi, dtype=float)[..., None]
        reach = np.broadcast_arrays(-np.sin(phi), np.cos(phi) * _SIDES[tripod])
        return self.hips(tripod) + self.leg_length * np.stack(reach, axis=-1)

    def bounds(self, phi: ArrayLike) -> tuple[Array, Array]:
        """Least and largest b that a loaded tripod at phi carries without tipping.

        Both bounds hold for either tripod, within a quarter turn: l_b/4 + l sin(phi) <=
        b <= 3 l_b/4 + l sin(phi). Sec. 6 prints one for each.
        """
        swept = self.leg_length * np.sin(np.asarray(phi, dtype=float))
        return self.body_length / 4 + swept, 3 * self.body_length / 4 + swept

    def margin_along_axis(self, phi: ArrayLike, b: ArrayLike) -> Array:
        """Distance from the weight to the nearer bound along x, positive inside.

        The stability margin, to the nearest side, is shorter: the sides are oblique.
        """
        low, high = self.bounds(phi)
        return np.minimum(np.subtract(b, low), np.subtract(high, b))
