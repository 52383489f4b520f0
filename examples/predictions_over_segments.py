"""Which prediction the physics follows, and what cutting the path finer does to it.

Two predictions stand beside every walk. The ideal one uses the paper's fields, on which
the plan is made. The quasi-static one knows the real legs and their loads, and moves
the body so that friction wastes as little power as possible. Under the fields that the
paper prints, a tripod swings while the other one stands, so that six feet must slide
against each other: the ideal prediction fails there, and the quasi-static one does not.
Cutting the same path into more segments makes each motion shorter and the whole walk
longer.

Example:
    python examples/predictions_over_segments.py --segments 2 4 8 16
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from sim import load_scenario, simulate

OTHERS = ("identified", "compliant", "creep_floor")


def main(arguments: Sequence[str] | None = None) -> None:
    """Walk the same short path in different numbers of segments."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--segments", type=int, nargs="+", default=[2, 4])
    options = parser.parse_args(arguments)

    short = {"path.goal": [0.01, 0.01, 0.0]}
    print("fields   segments   off ideal [mm]   off quasi-static [mm]   walked [m]")
    for fields in ("paper", "lifted"):
        for segments in options.segments:
            changes = {"fields": fields, "segments": segments}
            scenario = load_scenario("line", short | changes)
            summary = simulate(scenario, without=OTHERS).summary
            off = summary["error"]
            ideal, real = (1e3 * off[k]["position"] for k in ("ideal", "quasi_static"))
            walked = summary["distance_walked"]
            print(f"{fields:8}{segments:9}{ideal:17.3f}{real:24.3f}{walked:13.3f}")


if __name__ == "__main__":
    main()
