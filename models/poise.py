"""Where a robot stands surely: every foot on the ground bears some of the weight.

Statics on level ground, at given angles of the legs. A foot that bears little lets go
at the slightest shake, so a card may ask for a least share.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.kinematics import Kinematics, Stance
from models.loads import static_loads
from models.robot import Robot

Array = np.ndarray


@dataclass(frozen=True)
class Poised:
    """Loads of a robot's feet with some of them in the air."""

    robot: Robot

    def stands(self, stratum: str, places: Mapping[str, Array]) -> Array:
        """Whether every foot on the ground bears the card's least load.

        Args:
            stratum: Groups on the ground.
            places: Angles of each group by its coordinate `phi_G`, shape (P_G,) [rad].

        Returns:
            For all combinations of places in the order of groups, shape (P_1, ...).
        """
        angles = [places[f"phi_{group}"] for group in self.robot.groups]
        return self.least_load(stratum, angles) >= self.robot.card.least_load

    def least_load(self, stratum: str, angles: list[Array]) -> Array:
        """Smallest share of the weight that a foot on the ground bears.

        Args:
            stratum: Groups on the ground.
            angles: Of each group, shape (P_G,) [rad].

        Returns:
            For all combinations, shape (P_1, ..., P_G); none where the robot would tip.
        """
        feet, center = self._combined(angles)
        on = self.robot.planted(stratum)
        feet, shape = feet[..., on, :], center.shape[:-1]
        if on.sum() == 3:
            return np.asarray(_shares(feet, center).min(axis=-1))
        feet, center = feet.reshape(-1, on.sum(), 2), center.reshape(-1, 2)
        return np.asarray(static_loads(feet, center).min(axis=1).reshape(shape))

    def _combined(self, angles: list[Array]) -> tuple[Array, Array]:
        """Feet (P_1, ..., P_G, F, 2) and centre of mass (P_1, ..., P_G, 2).

        A leg moves its own foot and its own share of the weight, whatever others do.
        """
        groups = len(angles)
        shape = [len(angle) for angle in angles]
        feet = np.empty((*shape, len(self.robot.legs), 2))
        center = np.broadcast_to(self._rest.center_of_mass, (*shape, 2)).copy()
        for g, angle in enumerate(angles):
            alone = np.zeros((len(angle), groups))
            alone[:, g] = angle
            stance = self._kinematics.stance(alone)
            along = [-1 if i == g else 1 for i in range(groups)]
            moved = stance.center_of_mass - self._rest.center_of_mass
            center += moved.reshape(*along, 2)
            own = self.robot.group_of_leg == g
            feet[..., own, :] = stance.feet[:, own].reshape(*along, own.sum(), 2)
        return feet, center

    @cached_property
    def _rest(self) -> Stance:
        return self._kinematics.stance(np.zeros(len(self.robot.groups)))

    @cached_property
    def _kinematics(self) -> Kinematics:
        return Kinematics(self.robot)


def _shares(feet: Array, center: Array) -> Array:
    """Share of the weight on each of three feet, negative outside, shape (..., 3).

    The weight's barycentric coordinates: the triangle that it makes with the other two
    feet over the whole one.
    """
    spokes = feet - center[..., None, :]
    after = np.roll(spokes, -1, axis=-2)
    areas = spokes[..., 0] * after[..., 1] - spokes[..., 1] * after[..., 0]
    opposite = np.roll(areas, -1, axis=-1)
    return np.asarray(opposite / areas.sum(axis=-1, keepdims=True))
