"""One point of a sweep, from its settings to its numbers or the reason of its failure.

Runs in worker processes, which may be on other machines. What many points have in
common is kept between them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from sim.errors import one_line
from sim.preparation.shared import Shared
from sim.scenarios.file import scenario_from
from sim.simulation import simulate
from sim.sweeps.identity import software
from sim.sweeps.ledger import OK, Outcome

SHARED = Shared()
"""What this process keeps from point to point."""
LEFT_OUT = ("timing",)  # which differs from run to run


@dataclass(frozen=True, slots=True)
class Task:
    """A point to be walked."""

    digest: str
    table: Mapping[str, object]  # of its scenario, in plain values
    without: Sequence[str] = ()

    def carry_out(self) -> Outcome:
        """Walk the point; whatever goes wrong with it becomes its status."""
        try:
            scenario = scenario_from(self.table, {}, "the sweep")
            summary = simulate(scenario, without=self.without, shared=SHARED).summary
        except Exception as error:  # any failure of a point is one of its results
            return Outcome(self.digest, one_line(error), software=software())
        return Outcome(self.digest, OK, dict(numbers(summary)), software())


def numbers(summary: object, name: str = "") -> Iterator[tuple[str, object]]:
    """Numbers and words of a summary by their dotted names."""
    if isinstance(summary, list | tuple):
        summary = {str(place): value for place, value in enumerate(summary)}
    if not isinstance(summary, Mapping):
        yield name, summary
        return
    for key, value in summary.items():
        if name or key not in LEFT_OUT:
            yield from numbers(value, f"{name}.{key}" if name else key)
