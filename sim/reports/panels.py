"""Drawings over one time axis: errors, margin, slip, contacts and strata."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from models.description import root_body
from planner import Array
from sim import palette
from sim.evaluation.quantities import ROWS, number
from sim.motion.poses import lean_of
from sim.palette import ACHIEVED, PREDICTED, Style
from sim.reports import drawing
from sim.reports.drawing import MM, Drawing, Key
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MRAD = 1e3  # [mrad/rad]
LIMIT = palette.LIMIT.hex
STRATA = [palette.TEXT.tint(share).hex for share in (0.2, 0.35, 0.5, 0.65)]
"""Of strata on which several groups stand."""
DASHED, DOTTED = (3.7, 1.6), (1.0, 1.65)  # as matplotlib draws -- and :
ROUNDING = 1e-9  # of the largest value
COMB = 20  # segments, from which on curves look like combs
Curve = tuple[Array, Style, Key | None]  # its values, its look, its entry in the key


def panels(run: Run) -> Iterator[Drawing]:
    """All drawings over time, one by one, in the order of the page."""
    off = {name: MM * np.hypot(*run.error(name)[:, :2].T) for name in run.compared}
    turned = {name: MRAD * run.error(name)[:, 2] for name in run.compared}
    for values, heading in (
        (off, "Distance from each prediction [mm]"),
        (turned, "Error in yaw, off each prediction [mrad]"),
    ):
        curves = [
            (values[n], mark.line(linewidth=1.1), Key.of(mark, f"off {ROWS[n]}"))
            for n, mark in ((n, PREDICTED[n]) for n in values)
        ]
        yield _curves(run, heading, curves)
    yield from _leans(run)
    yield _margin(run)
    if run.clearance is not None:
        look = {"color": ACHIEVED.colour.hex}
        achieved = MM * run.clearance, look, Key.of(ACHIEVED, "achieved")
        limits = {0.0: ("--", "limit: contact")}
        yield _curves(run, "Clearance from obstacles [mm]", [achieved], limits=limits)
    yield _slip(run)
    yield _contacts(run)


def _curves(
    run: Run,
    heading: str,
    curves: Sequence[Curve],
    note: str = "",
    *,
    limits: Mapping[float, tuple[str, str]] | None = None,
    bottom: float | None = None,
) -> Drawing:
    """Curves over time with limits: style and label of level lines by their heights.

    Curves of long walks have bands of their extremes as well, which the page shows
    until it is zoomed. The axis begins at the bottom if given.
    """
    starts = drawing.stretches(run)
    edges = np.append(run.time[starts], run.time[-1])
    keys = [key for *_, key in curves if key]
    with drawing.sheet(1.55) as (figure, axes):  # [in]
        for values, style, _ in curves:
            rows = drawing.extremes(values)
            combed = run.segments >= COMB and _falls(values)
            gid = drawing.DETAIL if combed else None
            axes.plot(run.time[rows], values[rows], gid=gid, **style)
            if combed:
                low, high = drawing.extremes_between(values, starts)
                drawing.add_band(axes, edges, low, high, str(style["color"]))
        for height, (dashes, label) in (limits or {}).items():
            axes.axhline(height, color=LIMIT, ls=dashes, lw=1.0)
            keys.append(Key(label, LIMIT, DOTTED if dashes == ":" else DASHED))
        axes.set_xlim(run.time[0], run.time[-1])
        axes.set_ylim(bottom=bottom)
        return drawing.finish(figure, heading, keys, note)


def _falls(values: Array) -> bool:
    """Whether finite values fall anywhere; a sum never does."""
    if not np.isfinite(values).all():
        return False
    return bool(np.diff(values).min(initial=0) < -ROUNDING * values.max(initial=0))


def _leans(run: Run) -> Iterator[Drawing]:
    """Roll and pitch of the simulated, the predicted and the real robot."""
    for column, name in enumerate(("roll", "pitch")):
        if f"measured_{name}" not in run.arrays:
            continue
        root = root_body(run.model, run.model_file)
        address = int(run.model.jnt_qposadr[run.model.body_jntadr[root]])
        shown = [(lean_of(run.qpos, address)[:, column], ACHIEVED, "achieved")]
        shown += [
            (run.arrays[f"{key}_{name}"], mark, ROWS[key])
            for key, mark in PREDICTED.items()
            if f"{key}_{name}" in run.arrays
        ]
        curves: list[Curve] = [
            (MRAD * (angle - angle[run.walking.start]), m.line(), Key.of(m, label))
            for angle, m, label in shown
        ]
        yield _curves(run, f"{name.capitalize()} of the body [mrad]", curves)


def _margin(run: Run) -> Drawing:
    best, mark = PREDICTIONS[run.best], PREDICTED[run.best]
    look, key = {"color": ACHIEVED.colour.hex}, Key.of(mark, f"predicted, {best.label}")
    curves = [
        (MM * run.margin, look, Key.of(ACHIEVED, "achieved")),
        (MM * run.arrays[best.array("margin")], mark.line(), key),
    ]
    limits = {0.0: ("--", "limit: below 0 the robot tips over")}
    if asked := run.settings.get("min_margin"):
        limits[MM * asked] = ":", f"least that was asked for, {MM * asked:g} mm"
    least = number(MM * run.summary.achieved.min_margin, 1)
    note = f"The least margin of the walk is {least} mm."
    return _curves(run, "Static stability margin [mm]", curves, note, limits=limits)


def _slip(run: Run) -> Drawing:
    best, owners = PREDICTIONS[run.best], np.array(run.group_of_foot)
    curves: list[Curve] = []
    for i, group in enumerate(run.card.groups):
        colour, legs = palette.group(i).hex, np.array(run.legs)[owners == i]
        key = Key(f"group {group}, legs {', '.join(map(str, legs))}", colour)
        foreseen: Style = {"color": colour, "ls": ":", "lw": 0.9}
        for name, style, own in (
            ("slip", {"color": colour}, key),
            (best.array("slip"), foreseen, None),
        ):
            together = MM * run.arrays[name][:, owners == i].sum(axis=1)
            curves.append((together, style, own))
    note = drawing.NOTES["slip"].format(label=best.label)
    if (floor := run.summary.achieved.creep_floor) is not None:
        note += drawing.NOTES["creep"].format(floor=MM * floor)
    heading = "Slip of each group's feet together, since the start [mm]"
    return _curves(run, heading, curves, note, bottom=0)


def _contacts(run: Run) -> Drawing:
    """A row a foot, filled while it touches; below them the stratum."""
    feet, contact = len(run.legs), run.contact
    wrong = contact != run.arrays["planned_contact"]
    strata = sorted({p.stratum for p in run.phases}, key=lambda s: (-len(s), s))
    of_stratum = {s: _of_stratum(run, s, i) for i, s in enumerate(strata)}
    with drawing.sheet(0.17 * (feet + 1.6) + 0.34) as (figure, axes):  # [in]
        for i, leg in enumerate(run.legs):
            y = feet - i
            colour = palette.group(run.card.group_of_leg[leg]).hex
            _bars(axes, _spells(run, contact[:, i]), y - 0.36, 0.72, colour)
            _bars(axes, _spells(run, wrong[:, i]), y - 0.5, 0.14, LIMIT)
        for stratum, colour in of_stratum.items():
            spells = [(p.start, p.end) for p in run.phases if p.stratum == stratum]
            _bars(axes, np.array(spells), -0.45, 0.75, colour)
        labels = [*(f"leg {leg}" for leg in run.legs), "stratum"]
        axes.set_yticks([*range(feet, 0, -1), -0.08], labels)
        axes.grid(visible=False)
        axes.set_ylim(-0.6, feet + 0.6)
        axes.set_xlim(run.time[0], run.time[-1])
        shown = [
            *(
                (f"feet of group {g}", palette.group(i).hex)
                for i, g in enumerate(run.card.groups)
            ),
            *((f"stratum {name}", c) for name, c in of_stratum.items() if c in STRATA),
            ("not as planned", LIMIT),
        ]
        keys = [Key(label, colour, filled=True) for label, colour in shown]
        note = drawing.NOTES["contacts"]
        return drawing.finish(figure, "Contacts of the feet, and strata", keys, note)


def _bars(axes: "Axes", spells: Array, y: float, high: float, colour: str) -> None:
    """Bars of one row as a single shape, which a page draws and stores fastest."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    if not len(spells):
        return
    x = spells[:, [0, 1, 1, 0]]
    upright = np.broadcast_to([y, y, y + high, y + high], x.shape)
    shape = Path.make_compound_path_from_polys(np.stack([x, upright], axis=-1))
    axes.add_artist(PathPatch(shape, facecolor=colour, lw=0))


def _of_stratum(run: Run, stratum: str, index: int) -> str:
    """Colour of the only group that stands, else a grey."""
    standing = [i for i, name in enumerate(run.card.groups) if name in stratum]
    if len(standing) == 1:
        return palette.group(standing[0]).hex
    return STRATA[index % len(STRATA)]


def _spells(run: Run, flag: Array) -> Array:
    """Start and end of every time for which a flag holds, (n, 2) [s]."""
    edges = np.flatnonzero(np.diff(flag, prepend=False, append=False))
    return run.time[np.minimum(edges, len(run.time) - 1)].reshape(-1, 2)
