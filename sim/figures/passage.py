"""The passage of Fig. 9 in the paper's units, and the clearance of walks through it.

The robot is `hexapod` on the paper's kinematics, measured in its pivots' distance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from models.morphology import KAPPA, PIVOT
from planner import Array, Path, subdivide
from planner.planning import Slack, recut
from sim.figures.paper import PaperWalk, walk
from sim.obstacles.clearance import Surroundings, surroundings
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

COARSE_SEGMENTS = 24  # the scenario's own; 22 would leave the joint range
LEAST = 0.005 / PIVOT  # clearance to keep [l], as the scenario asks for
SAMPLES = 6  # states looked at a flow


@dataclass(frozen=True)
class Passage:
    """The scenario's passage, and walks through it on the paper's kinematics."""

    around: Surroundings
    path: Path  # in pivots' distances

    def qpos(self, pose: Array, phi: Array) -> Array:
        """The robot's joint positions at states, shape (T, nq)."""
        swing = phi / KAPPA  # the robot's legs turn farther for the same way
        metres = pose * (PIVOT, PIVOT, 1.0)
        return self.around.outline.configurations(metres, swing, np.zeros_like(phi))

    def clearance(self, pose: Array, phi: Array) -> tuple[Array, Array]:
        """Clearance at states and a lower bound up to each from the one before, [l].

        Args:
            pose: Shape (T, 3), lengths in pivots' distances.
            phi: Angles of the paper's legs, shape (T, 2).
        """
        found = self.around.clearances(self.qpos(pose, phi))
        least = found.least / PIVOT
        bound = np.concatenate([least[:1], found.bound / PIVOT])
        return least, np.minimum(least, bound)

    def through(self, cuts: Array, samples: int = SAMPLES) -> PaperWalk:
        """A walk along the path divided at the cuts, with states for each flow."""
        return walk(recut(self.path, cuts), len(cuts) - 1, samples=samples)

    def slack(self, cuts: Array) -> Slack:
        """Slack of the least clearance along a walk, and along the nominal path."""
        walked = self.through(cuts)
        segment = np.searchsorted(walked.ends, np.arange(len(walked.states)))
        _, bound = self.clearance(walked.states[:, :3], walked.states[:, 3:])
        walking = np.full(len(cuts) - 1, np.inf)
        np.minimum.at(walking, segment, bound)
        s = np.linspace(cuts[:-1], cuts[1:], 9, axis=1)  # (segments, 9)
        poses = self.path.at(s.ravel())
        standing, _ = self.clearance(poses[:, :3], poses[:, 3:])
        standing = standing.reshape(s.shape).min(axis=1)
        return Slack("clearance", LEAST, standing - LEAST, walking - LEAST)

    @cached_property
    def fine(self) -> Array:
        """Cuts of the path that keep the clearance."""
        return subdivide(self.coarse, lambda cuts: [self.slack(cuts)])

    @property
    def coarse(self) -> Array:
        """Cuts of the path to begin with."""
        return np.linspace(0.0, 1.0, COARSE_SEGMENTS + 1)


def passage() -> Passage:
    """The passage of the scenario, path and all, in the paper's units."""
    setup = prepare(load_scenario("corridor"))
    curve, scale = setup.scenario.path.curve, np.array([PIVOT, PIVOT, 1.0])

    def at(s: Array) -> Array:
        return np.pad(curve.at(s) / scale, ((0, 0), (0, 2)))

    return Passage(surroundings(setup), Path(at, curve.corners))
