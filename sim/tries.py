"""One walk repeated with several draws of an imperfect robot, and a table of them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

from models import Robot
from planner import PlannerError
from sim.errors import StratawalkError, one_line
from sim.folder import RunFolder
from sim.progress import Progress
from sim.run_folder import run
from sim.scenarios.scenario import Scenario

TABLE = "tries.csv"
NOT_TOLD = ("identified",)  # not in the table; measuring it costs experiments
COLUMNS = ("draw", "verdict", "goal", "ideal", "quasi_static", "yaw", "margin")


@dataclass(frozen=True, slots=True)
class Try:
    """One draw: how far its walk ended off [m], or why there is none."""

    draw: int
    verdict: str
    goal: float | None = None
    ideal: float | None = None
    quasi_static: float | None = None
    yaw: float | None = None  # off the goal's [rad]
    margin: float | None = None  # least, achieved [m]


def walk_tries(
    scenario: Scenario,
    robot: Robot,
    folder: RunFolder,
    draws: Sequence[int],
    progress: Progress,
) -> list[Try]:
    """Walk every draw and write `tries.csv` beside their run folders.

    Args:
        scenario: What to walk.
        robot: The scenario's robot.
        folder: Where the run folders go, `draw-N` each.
        draws: Numbers of the draws.
        progress: Called with the share of the draws that is done.

    Raises:
        FilesError: If a folder cannot be written.
    """
    tries: list[Try] = []
    for done, draw in enumerate(draws):
        progress("walking draws", done / len(draws))
        inner = folder.inner(f"draw-{draw:03d}")
        tries.append(_try(replace(scenario, draw=draw), robot, inner))
        folder.write_text(TABLE, _csv(tries))
    return tries


def _try(scenario: Scenario, robot: Robot, folder: RunFolder) -> Try:
    try:
        summary: Mapping[str, Any] = run(
            scenario, folder, robot=robot, without=NOT_TOLD
        )
    except (StratawalkError, PlannerError) as error:
        return Try(scenario.draw, one_line(error))
    off = summary["error"]
    return Try(
        draw=scenario.draw,
        verdict=summary["verdict"],
        goal=off["goal"]["position"],
        ideal=off["ideal"]["position"],
        quasi_static=off["quasi_static"]["position"],
        yaw=off["goal"]["yaw"],
        margin=summary["achieved"]["min_margin"],
    )


def _csv(tries: Sequence[Try]) -> str:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for one in tries:
        table.writerow([getattr(one, column) for column in COLUMNS])
    return text.getvalue()


def describe(tries: Sequence[Try], path_length: float) -> str:
    """Median and worst of all draws, in lines for a terminal.

    Args:
        tries: What was walked.
        path_length: Of the nominal path [m].
    """
    return "\n".join(_lines(tries, path_length))


def _lines(tries: Sequence[Try], path_length: float) -> Iterator[str]:
    walked = [one for one in tries if one.goal is not None]
    yield f"{len(walked)} of {len(tries)} draws walked to their end"
    for one in tries:
        if one.goal is None:
            yield f"draw {one.draw}: {one.verdict}"
    if not walked:
        return
    yield f"{'':13}{'median':>22}{'worst':>22}"
    for name in ("goal", "ideal", "quasi_static"):
        off = [getattr(one, name) for one in walked]
        said = (_share(value, path_length) for value in (median(off), max(off)))
        yield f"{name.replace('_', '-'):13}" + "".join(f"{text:>22}" for text in said)
    margins = [one.margin for one in walked if one.margin is not None]
    said = (f"{1e3 * value:.1f} mm" for value in (median(margins), min(margins)))
    yield f"{'margin':13}" + "".join(f"{text:>22}" for text in said)


def _share(off: float, path_length: float) -> str:
    share = f" {off / path_length:7.2%}" if path_length else ""
    return f"{1e3 * off:.2f} mm{share}"
