"""Tables and sentences of a report: verdict, ends, errors by phase, settings."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from planner import Array
from sim.evaluation.quantities import (
    OF_ROWS,
    OF_WALKS,
    POSITION,
    ROWS,
    SLIP,
    YAW,
    number,
)
from sim.reports.drawing import MM, WORDS
from sim.runs.run import Run
from sim.scenarios.file import toml_value
from sim.scenarios.predictions import PREDICTIONS
from sim.scenarios.settings import SETTINGS
from sim.templates import render

JOINED = "flows (successive ones along a field count as one)"  # unlike in plans


@dataclass(frozen=True)
class Table:
    """A table with the names and units of its columns."""

    header: Sequence[str]
    rows: Sequence[Sequence[Any]]

    def __post_init__(self) -> None:
        for i, row in enumerate(self.rows):
            if len(row) != (width := len(self.header)):
                raise ValueError(f"row {i} has {len(row)} cells for {width} columns")


def sentences(run: Run) -> list[str]:
    """What became of the walk, the most important first."""
    summary = run.summary
    known = {"label": PREDICTIONS[run.best].label, "ignored": summary.ignored}
    foreseen = SLIP.value(summary, run.best) or 0.0
    return render("sentences.txt", foreseen=foreseen, **known, **summary).splitlines()


def ends(run: Run) -> Table:
    """Where the walk ends, as predicted and achieved, and how much they differ."""
    summary = run.summary
    rows = []
    for row, label in ROWS.items():
        if (pose := summary.poses.get(row)) is not None:
            place = number(MM * pose[0]), number(MM * pose[1]), number(pose[2], 4)
            name = f"predicted, {label}" if row in PREDICTIONS else label
            cells = (q.cell(summary, row) for q in (POSITION, YAW, *OF_ROWS))
            rows.append((name, *place, *cells))
    header = ("", "x [mm]", "y [mm]", "yaw [rad]", "off at the end [mm]")
    return Table((*header, "in yaw [mrad]", *(q.title for q in OF_ROWS)), rows)


def sources(run: Run) -> Table | None:
    """What each kind of phase adds to the final error; None for a replanned walk."""
    if not (found := contributions(run)):
        return None
    header, of_label = ["", "phases", "slip [mm]", "not as planned"], defaultdict(list)
    for phase in run.phases:
        of_label[f"{phase.kind} S{phase.stratum}"].append(phase)
    for name in found:
        header += [f"{PREDICTIONS[name].label}: x [mm]", "y [mm]", "yaw [mrad]"]
    rows = []
    for name, labels in kinds_of(next(iter(found.values()))):
        phases = [phase for label in labels for phase in of_label[label]]
        slip = number(MM * sum(phase.slip for phase in phases), 1)
        facts = len(phases), slip, sum(not phase.as_planned for phase in phases)
        sums = (np.sum([p[x] for x in labels], axis=0) for p in found.values())
        cells = (number(MM * part, 3) for added in sums for part in added)
        rows.append([name, *map(str, facts), *cells])
    return Table(header, rows)


def contributions(run: Run) -> dict[str, dict[str, Array]]:
    """Contributions of kinds of phases by prediction; none of a replanned walk."""
    return {
        name: {label: np.array(part) for label, part in found.items()}
        for name in PREDICTIONS
        if (found := (run.summary.error_sources or {}).get(name))
    }


def kinds_of(parts: Mapping[str, Array]) -> Iterator[tuple[str, list[str]]]:
    """Rows of a table of sources: names, and the kinds of phases that they sum."""
    for label in parts:
        kind, _, stratum = label.partition(" S")
        row = WORDS["shifted"].get(kind, f"{kind} S{{}}").format(stratum)
        yield row.replace("Slegs", "legs"), [label]  # where they are no whole groups
    for name, kinds in WORDS["sums"].items():
        if own := [label for label in parts if label.partition(" ")[0] in kinds]:
            yield name, own


def counts(run: Run) -> Table:
    """Counts and lengths of the walk."""
    flows = sum(phase.kind == "swing" for phase in run.phases)
    rows = [("segments", str(run.segments)), (JOINED, str(flows))]
    given = (q for q in OF_WALKS if q.value(run.summary) is not None)
    rows += [(q.title, q.cell(run.summary)) for q in given]
    return Table(("", ""), rows)


def settings(run: Run) -> Table:
    """Every setting with its value and its meaning, as scenario.toml has them."""
    given = dict(run.settings)
    rows = [
        (name, toml_value(given.pop(name)) if name in given else "not set", item.about)
        for name, item in SETTINGS.items()
    ]
    rows += [(name, toml_value(value), "") for name, value in flat(given)]
    for key, value in run.summary.servo.items():
        text = "not set" if value is None else toml_value(value)
        rows.append((f"servo: {key}", text, "as it was simulated"))
    return Table(("setting", "value", "meaning"), rows)


def flat(table: Mapping[str, Any], head: str = "") -> Iterator[tuple[str, object]]:
    """Settings of scenario.toml by dotted names, as `path.goal`."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{head}{key}.")
        else:
            yield head + key, value


def versions(run: Run) -> Table:
    """Versions of what computed the run; of older runs, of what draws this page."""
    from sim.versions import versions as present

    return Table(("", "version"), list((run.summary.versions or present()).items()))
