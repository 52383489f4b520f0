"""One test a rule of the project, that names every file which breaks it."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def no(offenders):
    """Fail with all faults, one a line.

    Args:
        offenders: Pairs of a file's path and what is wrong in it; empty for nothing.
    """
    found = [f"{path.relative_to(ROOT)}: {fault}" for path, fault in offenders if fault]
    assert found == [], "\n".join(["", *found])
