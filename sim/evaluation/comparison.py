"""The comparison of predictions and physics as text, from a summary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

HEADER = (
    f"{'':13}{'ends at x, y [m], yaw [rad]':28}{'physics ends off by':^30}"
    f"{'at most':>8}{'margin':>10}{'slip':>11}"
)
CAPPED = 0.9  # of the speed asked for; strokes that come to less are told
TOLD = 1e-3  # [m]; a robot that is moved farther at its start is told
PREDICTIONS = {
    "ideal": "ideal",
    "quasi_static": "quasi-static",
    "identified": "identified",
}


def describe(summary: Mapping[str, Any]) -> str:
    """The walk and its comparison with the predictions, in lines for a terminal.

    Args:
        summary: Contents of summary.json.
    """
    return "\n".join(
        [
            _verdict(summary),
            *_headline(summary),
            "",
            HEADER,
            *_rows(summary),
            *_clearance(summary),
        ]
    )


def describe_export(summary: Mapping[str, Any], played: Mapping[str, Any]) -> str:
    """An exported walk, played in the physics, beside where it should be.

    Args:
        summary: Contents of the walk's summary.json.
        played: What `sim.export` found when it played the export.
    """
    off, length = played["error"], summary["path_length"]
    predicted = summary["predicted"]["quasi_static"]
    rows = [_row("goal", summary["goal"], _off(off["goal"], length))]
    if predicted is not None:
        by = _off(off["quasi_static"], length)
        rows.append(_row("quasi-static", predicted["pose"], by, predicted))
    return "\n".join([HEADER, *rows, _row("exported", played["pose"], "", played)])


def _verdict(summary: Mapping[str, Any]) -> str:
    """The verdict as the first line; a walk of an old folder has none."""
    text: str = summary.get("verdict_text", "not judged")
    return text[:1].upper() + text[1:]


def _headline(summary: Mapping[str, Any]) -> list[str]:
    replan = ", replanned" if summary["replan"] else ""
    if summary.get("optimise", "none") != "none":
        replan = f", optimised for {summary['optimise']}"
    lines = [
        f"{summary['scenario']}: {summary['robot']}, {summary['fields']} fields, "
        f"{summary['stance']} stance, steered on {summary['steer']}{replan}",
        f"{'planned':13}{summary['segments']} segments, {summary['contact_switches']} "
        f"contact switches, {summary['distance_walked']:.3f} m to walk for a path of "
        f"{summary['path_length']:.3f} m",
        f"{'walked':13}{summary['contact_switches_achieved']} contact switches, "
        f"{summary['bounces']} bounces, {summary['simulated_time']:.1f} s simulated in "
        f"{summary['timing']['simulate']:.1f} s",
    ]
    if fallback := summary.get("fallback"):
        lines.append(f"{'fell back':13}on the stratified plan: {fallback}")
    if len(missed := summary.get("missed", ())) > 1:
        misses = ", then ".join(f"{1e3 * miss:.3g}" for miss in missed)
        lines.append(f"{'corrected':13}the goal was missed by {misses} mm")
    lines += _strays(summary)
    if summary["saturated_segments"]:
        scaled = "segments scaled down to the joint range"
        lines.append(f"{'saturated':13}{summary['saturated_segments']} {scaled}")
    if summary.get("fastest_swing", 0) < CAPPED * summary.get("swing_speed", 0):
        lines.append(
            f"{'swings':13}at {summary['fastest_swing']:.3g} rad/s at most: "
            f"swing_acceleration caps the swing_speed of {summary['swing_speed']:g}"
        )
    if abs(down := summary.get("let_down", 0.0)) > TOLD:
        how = "let down onto" if down > 0 else "lifted out of"
        lines.append(f"{'start':13}{how} the floor by {1e3 * abs(down):.1f} mm")
    if touched := summary.get("self_contacts"):
        lines.append(
            f"{'collided':13}parts of the robot touched each other {touched} "
            "times, which no prediction takes into account"
        )
    return lines


def _strays(summary: Mapping[str, Any]) -> list[str]:
    """Deviation from the nominal path, and what a metre of it takes."""
    if "deviation" not in summary:
        return []
    told = [
        f"{1e3 * found['position']:.1f} mm and {found['yaw']:.3f} rad {name}"
        for name, found in summary["deviation"].items()
        if found is not None and name != "quasi_static"
    ]
    lines = [f"{'strays':13}{', '.join(told)}"]
    if (each := summary["per_metre"])["seconds"] is not None:
        lines.append(
            f"{'a metre':13}takes {each['seconds']:.0f} s and "
            f"{each['strokes']:.1f} rad of strokes"
        )
    return lines


def _rows(summary: Mapping[str, Any]) -> list[str]:
    off, predicted = summary["error"], summary["predicted"]
    rows = [_row("goal", summary["goal"], _off(off["goal"], summary["path_length"]))]
    for key, name in PREDICTIONS.items():
        if why := summary.get("unpredicted", {}).get(key):
            rows.append(f"{name:13}{why}")
        elif predicted.get(key) is not None:
            by = _off(off[key], summary["path_length"])
            rows.append(_row(name, predicted[key]["pose"], by, predicted[key]))
    achieved = summary["achieved"]
    return [*rows, _row("achieved", achieved["pose"], "", achieved)]


def _clearance(summary: Mapping[str, Any]) -> list[str]:
    """Distance from obstacles, where there are any."""
    achieved = summary["achieved"].get("min_clearance")
    if achieved is None:
        return []
    predicted = summary["predicted"][summary["steer"].replace("-", "_")]
    return [
        "",
        f"{'clearance':13}{1e3 * predicted['min_clearance']:.1f} mm predicted, "
        f"{1e3 * achieved:.1f} mm achieved, {summary['wall_contacts']} wall contacts",
    ]


def _row(
    name: str, pose: Any, off: str, along: Mapping[str, float] | None = None
) -> str:
    x, y, yaw = pose
    end = f"{x:z8.4f} {y:z8.4f} {yaw:z8.4f}"
    way = "" if along is None else _way(along)
    return f"{name:13}{end:28}{off:38}{way}".rstrip()


def _off(error: Mapping[str, float], path_length: float) -> str:
    share = f"{error['position'] / path_length:6.2%}" if path_length else f"{'':6}"
    farthest = f"{1e3 * error['farthest']:7.2f} mm" if "farthest" in error else ""
    end = f"{1e3 * error['position']:6.2f} mm {share} {error['yaw']:7.4f} rad"
    return f"{end:28}{farthest}"


def _way(along: Mapping[str, float]) -> str:
    return f"{1e3 * along['min_margin']:7.1f} mm{1e3 * along['slip']:8.1f} mm"
