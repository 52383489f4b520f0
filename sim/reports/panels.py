"""Drawings over one time axis: errors, margin, slip, contacts and strata."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from planner import Array
from sim import palette
from sim.evaluation.quantities import number
from sim.palette import ACHIEVED, PREDICTED
from sim.reports.drawing import Drawing, Key, extremes, finish, sheet
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MM, MRAD = 1e3, 1e3
LIMIT = palette.LIMIT.hex
STRATA = [palette.TEXT.tint(share).hex for share in (0.2, 0.35, 0.5, 0.65)]
"""Of strata on which several groups stand."""
PANEL_HEIGHT = 1.55  # [in]
ROW = 0.17  # [in] of a foot


def panels(run: Run) -> Iterator[Drawing]:
    """All drawings over time, one by one, in the order of the page."""
    best = PREDICTIONS[run.best].label
    off = {name: MM * np.hypot(*run.error(name)[:, :2].T) for name in run.predicted}
    turned = {name: MRAD * run.error(name)[:, 2] for name in run.predicted}
    yield _errors(run, off, "Distance from each prediction [mm]")
    yield _components(run, f"Error in x and y, off the {best} prediction [mm]")
    yield _errors(run, turned, "Error in yaw, off each prediction [mrad]")
    yield _margin(run)
    if run.clearance is not None:
        yield _clearance(run, run.clearance)
    yield _slip(run)
    yield _contacts(run)


def _line(axes: Axes, run: Run, values: Array, **style: Any) -> None:
    rows = extremes(values)
    axes.plot(run.time[rows], values[rows], **style)


def _over_time(axes: Axes, run: Run) -> None:
    axes.set_xlim(run.time[0], run.time[-1])


def _errors(run: Run, values: Mapping[str, Array], heading: str) -> Drawing:
    with sheet(PANEL_HEIGHT) as (figure, axes):
        for name, curve in values.items():
            _line(axes, run, curve, **PREDICTED[name].line(linewidth=1.1))
        _over_time(axes, run)
        labels = {name: f"off {PREDICTIONS[name].label}" for name in values}
        keys = [Key.of(PREDICTED[name], label) for name, label in labels.items()]
        return finish(figure, heading, keys)


def _components(run: Run, heading: str) -> Drawing:
    error = MM * run.error(run.best)
    with sheet(PANEL_HEIGHT) as (figure, axes):
        colour = PREDICTED[run.best].colour
        pale = colour.tint(0.45)
        _line(axes, run, error[:, 0], color=colour.hex)
        _line(axes, run, error[:, 1], color=pale.hex, lw=0.9)
        _over_time(axes, run)
        keys = [Key("in x", colour.hex), Key("in y", pale.hex)]
        return finish(figure, heading, keys)


def _margin(run: Run) -> Drawing:
    margin = MM * run.margin
    foreseen = MM * run.arrays[PREDICTIONS[run.best].array("margin")]
    keys = [
        Key.of(ACHIEVED, "achieved"),
        Key.of(PREDICTED[run.best], f"predicted, {PREDICTIONS[run.best].label}"),
        Key("limit: below 0 it tips over", LIMIT, dashed=True),
    ]
    with sheet(PANEL_HEIGHT) as (figure, axes):
        _line(axes, run, margin, color=ACHIEVED.colour.hex)
        _line(axes, run, foreseen, **PREDICTED[run.best].line())
        axes.axhline(0.0, color=LIMIT, ls="--", lw=1.0)
        if asked := run.settings.get("min_margin"):
            axes.axhline(MM * asked, color=LIMIT, ls=":", lw=1.0)
            keys.append(
                Key(f"least that was asked for, {MM * asked:g} mm", LIMIT, True)
            )
        _over_time(axes, run)
        least = MM * run.summary.achieved.min_margin
        note = f"The least margin of the walk is {number(least, 1)} mm."
        return finish(figure, "Static stability margin [mm]", keys, note)


def _clearance(run: Run, clearance: Array) -> Drawing:
    with sheet(PANEL_HEIGHT) as (figure, axes):
        achieved = MM * clearance
        _line(axes, run, achieved, color=ACHIEVED.colour.hex)
        axes.axhline(0.0, color=LIMIT, ls="--", lw=1.0)
        _over_time(axes, run)
        limit = Key("limit: it touches", LIMIT, dashed=True)
        keys = [Key.of(ACHIEVED, "achieved"), limit]
        return finish(figure, "Clearance from obstacles [mm]", keys)


def _slip(run: Run) -> Drawing:
    achieved = MM * run.arrays["slip"]
    foreseen = MM * run.arrays[PREDICTIONS[run.best].array("slip")]
    with sheet(1.25 * PANEL_HEIGHT) as (figure, axes):
        colours = _legs(run)
        for i, colour in enumerate(colours):
            _line(axes, run, achieved[:, i], color=colour.hex)
            _line(axes, run, foreseen[:, i], color=colour.hex, ls=":", lw=0.9)
        _over_time(axes, run)
        axes.set_ylim(bottom=0)
        keys = [
            Key(f"leg {leg}", colour.hex)
            for leg, colour in zip(run.legs, colours, strict=True)
        ]
        note = f"Dotted lines are the {PREDICTIONS[run.best].label} prediction."
        if (floor := run.summary.achieved.creep_floor) is not None:
            note += (
                f" Standing still for as long, all feet together creep by "
                f"{MM * floor:.3g} mm: that much is the solver's."
            )
        return finish(figure, "Slip of each foot since the start [mm]", keys, note)


def _contacts(run: Run) -> Drawing:
    """A row a foot, filled while it touches; below them the stratum."""
    feet = len(run.legs)
    contact, planned = run.contact, run.arrays["planned_contact"]
    with sheet(ROW * (feet + 1.6) + 0.34) as (figure, axes):
        for i, leg in enumerate(run.legs):
            y = feet - i
            colour = palette.group(run.card.group_of_leg[leg]).hex
            _bars(axes, _spells(run, contact[:, i]), y - 0.36, 0.72, colour)
            wrong = _spells(run, contact[:, i] != planned[:, i])
            _bars(axes, wrong, y - 0.5, 0.14, LIMIT)
        for i, stratum in enumerate(_strata(run)):
            spells = [
                (p.start, p.end - p.start) for p in run.phases if p.stratum == stratum
            ]
            _bars(axes, spells, -0.45, 0.75, _of_stratum(run, stratum, i))
        axes.set_yticks(
            [*range(feet, 0, -1), -0.08],
            [*(f"leg {leg}" for leg in run.legs), "stratum"],
        )
        axes.grid(visible=False)
        axes.set_ylim(-0.6, feet + 0.6)
        _over_time(axes, run)
        keys = [
            *(Key(f"feet of group {name}", palette.group(i).hex, filled=True)
              for i, name in enumerate(run.groups)),
            *(Key(f"stratum {name}", _of_stratum(run, name, i), filled=True)
              for i, name in enumerate(_strata(run))),
            Key("not as planned", LIMIT, filled=True),
        ]  # fmt: skip
        note = (
            "A bar is a foot on the ground. A stratum is named after the groups that "
            "stand. Thin red bars are contacts that differ from the plan."
        )
        return finish(figure, "Contacts of the feet, and strata", keys, note)


def _bars(
    axes: Axes, spells: list[tuple[float, float]], y: float, high: float, colour: str
) -> None:
    """Bars of one row as a single shape, which a page draws and stores fastest."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    if not spells:
        return
    start, length = np.array(spells).T
    x = np.stack([start, start + length, start + length, start], axis=1)
    upright = np.broadcast_to([y, y, y + high, y + high], x.shape)
    corners = np.stack([x, upright], axis=-1)
    shape = Path.make_compound_path_from_polys(corners)
    axes.add_patch(PathPatch(shape, facecolor=colour, lw=0))


def _strata(run: Run) -> list[str]:
    """Strata that the walk visits, the one with all feet down first."""
    return sorted({p.stratum for p in run.phases}, key=lambda s: (-len(s), s))


def _of_stratum(run: Run, stratum: str, index: int) -> str:
    """Colour of the only group that stands, else a grey."""
    standing = [i for i, name in enumerate(run.groups) if name in stratum]
    if len(standing) == 1:
        return palette.group(standing[0]).hex
    return STRATA[index % len(STRATA)]


def _legs(run: Run) -> list[palette.Colour]:
    """Colour of each leg's curve, shades of its group's."""
    owners = [run.card.group_of_leg[leg] for leg in run.legs]
    return [
        palette.leg(owner, owners[:i].count(owner), owners.count(owner))
        for i, owner in enumerate(owners)
    ]


def _spells(run: Run, flag: Array) -> list[tuple[float, float]]:
    """Start and length of every time for which a flag holds [s]."""
    edges = np.diff(np.concatenate([[False], flag, [False]]).astype(int))
    starts, stops = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    ends = run.time[np.minimum(stops, len(run.time) - 1)]
    begun = run.time[starts]
    return list(zip(begun, ends - begun, strict=True))
