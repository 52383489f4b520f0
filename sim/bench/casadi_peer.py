"""CasADi and IPOPT as a peer: strokes optimised by multiple shooting.

Poses between strokes are unknowns like the strokes' angles, so that a poor first guess
does not distort the whole path. The best result of many guesses stands for the optimum.
This needs the extra `peers`.
"""

from __future__ import annotations

from typing import Any

import casadi
import numpy as np

from planner import Array
from sim.bench.arcs import START, Stroke, Task, joined, travel

STROKES = 8  # of which optima use fewer, but for straight pieces
GUESSES = 40
MET = 1e-6  # of the arcs' radius
UNUSED = 1e-6  # [rad], below which the interior point leaves what it does not need
QUIET: dict[str, Any] = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
}


class MultipleShooting:
    """The least swing travel of a task as a nonlinear program, compiled.

    Args:
        task: What to reach.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._sides = [1, -1] * (STROKES // 2)
        forward, back = (casadi.SX.sym(name, STROKES) for name in ("forward", "back"))
        poses = casadi.SX.sym("poses", 3, STROKES)
        gaps = [poses[:, -1] - casadi.DM(task.goal)]
        before: Any = casadi.DM(START)
        for k, side in enumerate(self._sides):
            after = task.arcs.after(before, side, forward[k] - back[k], casadi)
            before = poses[:, k]
            gaps.append(casadi.vertcat(*after) - before)
        program = {
            "x": casadi.vertcat(forward, back, casadi.vec(poses)),
            "f": casadi.sum1(forward + back),
            "g": casadi.vertcat(*gaps),
        }
        self._solver = casadi.nlpsol("shooting", "ipopt", program, QUIET)
        free = np.full(3 * STROKES, -np.inf)
        self._lowest = np.concatenate([np.zeros(2 * STROKES), free])

    def once(self, angles: Array | None = None) -> list[Stroke]:
        """Strokes from one guess, by default a tenth of a radian each."""
        angles = np.full(STROKES, 0.1) if angles is None else angles
        poses = self._task.poses(list(zip(self._sides, angles.tolist(), strict=True)))
        guess = [np.maximum(angles, 0), np.maximum(-angles, 0), poses[1:].ravel()]
        found = self._solver(x0=np.concatenate(guess), lbx=self._lowest, lbg=0, ubg=0)
        forward, back = np.array(found["x"])[: 2 * STROKES, 0].reshape(2, STROKES)
        swings = (forward - back).tolist()
        pairs = zip(self._sides, swings, strict=True)
        return joined([(side, swing) for side, swing in pairs if abs(swing) > UNUSED])

    def best(self) -> list[Stroke]:
        """The shortest of many that meet the goal."""
        rng = np.random.default_rng(0)
        found = [self.once(rng.normal(size=STROKES)) for _ in range(GUESSES)]
        near = MET * self._task.arcs.radius
        return min((s for s in found if self._task.error(s) < near), key=travel)
