"""One walk repeated with several draws of an imperfect robot, and a table of them."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, fields, replace
from statistics import median

from models import Robot
from planner import PlannerError
from sim.errors import StratawalkError, one_line
from sim.evaluation.quantities import CLAIMED, MARGIN, POSITION, ROWS, WRONG, YAW
from sim.folder import RunFolder
from sim.progress import Progress
from sim.run_folder import run
from sim.scenarios.scenario import Scenario

TABLE = "tries.csv"
LEFT_OUT = ("identified", "compliant")  # not in the table; they cost as much as walks
MEASURES = {  # columns of the table: quantities, and of which row of the comparison
    "goal": (POSITION, "goal"),
    "ideal": (POSITION, "ideal"),
    "quasi_static": (POSITION, "quasi_static"),
    "yaw": (YAW, "goal"),
    "margin": (MARGIN, "achieved"),
    "thought": (WRONG, ""),
    "claimed": (CLAIMED, ""),
}


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
    thought: float | None = None  # off where it was, with feedback from sensors [m]
    claimed: float | None = None  # error that feedback claims for that [m]
    off: float | None = None  # farthest off goal or prediction, as a share of the path


def walk_tries(
    scenario: Scenario,
    robot: Robot,
    folder: RunFolder,
    draws: Sequence[int],
    progress: Progress,
) -> list[Try]:
    """Walk every draw into a run folder `draw-N`, and write `tries.csv` beside them."""
    tries: list[Try] = []
    for done, draw in enumerate(draws):
        progress("walking draws", done / len(draws))
        inner = folder.inner(f"draw-{draw:03d}")
        tries.append(_try(replace(scenario, draw=draw), robot, inner))
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(item.name for item in fields(Try))
        table.writerows(map(astuple, tries))
        folder.write_text(TABLE, text.getvalue())
    return tries


def _try(scenario: Scenario, robot: Robot, folder: RunFolder) -> Try:
    try:
        summary = run(scenario, folder, robot=robot, without=LEFT_OUT)
    except (StratawalkError, PlannerError) as error:
        return Try(scenario.draw, one_line(error))
    found = {name: q.value(summary, row) for name, (q, row) in MEASURES.items()}
    weighed = summary.weighed
    off = max(weighed.goal or 0.0, weighed.farthest) if weighed else None
    return Try(scenario.draw, summary.verdict, **found, off=off)


def describe(tries: Sequence[Try], path_length: float) -> Iterator[str]:
    """Median and worst of all draws, in lines for a terminal; of a path [m]."""
    walked = [one for one in tries if one.goal is not None]
    yield f"{len(walked)} of {len(tries)} draws walked to their end"
    for one in tries:
        if one.goal is None:
            yield f"draw {one.draw}: {one.verdict}"
    if not walked:
        return
    yield f"{'':13}{'median':>22}{'worst':>22}"
    for name, (quantity, row) in MEASURES.items():
        values = [v for one in walked if (v := getattr(one, name)) is not None]
        if not values:
            continue
        ends = median(values), min(values) if quantity is MARGIN else max(values)
        words = [quantity.words(end) for end in ends]
        if quantity is POSITION and path_length:
            words = [
                f"{w} {end / path_length:7.2%}"
                for w, end in zip(words, ends, strict=True)
            ]
        if quantity is not YAW:
            label = ROWS[row] if quantity is POSITION else name
            yield f"{label:13}" + "".join(f"{text:>22}" for text in words)
