"""A hexapod walks diagonally in the physics, without ever stepping sideways.

Its legs swing about a vertical axis and lift, and that is all they do. The planner
knows only two facts, namely how the body moves while one tripod or the other swings on
the ground, and makes the sideways part of the motion from their bracket. MuJoCo knows
nothing of this: it simulates bodies, servos and friction. The table at the end says how
far the two are apart, and a film is made if it is given a name.

Example:
    python examples/hexapod_in_physics.py --goal 0.02 0.02 0 --film walk.mp4
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import models
import planner
import sim


def main(arguments: Sequence[str] | None = None) -> None:
    """Plan, walk, compare, and film where asked to."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--goal", type=float, nargs=3, default=[0.01, 0.01, 0.0])
    parser.add_argument("--segments", type=int, default=2)
    parser.add_argument("--film", help="name of a film to make, such as walk.mp4")
    parser.add_argument("--playback", type=float, default=10.0, help="its speed")
    options = parser.parse_args(arguments)

    robot = models.load("hexapod")
    path = planner.line((0, 0, 0), options.goal)
    plan = planner.plan(models.equations(robot), path, segments=options.segments)
    print(plan)

    report = sim.evaluate(sim.walk(robot, plan, playback=options.playback))
    print(report)
    if options.film:
        sim.film(report, options.film)


if __name__ == "__main__":
    main()
