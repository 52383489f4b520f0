"""Commands of a walk over time: smooth, or held between updates of the servos."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner import Array

SLACK = 1e-9  # [s]; times closer than this are the same


@dataclass(frozen=True, eq=False)
class Commands:
    """A row of commands a physics step, for every joint.

    Row k is applied in step k. Smooth commands come to it at the end of that step;
    held ones keep it until they change, and no increment lasts beyond that.
    """

    rows: Array  # (T, F, J) [rad]
    timestep: float  # [s]
    edges: Array  # times at which increments end, ascending, the last at the end [s]
    held: bool = False

    def over(self, begin: Array, end: Array) -> tuple[Array, Array]:
        """Commands at the beginning and the end of increments, (B, F, J) each."""
        if self.held:
            row = np.floor((begin + SLACK) / self.timestep).astype(int)
            now = self.rows[np.minimum(row, len(self.rows) - 1)]
            return now, now
        return self.at(begin), self.at(end)

    def at(self, time: Array) -> Array:
        """Smooth commands at times (B,), (B, F, J)."""
        steps = np.clip(time / self.timestep, 0.0, len(self.rows))
        whole = np.minimum(steps.astype(int), len(self.rows) - 1)
        part = (steps - whole)[:, None, None]
        return (1 - part) * self.rows[np.maximum(whole - 1, 0)] + part * self.rows[
            whole
        ]

    def next_edge(self, time: Array) -> Array:
        """The first edge after each of some times, (B,) [s]."""
        return self.edges[np.searchsorted(self.edges, time + SLACK)]


def changes(rows: Array, timestep: float) -> Array:
    """Times at which held commands (T, ...) change [s]."""
    flat = rows.reshape(len(rows), -1)
    changed = (np.diff(flat, axis=0) != 0).any(axis=1)
    return (1 + np.flatnonzero(changed)) * timestep
