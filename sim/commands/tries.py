"""One walk repeated with several draws of an imperfect robot, and a table of them."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, astuple, dataclass, fields, replace
from statistics import median

from models import Robot
from planner import PlannerError
from sim.commands import options as cli
from sim.endings import again, keeping
from sim.errors import ExitCode, StratawalkError, one_line
from sim.evaluation.quantities import CLAIMED, MARGIN, POSITION, ROWS, WRONG, YAW
from sim.evaluation.verdict import FAILURES
from sim.folder import RunFolder, claim, csv_text
from sim.progress import Progress, bar
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


def tries_of(
    scenario: Scenario, robot: Robot, options: argparse.Namespace, said: Iterable[str]
) -> ExitCode:
    """Walk draws one after another; the worst and the median are printed.

    What is `said` beforehand is noticed once there is a folder.
    """
    folder = claim(cli.folder_of(options), scenario.name)
    draws = range(scenario.draw, scenario.draw + options.tries)

    def kept() -> str:
        table = folder.path / TABLE
        done = table.read_text("utf-8").count("\n") - 1 if table.is_file() else 0
        rest = "--draw", f"{draws[done]}", "--tries", f"{len(draws) - done}"
        on = again(*rest, *cli.elsewhere(options.out))
        return f"{done} of {len(draws)} draws are kept in {table}; go on: {on}"

    with keeping(kept):
        for line in said:
            cli.notice(line)
        with bar(quiet=options.json) as progress:
            tries = walk_tries(scenario, robot, folder, draws, progress)
    lines = [*describe(tries, scenario.path.length), "", f"{'folder':13}{folder.path}"]
    cli.report(options, [asdict(one) for one in tries], *lines)
    return judged_tries(tries, options.tolerance, f"see {folder.path}")


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
        names = [item.name for item in fields(Try)]
        folder.write_text(TABLE, csv_text([names, *map(astuple, tries)]))
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


def judged_tries(tries: Sequence[Try], tolerance: float, remedy: str) -> ExitCode:
    """The exit code of several draws: that of the worst."""
    where = f"{len(tries)} draws"
    broken = [one for one in tries if one.off is None or one.verdict in FAILURES]
    if broken:
        first = broken[0]
        how = f"draw {first.draw} and {len(broken) - 1} more: {first.verdict}"
        return cli.ended(ExitCode.SIMULATION, how, where, remedy)
    worst = max(one.off or 0.0 for one in tries)
    if worst <= tolerance:
        return ExitCode.OK
    count = sum((one.off or 0.0) > tolerance for one in tries)
    how = (
        f"{count} came out farther off goal or prediction than --tolerance "
        f"{tolerance:g}, at worst {100 * worst:.3g} % of the path"
    )
    return cli.ended(ExitCode.TOLERANCE, how, where, remedy)
