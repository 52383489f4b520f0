"""The worked example of the paper's Sec. 6, and the 5/8 that is printed there as 3/4.

The hexapod is to move by one unit forward and one sideways. Two fields drive it while
all feet stand, and their bracket moves it sideways. The fictitious inputs are constant,
v = (1/2, 1/2, 1/2) for these three, but the sequence of flows that gives the same
motion has other coordinates: by eq. (9) the third obeys h3' = v3 + h1 v2 and grows to
1/2 + 1/8 = 5/8. The last lines compare where the sequences with 5/8 and with the
printed 3/4 take the robot.

Example:
    python examples/hall_coordinates.py
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from models import shipped_system
from planner import Flow, backward, hall_basis, play, word


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the Hall coordinates, the real inputs, and where they lead."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.parse_args(arguments)

    hexapod = shipped_system("paper-hexapod").system
    basis = hall_basis(generators=2, max_degree=2)
    h = backward(basis, (1 / 2, 1 / 2, 1 / 2))
    print("basis", *basis)
    print("Hall coordinates", *h)

    start = np.zeros(hexapod.dimension)
    for third in (h[2], 3 / 4):
        letters = word(basis, (h[0], h[1], third))
        flows = [Flow("12", f"g12_{letter}", time) for letter, time in letters]
        x, y, theta = play(hexapod, flows, start)[-1, :3].round(9) + 0.0
        print(f"\nwith {third:g} the inputs are")
        print(*(f"  {flow}" for flow in flows), sep="\n")
        print(f"and lead to x = {x:.4f}, y = {y:.4f}, theta = {theta:.4f}")


if __name__ == "__main__":
    main()
