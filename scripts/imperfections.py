"""What one imperfection at a time costs a walk that was planned for a perfect robot.

`line` is walked open loop by `hexapod` with its ideal servos, once as it should be and
once for each thing that is wrong. A row says how far the walk then ends from where the
perfect robot ends. Where the effect depends on a draw or a direction, several are
walked, and the least and the largest effect are printed.

Example:
    python -m scripts.imperfections
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, radians

import numpy as np

from models import load
from scripts.pages import parser_of, tabulate
from sim import load_scenario, simulate

WITHOUT = (
    "identified",
    "compliant",
    "creep_floor",
)  # each costs experiments of its own
DRAWS = range(3)
LEGS, LOAD, ASIDE, ABOVE = 6, 0.1, 0.02, 0.02  # of the mass; [m]
FLOOR = 1e5  # stiffness of the floor as it is
SEGMENT = 0.00375  # of `line`, along x and along y [m]

Settings = Mapping[str, object]


def zeros(kind: int, draw: int) -> Settings:
    """Zeros of one kind of servo, 0 for swing and 1 for lift, up to a degree off."""
    off = np.zeros((LEGS, 2))
    off[:, kind] = np.random.default_rng(draw).uniform(-1, 1, LEGS) * radians(1)
    return {"zero_offset": off.ravel().tolist()}


def rows() -> dict[str, Sequence[Settings]]:
    """What is wrong, in words, and the settings of each walk with it."""
    load_mass = LOAD * float(load("hexapod").model.body_mass.sum())
    aside = ((ASIDE, 0.0), (0.0, ASIDE))
    return {
        "zeros of lift servos, up to 1 degree": [zeros(1, n) for n in DRAWS],
        "zeros of swing servos, up to 1 degree": [zeros(0, n) for n in DRAWS],
        "payload of a tenth of the mass, 20 mm off the middle": [
            {"payload": [load_mass, x, y, ABOVE]} for x, y in aside
        ],
        "slope of 2 degrees": [
            {"slope": [radians(2), direction]} for direction in (0.0, pi / 2, pi)
        ],
        "front feet with half the friction": [
            {"foot_friction": [0.5, 1.0, 1.0, 0.5, 1.0, 1.0]}
        ],
        "floor 33 times softer": [{"floor_stiffness": FLOOR / 33}],
        "friction of 0.3 or 1.2 instead of 1": [{"friction": mu} for mu in (0.3, 1.2)],
        "backlash of half a degree": [{"backlash": radians(0.5)}],
        "bumps of 1 mm": [{"bumps": 1e-3, "draw": draw} for draw in DRAWS],
    }


def walked(changes: Settings, segments: int = 40) -> tuple[np.ndarray, int, float]:
    """Where `line` ends with some settings changed, its bounces, its path's length."""
    end = segments * SEGMENT
    way = {"segments": segments, "path.goal": [end, end, 0.0]}
    scenario = load_scenario("line", way | dict(changes))
    summary = simulate(scenario, without=WITHOUT).summary
    achieved = np.array(summary["achieved"]["pose"])
    return achieved, summary["bounces"], summary["path_length"]


def main(arguments: Sequence[str] | None = None) -> None:
    """Walk every row and print it."""
    parser = parser_of(__doc__)
    parser.add_argument("--only", default="", help="walk rows that begin with this")
    parser.add_argument("--segments", type=int, default=40, help="how many to walk")
    given = parser.parse_args(arguments)
    perfect, _, length = walked({}, given.segments)

    def row(wrong: str, walks: Sequence[Settings]) -> tuple[str, ...]:
        ends = [walked(changes, given.segments) for changes in walks]
        off = [100 * np.hypot(*(end - perfect)[:2]) / length for end, _, _ in ends]
        return wrong, _range(off, ".2f"), _range([count for _, count, _ in ends], "d")

    tabulate(
        "wrong | moves the end by, per cent of the path | bounces",
        (row(*one) for one in rows().items() if one[0].startswith(given.only)),
    )


def _range(values: Sequence[float], form: str) -> str:
    """Least and largest of several values, or the only one."""
    ends = (f"{value:{form}}" for value in (min(values), max(values)))
    return " to ".join(dict.fromkeys(ends))


if __name__ == "__main__":
    main()
