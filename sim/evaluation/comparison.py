"""The comparison of predictions and physics as text, from a summary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import degrees

from sim.evaluation.quantities import ACHIEVED, GOAL, OF_ROWS, OF_WALKS, ROWS
from sim.evaluation.summary import Departure, Played, Real, Sensed, Summary
from sim.scenarios.predictions import QUASI_STATIC, prediction_key

CAPPED = 0.9  # of the speed asked for; strokes that come to less are mentioned
MENTIONED = 1e-3  # [m]; a robot that is moved farther at its start is mentioned
COLUMNS = tuple(quantity for quantity in OF_ROWS if quantity.column)
LINES = tuple(quantity for quantity in OF_ROWS if not quantity.column)
WORDS = (
    "words        margin: least distance of the centre of mass inside the support",
    "             slip: way that standing feet slide; more in docs/glossary.md",
)
HEADS = "".join(f"{quantity.column:>{quantity.width}}" for quantity in COLUMNS)
HEADER = f"{'':13}{'ends at x, y [m], yaw [rad]':33}{'from the achieved end':23}{HEADS}"


def describe(summary: Summary) -> str:
    """The walk and its comparison with the predictions, in lines for a terminal."""
    text = summary.verdict_text
    replan = ", replanned" if summary.replan else ""
    if summary.optimise != "none":
        replan = f", optimised for {summary.optimise}"
    how = f"steered by the {summary.steer} prediction{replan}"
    lines = [
        text[:1].upper() + text[1:],
        f"{summary.scenario}: {summary.robot}, {how if summary.goal else 'played'}",
        *(f"{label:13}{words}" for label, words in _facts(summary)),
        "",
        HEADER,
        *_rows(summary),
        *_ignored(summary),
        *_lines(summary),
        *WORDS,
        *_clearance(summary),
    ]
    return "\n".join(lines)


def strokes_in_words(fields: str, stance: str) -> str:
    """How groups of legs swing under load, by the names of fields and stance."""
    about = {"centred": "centred on rest"}
    others = {"lifted": "others in the air (lifted fields)"}
    where = about.get(stance, "from where the last one ended")
    return f"{where}, {others.get(fields, 'all feet down (paper fields)')}"


def describe_export(summary: Summary, played: Played, label: str) -> str:
    """An exported walk, played in the physics, beside where it should be."""
    ended = {key: played[key] for key in ("pose", "min_margin", "slip")}
    shown = replace(
        summary, achieved=replace(summary.achieved, **ended), error=played.error
    )
    rows = [_row(shown, row) for row in (GOAL, played.weighed.prediction)]
    return "\n".join([HEADER, *rows, _row(shown, ACHIEVED, label)])


def _facts(summary: Summary) -> Iterator[tuple[str, str]]:
    """What was planned, walked and noticed: a label, and words for it."""
    much = f"{summary.contact_switches} lift-offs and touchdowns"
    if summary.goal is None:
        yield "played", f"{much}, a predicted way of {summary.path_length:.3f} m"
    else:
        how = strokes_in_words(summary.fields, summary.stance)
        yield "strokes", f"swings of legs that stand, {how}"
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
    found = ", ".join(
        f"{1e3 * apart.position:.1f} mm and {apart.yaw:.3f} rad {name}"
        for name, apart in summary.deviation.items()
        if apart is not None and name != QUASI_STATIC.key
    )
    if found:
        yield "deviation", f"from the path at most {found}"
    seconds, strokes = summary.per_metre.seconds, summary.per_metre.strokes
    if seconds is not None and strokes:
        yield (
            "a metre",
            f"of path takes {seconds:.0f} s and {strokes:.1f} rad of strokes",
        )
    if (real := summary.measured) is not None:
        yield from (("measured", words) for words in _measured(real))
    if (sensed := summary.feedback) is not None:
        yield "thought", _thought(sensed)
    if saturated := summary.saturated_segments:
        yield "saturated", f"{saturated} segments scaled down to the joint range"
    if summary.goal and summary.fastest_swing < CAPPED * summary.swing_speed:
        yield (
            "swings",
            f"at {summary.fastest_swing:.3g} rad/s at most: "
            f"swing_acceleration caps the swing_speed of {summary.swing_speed:g}",
        )
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
    if real.contact is not None:
        yield f"contacts are those of the physics in {100 * real.contact:.0f} %"


def _thought(sensed: Sensed) -> str:
    """What feedback made of the walk, before the reading at its end."""
    if not sensed.sees_position:
        return (
            f"to be where it was {1e3 * sensed.wrong:.1f} mm away: its position is "
            "never seen, and nothing is promised of it"
        )
    pairs = (
        (sensed.wrong, sensed.wrong_yaw),
        (sensed.claimed, sensed.claimed_yaw),
        (sensed.bound, sensed.bound_yaw),
    )
    wrong, claimed, least = (
        f"{1e3 * position:.2f} mm and {degrees(yaw):.2f} degrees"
        for position, yaw in pairs
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
    off = _off(summary.error.get(row), summary.path_length)
    cells = (f"{q.words(q.value(summary, row)):>{q.width}}" for q in COLUMNS)
    return f"{label or ROWS[row]:13}{end:28}{off:28}{''.join(cells)}".rstrip()


def _off(error: Departure | None, path_length: float) -> str:
    if error is None:
        return ""
    share = f"{error.position / path_length:6.2%}" if path_length else f"{'':6}"
    return f"{1e3 * error.position:6.2f} mm {share} {error.yaw:7.4f} rad"


def _ignored(summary: Summary) -> Iterator[str]:
    """Which predictions know nothing of which settings."""
    if text := summary.ignored:
        yield f"{'ignored':13}{text}"


def _lines(summary: Summary) -> Iterator[str]:
    """Quantities that have no column: those of the rows, then those of the walk."""
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
