"""A biped that cannot move at all while both feet stand, and can still go anywhere.

The biped of Fig. 2 turns about whichever foot is down, as one walks a cupboard. The
paper's own test (Sec. 4) closes the fields of each stratum under brackets, stratum by
stratum, and finds that one direction is missing. That test is sufficient and not
necessary: brackets of fields from different strata, which Def. 3 allows, supply the
missing direction, sideways. The first report forms no brackets at all, the second does.

Example:
    python examples/biped_controllability.py --system quadruped-crawl
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from models import shipped_system
from planner import gait_controllability


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what both tests say without brackets and with them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--system", default="biped", help="a shipped system")
    problem = shipped_system(parser.parse_args(arguments).system)

    for depth in (1, 6):
        report = gait_controllability(
            problem.system, problem.gait, problem.states[0].tolist(), depth
        )
        verdict = "controllable" if report.controllable else "not shown controllable"
        print(f"brackets to degree {report.depth}: {verdict}")
        print(f"  strata one by one   {report.filtration} of {report.dimension}")
        print(f"  across strata       {report.closure} of {report.dimension}")
        if report.missing:
            print(f"  no motion along     {', '.join(report.missing)}")


if __name__ == "__main__":
    main()
