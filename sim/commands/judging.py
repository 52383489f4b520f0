"""How walks end the command: with 4 after a fall or collision, with 7 beyond tolerance.

One line on standard error says why it is not 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from sim.commands.options import notice, option, real
from sim.errors import ExitCode, SimulationError, one_line

if TYPE_CHECKING:
    from sim.evaluation.summary import Summary, Weighed
    from sim.tries import Try

DEFAULT = 0.25


def _share(text: str) -> float:
    return math.inf if text == "none" else real("a share", 0.05)(text)


TOLERANCE = option(
    "--tolerance",
    type=_share,
    default=DEFAULT,
    metavar="RATIO|none",
    help="end with 7 where a walk ends farther from its goal, or comes farther off its "
    f"prediction, than this share of the path; otherwise {DEFAULT}",
)


def judged(
    summary: Summary,
    tolerance: float,
    remedy: str,
    played: Mapping[str, Weighed] | None = None,
) -> ExitCode:
    """The exit code of a walk, and of what was played of it, by names in words."""
    from sim.evaluation.verdict import FAILURES

    where = f"{summary.scenario} on {summary.robot}"
    if summary.verdict in FAILURES:
        how = f"the walk {summary.verdict_text}"
        return _ended(ExitCode.SIMULATION, how, where, remedy)
    for name, weighed in {"the walk": summary.weighed, **(played or {})}.items():
        if weighed and (off := weighed.beyond(tolerance)):
            how = f"{name} came out {off}, beyond --tolerance {tolerance:g}"
            return _ended(ExitCode.TOLERANCE, how, where, remedy)
    return ExitCode.OK


def judged_tries(tries: Sequence[Try], tolerance: float, remedy: str) -> ExitCode:
    """The exit code of several draws: that of the worst."""
    from sim.evaluation.verdict import FAILURES

    where = f"{len(tries)} draws"
    broken = [one for one in tries if one.off is None or one.verdict in FAILURES]
    if broken:
        first = broken[0]
        how = f"draw {first.draw} and {len(broken) - 1} more: {first.verdict}"
        return _ended(ExitCode.SIMULATION, how, where, remedy)
    worst = max(one.off or 0.0 for one in tries)
    if worst <= tolerance:
        return ExitCode.OK
    count = sum((one.off or 0.0) > tolerance for one in tries)
    how = (
        f"{count} came out farther off goal or prediction than --tolerance "
        f"{tolerance:g}, at worst {100 * worst:.3g} % of the path"
    )
    return _ended(ExitCode.TOLERANCE, how, where, remedy)


def _ended(code: ExitCode, how: str, where: str, remedy: str) -> ExitCode:
    notice(one_line(SimulationError(how, where, remedy)), "error")
    return code
