"""A cupboard is walked sideways across a room: a system of one's own in Python.

A cupboard that stands on two feet can be turned about either of them. Each field below
gives the rates of the coordinates: the position and heading of the cupboard, and how
far each foot is turned under it. A foot that is off the floor can be turned back
freely, which is what makes the walk repeatable. Nothing else is needed to plan: no
legs, no masses and no simulator. `steer` plans again from where each plan ended until
the goal is met; by then the cupboard has moved one metre sideways and every foot is
straight.

Example:
    python examples/system_of_your_own.py --width 0.5
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
import sympy as sp

from planner import Execution, StratifiedSystem, extend, gait_controllability, steer


def main(arguments: Sequence[str] | None = None) -> None:
    """Describe the system, judge its gait, and walk it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--width", type=float, default=0.6, help="between feet [m]")
    b = parser.parse_args(arguments).width / 2

    state = x, y, theta, phi_1, phi_2 = sp.symbols("x y theta phi_1 phi_2")
    ahead = [b * sp.cos(theta), b * sp.sin(theta)]
    strata = {
        "12": {},  # on both feet nothing moves
        "1": {"pivot_1": [*ahead, 1, 1, 0], "reset_2": [0, 0, 0, 0, 1]},
        "2": {"pivot_2": [*ahead, -1, 0, 1], "reset_1": [0, 0, 0, 1, 0]},
    }
    system = StratifiedSystem(state, strata, bottom="12")
    print(gait_controllability(system, ("12", "1", "12", "2", "12"), [0.0] * 5))

    elements = ("pivot_1", "pivot_2", "reset_1", "reset_2", "[pivot_1,pivot_2]")
    goal = np.array([0.0, 1.0, 0.0, 0.0, 0.0])
    execution = Execution(coordinates="backward")
    steered = steer(extend(system, elements), np.zeros(5), goal, execution)
    for shot, distance in enumerate(steered.distances):
        print(f"after plan {shot:2d} the cupboard is {distance:.2e} from its goal")
    print(f"{steered.plan.contact_switches} times a foot is lifted or set down")


if __name__ == "__main__":
    main()
