"""The table of quantities: how the numbers of a summary are named and shown.

Terminal, report, comparison of runs and tries read it; a test holds docs/numbers.md
against it. Sweeps have every number of the summary by its key. For a terminal all of a
summary is put into lines here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import degrees

from sim.evaluation.summary import Played, Real, Sensed, Summary
from sim.scenarios.predictions import PREDICTIONS, QUASI_STATIC, prediction_key

CAPPED = 0.9  # of the speed asked for; strokes that come to less are mentioned
MENTIONED = 1e-3  # [m]; a robot that is moved farther at its start is mentioned

DEGREES = degrees(1.0)

MINUS = "\N{MINUS SIGN}"
NONE = "\N{EN DASH}"
GOAL, ACHIEVED, MEASURED = "goal", "achieved", "measured"
ROWS: Mapping[str, str] = {  # of a comparison: label by key
    GOAL: "goal",
    **{key: name.label for key, name in PREDICTIONS.items()},
    ACHIEVED: "achieved",
    MEASURED: "measured",
}


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number of the summary, as people read it."""

    key: str  # dotted name in summary.json; `*` is a row of `ROWS`
    label: str
    unit: str = ""  # in which it is shown
    scale: float = 1.0  # from SI units to that unit
    digits: int = 0  # after the point
    column: str = ""  # its heading on the terminal; without one rows have a line for it
    width: int = 10  # of that column
    line: bool = False  # whether a number of the walk has a line of the terminal

    @property
    def title(self) -> str:
        """Label and unit, as heads of tables have them."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def value(self, summary: Summary, row: str = "") -> float | None:
        """The number in SI units, that of a row where each has one; None without it."""
        key = self.key.replace("*", row).replace("predicted.achieved", "achieved")
        found: object = summary
        for name in key.split("."):
            found = found.get(name) if isinstance(found, Mapping) else None
        return found if isinstance(found, int | float) else None

    def cell(self, summary: Summary, row: str = "", finer: int = 0) -> str:
        """The number as tables show it under a title, a dash if there is none."""
        value = self.value(summary, row)
        scaled = None if value is None else self.scale * value
        return number(scaled, self.digits + finer)

    def words(self, value: float | None) -> str:
        """A number in SI units as text with its unit; empty if there is none."""
        if value is None:
            return ""
        return f"{self.scale * value:.{self.digits}f} {self.unit}".rstrip()


POSITION = Quantity("error.*.position", "at the end", "mm", 1e3, 2)
YAW = Quantity("error.*.yaw", "in yaw", "mrad", 1e3, 2)
MARGIN = Quantity("predicted.*.min_margin", "least margin", "mm", 1e3, 1, "margin")
SLIP = Quantity("predicted.*.slip", "slip", "mm", 1e3, 1, "slip", 11)
OF_ROWS = (  # beside where each row ends, and how far the physics ends off it
    Quantity("error.*.farthest", "at most", "mm", 1e3, 2, "at most"),
    MARGIN,
    SLIP,
    Quantity("predicted.*.slip_transition", "switch slip", "mm", 1e3, 1),
)
WRONG = Quantity("feedback.wrong", "wrongly thought", "mm", 1e3, 2)
CLAIMED = Quantity("feedback.claimed", "claimed error", "mm", 1e3, 2)
OF_WALKS = (
    Quantity("achieved.creep_floor", "creep floor", "mm", 1e3, 3),
    Quantity("contact_switches", "contact switches"),
    Quantity("contact_switches_achieved", "contact switches achieved"),
    Quantity("bounces", "bounces"),
    Quantity("path_length", "length of the path", "m", 1.0, 4),
    Quantity("distance_walked", "way walked", "m", 1.0, 4),
    Quantity("swing_travel", "swing of loaded groups", "rad", 1.0, 2),
    Quantity("air_travel", "swing in the air", "rad", 1.0, 2),
    WRONG,
    CLAIMED,
    Quantity("feedback.bound", "least error", "mm", 1e3, 2),
    *(
        Quantity(f"measured.{key}", f"off the measured {name}", "degrees", DEGREES, 2)
        for key, name in (
            ("joints", "joints, rms"),
            ("roll.off", "roll, at the end"),
            ("roll.farthest", "roll, at most"),
            ("pitch.off", "pitch, at the end"),
            ("pitch.farthest", "pitch, at most"),
        )
    ),
    Quantity("measured.contact", "contacts like the measured ones", "%", 100.0),
    Quantity("simulated_time", "simulated time", "s", 1.0, 2),
)
QUANTITIES = (POSITION, YAW, *OF_ROWS, *OF_WALKS)
COLUMNS = tuple(quantity for quantity in OF_ROWS if quantity.column)
LINES = tuple(quantity for quantity in OF_ROWS if not quantity.column)
WORDS = (
    "terms        margin: least distance of the centre of mass inside the support",
    "             slip: way that standing feet slide; switch slip: that while legs",
    "             lift and land; more in docs/glossary.md",
)
HEADS = "".join(f"{quantity.column:>{quantity.width}}" for quantity in COLUMNS)
HEADER = f"{'':13}{'ends at x, y [m], yaw [rad]':33}{'from the achieved end':23}{HEADS}"


def number(value: float | None, digits: int = 2) -> str:
    """A number for people; a dash if there is none."""
    if value is None:
        return NONE
    return f"{value:z,.{digits}f}".replace("-", MINUS)


def describe(summary: Summary) -> str:
    """The walk and its comparison with the predictions, in lines for a terminal."""
    text, how = summary.verdict_text, "played"
    if summary.goal:
        replan = ", replanned" if summary.replan else ""
        if summary.optimise != "none":
            replan = f", optimised for {summary.optimise}"
        how = f"steered by the {summary.steer} prediction{replan}"
    lines = [
        text[:1].upper() + text[1:],
        f"{summary.scenario}: {summary.robot}, {how}",
        *(f"{label:13}{words}" for label, words in _facts(summary)),
        "",
        HEADER,
        *_rows(summary),
        *_lines(summary),
        *WORDS,
        *_clearance(summary),
    ]
    return "\n".join(lines)


def describe_export(summary: Summary, played: Played, label: str) -> str:
    """An exported walk, played in the physics, beside where it should be."""
    ended = {key: played[key] for key in ("pose", "min_margin", "slip")}
    achieved = replace(summary.achieved, **ended)
    shown = replace(summary, achieved=achieved, error=played.error)
    rows = [_row(shown, row) for row in (GOAL, played.weighed.prediction)]
    return "\n".join([HEADER, *rows, _row(shown, ACHIEVED, label)])


def _facts(summary: Summary) -> Iterator[tuple[str, str]]:
    """What was planned, walked and noticed: a label, and words for it."""
    much = f"{summary.contact_switches} lift-offs and touchdowns"
    if summary.goal is None:
        yield "played", f"{much}, a predicted way of {summary.path_length:.3f} m"
    else:
        about = {"centred": "about rest"}.get(summary.stance, "on from their last end")
        others = {"lifted": "the others in the air"}.get(summary.fields, "all stand")
        how = f"{about}, {others} ({summary.fields} fields)"
        yield "strokes", f"standing legs swing {how}"
        yield (
            "planned",
            f"{summary.segments} segments, {much}, {summary.distance_walked:.3f} m to "
            f"walk for a path of {summary.path_length:.3f} m",
        )
    yield (
        "walked",
        f"{summary.contact_switches_achieved} lift-offs and touchdowns, "
        f"{summary.bounces} bounces, {summary.simulated_time:.1f} s simulated in "
        f"{summary.timing['simulate']:.1f} s",
    )
    if summary.fallback:
        yield "fell back", f"on the stratified plan: {summary.fallback}"
    if summary.least_time is not None:
        least = f"no plan that keeps as near takes less than {summary.least_time:.1f} s"
        yield "bounded", f"{least}, holds left out"
    if len(summary.missed) > 1:
        misses = ", then ".join(f"{1e3 * miss:.3g}" for miss in summary.missed)
        yield "corrected", f"the goal was missed by {misses} mm"
    found = [
        f"{1e3 * apart.position:.1f} mm and {apart.yaw:.3f} rad {name}"
        for name, apart in summary.deviation.items()
        if apart is not None and name != QUASI_STATIC.key
    ]
    if found:
        yield "deviation", f"from the path at most {', '.join(found)}"
    seconds, strokes = summary.per_metre.seconds, summary.per_metre.strokes
    if seconds is not None and strokes:
        took = f"{seconds:.0f} s and {strokes:.1f} rad of strokes"
        yield "per metre", f"{took} for each metre of the path"
    if (real := summary.measured) is not None:
        yield from (("measured", words) for words in _measured(real))
    if (sensed := summary.feedback) is not None:
        yield "thought", _thought(sensed)
    if saturated := summary.saturated_segments:
        yield "saturated", f"{saturated} segments scaled down to the joint range"
    if summary.goal and summary.fastest_swing < CAPPED * summary.swing_speed:
        capped = f"swing_acceleration caps the swing_speed of {summary.swing_speed:g}"
        yield "swings", f"at {summary.fastest_swing:.3g} rad/s at most: {capped}"
    if abs(down := summary.let_down) > MENTIONED:
        how = "let down onto" if down > 0 else "lifted out of"
        yield "start", f"{how} the floor by {1e3 * abs(down):.1f} mm"
    if summary.self_contacts:
        yield (
            "collided",
            f"parts of the robot touched each other {summary.self_contacts} times, "
            "which no prediction takes into account",
        )


def _measured(real: Real) -> Iterator[str]:
    """What was measured on a real robot, beside where it ended."""
    yield from real.done
    if real.spread is not None:
        x, y, yaw = real.spread
        how = f"{1e3 * x:.1f} and {1e3 * y:.1f} mm, {degrees(yaw):.2f} degrees"
        yield f"standard error of its end {how}"
    if real.joints is not None:
        yield f"joints {degrees(real.joints):.2f} degrees rms off the simulated ones"
    for name, lean in (("roll", real.roll), ("pitch", real.pitch)):
        if lean is not None:
            yield (
                f"{name} {degrees(lean.end):.2f} degrees at the end, "
                f"{degrees(lean.off):.2f} off the simulated one, and "
                f"{degrees(lean.farthest):.2f} at most"
            )
    if real.contact is not None:
        yield f"contacts are those of the physics in {100 * real.contact:.0f} %"


def _thought(sensed: Sensed) -> str:
    """What feedback made of the walk, before the reading at its end."""
    if not sensed.sees_position:
        return (
            f"to be where it was {1e3 * sensed.wrong:.1f} mm away: its position is "
            "never seen, and nothing is promised of it"
        )
    wrong, claimed, least = (
        f"{1e3 * sensed[key]:.2f} mm and {degrees(sensed[f'{key}_yaw']):.2f} degrees"
        for key in ("wrong", "claimed", "bound")
    )
    return f"{wrong} off where it was; it claimed {claimed}, the least can be {least}"


def _rows(summary: Summary) -> Iterator[str]:
    for row, label in ROWS.items():
        if why := summary.unpredicted.get(row):
            yield f"{label:13}{why}"
        elif text := _row(summary, row):
            yield text


def _row(summary: Summary, row: str, label: str = "") -> str:
    """Where a row of the comparison ends, and how far the physics ends off it."""
    if (pose := summary.poses.get(row)) is None:
        return ""
    x, y, yaw = pose
    end = f"{x:z8.4f} {y:z8.4f} {yaw:z8.4f}"
    off, length = "", summary.path_length
    if (error := summary.error.get(row)) is not None:
        share = f"{error.position / length:6.2%}" if length else f"{'':6}"
        off = f"{1e3 * error.position:6.2f} mm {share} {error.yaw:7.4f} rad"
    cells = (f"{q.words(q.value(summary, row)):>{q.width}}" for q in COLUMNS)
    return f"{label or ROWS[row]:13}{end:28}{off:28}{''.join(cells)}".rstrip()


def _lines(summary: Summary) -> Iterator[str]:
    """What is ignored, and quantities without a column: of the rows, of the walk."""
    if summary.ignored:
        yield f"{'ignored':13}{summary.ignored}"
    for quantity in LINES:
        values = {label: quantity.value(summary, row) for row, label in ROWS.items()}
        words = (f"{quantity.words(v)} {k}" for k, v in values.items() if v is not None)
        if found := ", ".join(words):
            yield f"{quantity.label:12} {found}"
    for quantity in OF_WALKS:
        if quantity.line and (found := quantity.words(quantity.value(summary))):
            yield f"{quantity.label:12} {found}"


def _clearance(summary: Summary) -> Iterator[str]:
    """Distance from obstacles, where there are any."""
    predicted = summary.predicted.get(prediction_key(summary.steer))
    achieved = summary.achieved.min_clearance
    if achieved is None or predicted is None or predicted.min_clearance is None:
        return
    yield ""
    yield (
        f"{'clearance':13}{1e3 * predicted.min_clearance:.1f} mm predicted, "
        f"{1e3 * achieved:.1f} mm achieved, {summary.wall_contacts} wall contacts"
    )
