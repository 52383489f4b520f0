"""Run folders of the points that a sweep's file asks to keep."""

from __future__ import annotations

import shutil

from sim.errors import FilesError, one_line
from sim.folder import RunFolder
from sim.run_folder import run
from sim.scenarios.file import scenario_from
from sim.sweeps.folder import SweepFolder
from sim.sweeps.sweeping import Points

RUNS = "runs"


def walk_kept(points: Points, folder: SweepFolder) -> list[str]:
    """Walk the chosen points once more, each into a run folder of its own.

    Folders that are complete already are left alone.

    Args:
        points: Points of the sweep, or of a shard.
        folder: Its folder.

    Returns:
        What could not be kept, and why, a line each.

    Raises:
        FilesError: If a folder cannot be written.
    """
    wrong, last = [], "video.mp4" if points.sweep.filmed else "summary.json"
    for point in points.sweep.kept:
        if point not in points.tables:
            continue
        name = f"point-{point:05d}"
        if (folder.path / RUNS / name / last).exists():
            continue
        shutil.rmtree(folder.path / RUNS / name, ignore_errors=True)
        made = RunFolder(folder.path / RUNS).inner(name)
        scenario = scenario_from(points.tables[point], {}, f"point {point}")
        try:
            run(scenario, made, look="draft" if points.sweep.filmed else None)
        except FilesError:
            raise
        except Exception as error:  # its reason stands in the table as well
            wrong.append(f"point {point}: {one_line(error)}")
    return wrong
