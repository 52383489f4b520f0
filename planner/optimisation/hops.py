"""Plans changed at random, from which a search hops to other local optima."""

from __future__ import annotations

import numpy as np

from planner.optimisation.task import Solution, Task

KICK = 0.3  # of an inserted stroke, relative to the longest one of the plan


def changed(task: Task, plan: Solution, rng: np.random.Generator) -> Solution:
    """A guess with a turn of the cycle moved, inserted or removed.

    The stages that stay keep their strokes, recoveries and states. The solver closes
    the gaps, so that most of the plan is left as it was.
    """
    turn, order = len(task.stages), list(range(len(plan.strokes)))
    change = rng.choice(["move", "insert", "remove"])
    if change == "insert" or len(order) <= turn:
        k = int(rng.integers(len(order) + 1))
        order[k:k] = [max(k - 1, 0)] * turn
        strokes = plan.strokes[order]
        strokes[k : k + turn] = KICK * np.abs(strokes).max() * rng.normal(size=turn)
        return plan.rearranged(order, strokes)
    k = int(rng.integers(len(order) - turn + 1))
    moved = order[k : k + turn]
    del order[k : k + turn]
    if change == "move":
        k = int(rng.integers(len(order) + 1))
        order[k:k] = moved
    return plan.rearranged(order, plan.strokes[order])
