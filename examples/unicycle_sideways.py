"""A wheel that cannot slide is moved sideways by driving and turning alone.

No combination of the two inputs points sideways. Yet driving a little, turning a
little, and undoing both in the same order does not lead back to the start: to second
order the wheel has moved along the Lie bracket of the two fields, which is the sideways
direction. This is how a car is parked, and how a robot whose legs only swing and lift
walks sideways. The example plays the loop for smaller and smaller durations t and
divides the displacement by t^2, which tends to the bracket.

Example:
    python examples/unicycle_sideways.py --halvings 6
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from models import shipped_system
from planner import Flow, bracket, play


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the displacement of smaller and smaller loops, and its limit."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--halvings", type=int, default=4, help="of the duration")
    halvings = parser.parse_args(arguments).halvings

    unicycle = shipped_system("unicycle").system
    drive, turn = unicycle.fields["drive"], unicycle.fields["turn"]
    print("[drive, turn] =", list(bracket(drive, turn, unicycle.state)))

    for k in range(halvings + 1):
        t = 0.5**k
        durations = [("drive", t), ("turn", t), ("drive", -t), ("turn", -t)]
        loop = [Flow(unicycle.bottom, name, duration) for name, duration in durations]
        moved = play(unicycle, loop, np.zeros(3))[-1]
        x, y, theta = moved / t**2
        print(f"t = {t:<8g} displacement / t^2 = ({x:+.4f}, {y:+.4f}, {theta:+.4f})")


if __name__ == "__main__":
    main()
