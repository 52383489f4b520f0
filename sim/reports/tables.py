"""Tables of a report: the ends, the error by phase, the settings and the versions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sim.evaluation.flows import WalkedPhase
from sim.runs.run import Run
from sim.scenarios.file import toml_value
from sim.scenarios.predictions import PREDICTIONS
from sim.scenarios.settings import SETTINGS

MM = 1e3
MINUS = "\N{MINUS SIGN}"
NONE = "\N{EN DASH}"
SHIFTED = {  # what the phases of a walk are called in the table of sources
    "hold": "standing still on S{}",
    "lift": "lift-off to S{}",
    "swing": "swing on S{}",
    "land": "touchdown from S{}",
}


@dataclass(frozen=True)
class Table:
    """A table; the first column names the row."""

    header: Sequence[str]
    rows: Sequence[Sequence[str]]


def number(value: float | None, digits: int = 2) -> str:
    """A number for people; a dash if there is none."""
    if value is None:
        return NONE
    said = f"{value:z,.{digits}f}"
    return said.replace("-", MINUS)


def ends(run: Run) -> Table:
    """Where the walk ends, as predicted and achieved, and how much they differ."""
    summary = run.summary
    rows = [
        ["goal", *_pose(summary["goal"]), *_off(summary["error"]["goal"]), NONE, NONE]
    ]
    for name, (_, said, _) in PREDICTIONS.items():
        if found := summary["predicted"].get(name):
            off = _off(summary["error"][name])
            rows.append(
                [f"predicted, {said}", *_pose(found["pose"]), *off, *_way(found)]
            )
    achieved = summary["achieved"]
    rows.append(
        ["achieved", *_pose(achieved["pose"]), NONE, NONE, NONE, *_way(achieved)]
    )
    header = (
        "", "x [mm]", "y [mm]", "yaw [rad]", "physics ends off by [mm]",
        "by yaw [mrad]", "at most [mm]", "least margin [mm]", "slip [mm]",
    )  # fmt: skip
    return Table(header, rows)


def _pose(pose: Sequence[float]) -> list[str]:
    return [number(MM * pose[0]), number(MM * pose[1]), number(pose[2], 4)]


def _off(error: Mapping[str, float]) -> list[str]:
    farthest = error.get("farthest")
    at_most = NONE if farthest is None else number(MM * farthest)
    return [number(MM * error["position"]), number(MM * error["yaw"]), at_most]


def _way(along: Mapping[str, float]) -> list[str]:
    return [number(MM * along["min_margin"], 1), number(MM * along["slip"], 1)]


def sources(run: Run) -> Table | None:
    """What each kind of phase adds to the final error; None for a replanned walk."""
    found: Mapping[str, Any] | None = run.summary.get("error_sources")
    if not found:
        return None
    names = [name for name in PREDICTIONS if found.get(name)]
    header = ["", "phases", "slip [mm]", "not as planned"]
    for name in names:
        said = PREDICTIONS[name].label
        header += [f"{said}: x [mm]", "y [mm]", "yaw [mrad]"]
    rows = []
    for label in found[names[0]]:
        row = [_said(label), *_carried_out(run.phases, label)]
        for name in names:
            row += [number(MM * part, 3) for part in found[name][label]]
        rows.append(row)
    sums = [
        number(MM * sum(part[i] for part in found[name].values()), 3)
        for name in names
        for i in range(3)
    ]
    rows.append(["all together", *_carried_out(run.phases, None), *sums])
    return Table(header, rows)


def _said(label: str) -> str:
    kind, _, stratum = label.partition(" S")
    return SHIFTED.get(kind, f"{kind} S{{}}").format(stratum)


def _carried_out(phases: Sequence[WalkedPhase], label: str | None) -> list[str]:
    """Number of the phases of a kind, their slip, and how many had other contacts."""
    found = [p for p in phases if label in (None, f"{p.kind} S{p.stratum}")]
    slip = sum(phase.slip for phase in found)
    wrong = sum(not phase.as_planned for phase in found)
    return [str(len(found)), number(MM * slip, 1), str(wrong)]


def counts(run: Run) -> Table:
    """Counts and lengths of the walk."""
    summary = run.summary
    kinds = Counter(phase.kind for phase in run.phases)
    switches = summary["contact_switches"], summary["contact_switches_achieved"]
    rows = [
        ("segments", str(1 + max((p.segment for p in run.phases), default=0))),
        ("flows", str(kinds["swing"])),
        ("contact switches", f"{switches[0]} planned, {switches[1]} achieved"),
        ("bounces", str(summary["bounces"])),
        ("length of the path", f"{summary['path_length']:.4f} m"),
        ("way walked", f"{summary['distance_walked']:.4f} m"),
        ("swing of loaded groups", f"{summary['swing_travel']:.2f} rad"),
        ("swing in the air", f"{summary['air_travel']:.2f} rad"),
        ("simulated time", f"{summary['simulated_time']:.2f} s"),
    ]
    return Table(("", ""), rows)


def settings(run: Run) -> Table:
    """Every setting with its value and its meaning, as scenario.toml has them."""
    given = dict(run.settings)
    rows = [
        (name, toml_value(given.pop(name)) if name in given else "not set", about)
        for name, about in ((name, item.about) for name, item in SETTINGS.items())
    ]
    rows += [(name, toml_value(value), "") for name, value in flat(given)]
    servo = run.summary.get("servo") or {}
    for key, value in servo.items():
        said = "not set" if value is None else str(value)
        rows.append((f"servo: {key}", said, "as it was simulated"))
    return Table(("setting", "value", "meaning"), rows)


def flat(table: Mapping[str, Any], head: str = "") -> Iterator[tuple[str, object]]:
    """Settings by dotted names, as `path.goal`.

    Args:
        table: As scenario.toml has them.
        head: What the names begin with.
    """
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{head}{key}.")
        else:
            yield head + key, value


def versions(run: Run) -> Table:
    """Versions of what computed the run; of older runs, of what draws this page."""
    from sim.versions import versions as present

    recorded: Mapping[str, str] | None = run.summary.get("versions")
    return Table(("", "version"), list((recorded or present()).items()))
