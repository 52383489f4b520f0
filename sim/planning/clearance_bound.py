"""A lower bound on the clearance along the predicted motion of body and legs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner import Array, BoundError
from planner.planning import Slack
from planner.support import point
from sim.obstacles.clearance import Surroundings
from sim.planning.forecast import ForeseenStretch
from sim.preparation.setup import Setup

NOMINAL_SAMPLES = 400  # of the nominal path, spread over its segments


@dataclass(frozen=True)
class ClearanceBound:
    """The robot's outline keeps a least distance from all obstacles [m]."""

    surroundings: Surroundings
    least: float

    def slack(self, setup: Setup, stages: Sequence[ForeseenStretch]) -> Slack:
        """Clearance of the swept outline, compared with that of the nominal path."""
        standing = self._standing(setup)
        walking = np.full(setup.scenario.segments, np.inf)
        for stage in stages:
            rows, clearance = self._swept(stage)
            np.minimum.at(walking, stage.segment(rows), clearance)
        room, left = standing - self.least, walking - self.least
        return Slack("min_clearance", self.least, room, left, unit="m")

    def least_of(self, stage: ForeseenStretch) -> float:
        """Least clearance of a stretch of motion [m]."""
        return float(self._swept(stage)[1].min())

    def _standing(self, setup: Setup) -> Array:
        """Clearance along the nominal path on any stratum, shape (segments,) [m]."""
        segments = setup.scenario.segments
        samples = 1 + -(-NOMINAL_SAMPLES // segments)
        inner = np.arange(segments)[:, None] + np.linspace(0, 1, samples)
        poses = setup.scenario.path.curve.at(inner.ravel() / segments)
        least = np.full(len(poses), np.inf)
        for stratum, raised in setup.raised.items():
            qpos = self.surroundings.postures(poses, raised)
            clearance = self.surroundings.clearances(qpos).least
            worst = int(clearance.argmin())
            if clearance[worst] <= self.least:
                raise self._refusal(
                    poses[worst], stratum, qpos[worst], clearance[worst]
                )
            least = np.minimum(least, clearance)
        return least.reshape(segments, samples).min(axis=1)

    def _refusal(
        self, pose: Array, stratum: str, qpos: Array, clearance: float
    ) -> BoundError:
        part, obstacle = self.surroundings.nearest(qpos)
        missing = 1e3 * (self.least - clearance)
        return BoundError(
            f"the nominal path itself, standing on S{stratum}, has {part} "
            f"{1e3 * clearance:.1f} mm from obstacle {obstacle} at {point(pose)}, "
            f"where more than {1e3 * self.least:.1f} mm are required; make "
            f"{missing:.1f} mm more room there, or lower min_clearance"
        )

    def _swept(self, stage: ForeseenStretch) -> tuple[Array, Array]:
        """Rows, and a lower bound on the clearance after each of them, (T,) [m]."""
        rows = stage.rows
        clearance = self._between(stage, np.stack([rows[:-1], rows[1:]], axis=1))
        return rows[:-1], clearance

    def _between(self, stage: ForeseenStretch, pairs: Array) -> Array:
        """A lower bound of the clearance between pairs of rows, shape (K, 2).

        Exact where it is below `least`; intervals are halved until that is decided.
        """
        found = self.surroundings.clearances(
            self.surroundings.outline.configurations(
                *stage.configurations(pairs.ravel())
            )
        )
        seen = found.least.reshape(-1, 2).min(axis=1)
        bound = np.minimum(seen, found.bound[::2])
        far = np.diff(pairs)[:, 0] > 1
        open_ = far & (bound < self.least) & (seen >= self.least)
        if open_.any():
            middle = pairs[open_].mean(axis=1).astype(int)
            first, last = pairs[open_].T
            halves = np.concatenate(
                [np.stack([first, middle], axis=1), np.stack([middle, last], axis=1)]
            )
            bound[open_] = self._between(stage, halves).reshape(2, -1).min(axis=0)
        return np.where(seen < self.least, seen, bound)
