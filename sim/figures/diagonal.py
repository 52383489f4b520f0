"""Fig. 8: footprints along a diagonal, turning a quarter on the way."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from planner import Array, line
from sim.figures.paper import PaperWalk, configuration, feet, standing, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Shown
from sim.figures.style import IDEAL, INK, LEGS, MM, NOMINAL, TRIPODS
from sim.palette import GROUPS, Style

GOAL = (4.0, 4.0, math.pi / 2)
PAPER_SEGMENTS = 12
PALEST = 0.2  # strength of the colour of the first footprint; the last has all of it
MARKERS = {"1": "^", "2": "v"}
WALKS = {"diagonal": Job("diagonal", cost=4)}


@dataclass(frozen=True)
class Footprints:
    """Stays of feet on the ground, in time order for each foot."""

    foot: Array  # index of the foot, (K,)
    begin: Array  # first row of the stay, (K,)
    end: Array  # last row, (K,)
    place: Array  # of the foot in the middle of the stay, (K, 2)
    slid: Array  # distance from its first place to its last, (K,)


def footprints(points: Array, contact: Array) -> Footprints:
    """Stays of all feet, from places (T, F, 2) and contact (T, F)."""
    change = np.diff(contact.T.astype(np.int8), prepend=0, append=0)  # (F, T + 1)
    foot, begin = np.nonzero(change > 0)
    end = np.nonzero(change < 0)[1] - 1
    slid = points[end, foot] - points[begin, foot]
    place = points[(begin + end) // 2, foot]
    return Footprints(foot, begin, end, place, slid=np.hypot(*slid.T))


def paper(axes: Mapping[str, Axes]) -> Shown:
    """With l = 1, feet standing still."""
    path = line(configuration((0, 0, 0)), configuration(GOAL))
    walked = walk(path, PAPER_SEGMENTS, fields="lifted")
    prints = footprints(feet(walked), standing(walked))
    _draw_tripods(axes["a"], prints)
    _draw_walk(axes["b"], walked)
    rows = []
    for tripod, leg, of in _legs(prints):
        first, last = prints.place[of][0].tolist(), prints.place[of][-1].tolist()
        slid = float(prints.slid[of].max())
        rows.append((tripod, leg, int(of.sum()), *first, *last, slid))
    return Shown(rows, {"segments": PAPER_SEGMENTS})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The scenario `diagonal` in the physics."""
    walked = walks["diagonal"]
    planned, found = (
        footprints(walked.feet[name], walked.contact[name])
        for name in ("planned", "achieved")
    )
    _draw_both(axes["a"], planned, found)
    apart = matched(planned, found)
    _draw_over_time(axes["b"], planned, apart)
    _draw_over_time(axes["c"], planned, found.slid, planned.slid)
    rows = []
    for tripod, leg, of in _legs(planned):
        slides = float(planned.slid[of].max()), float(found.slid[of].max())
        off = float(apart[of].mean()), float(apart[of].max())
        rows.append((tripod, leg, int(of.sum()), *off, *slides))
    return Shown(rows, {"count": len(planned.foot)})


def _legs(prints: Footprints) -> Iterator[tuple[str, int, Array]]:
    """Tripod, leg, and which of the prints are the leg's."""
    for tripod, legs in LEGS.items():
        for leg in legs:
            yield tripod, leg, prints.foot == leg - 1


def _tripods(prints: Footprints) -> Iterator[tuple[str, Array]]:
    """Tripod, and which of the prints are its feet's."""
    for tripod, legs in LEGS.items():
        yield tripod, np.isin(prints.foot, np.array(legs) - 1)


def matched(planned: Footprints, found: Footprints) -> Array:
    """Distance of each planned print from the one found in its place, (K,) [m]."""
    if not np.array_equal(planned.foot, found.foot):
        counts = f"{len(found.foot)} footprints found for {len(planned.foot)}"
        raise ValueError(f"{counts} planned")
    return np.hypot(*(found.place - planned.place).T)


def _draw_both(axes: Axes, planned: Footprints, found: Footprints) -> None:
    for tripod, of in _tripods(planned):
        label = f"tripod {tripod}, planned"
        _draw_prints(axes, tripod, planned, of, MARKERS[tripod], 4.5, label, scale=MM)
        label = f"tripod {tripod}, found"
        _draw_prints(axes, tripod, found, of, ".", 2.0, label, filled=True, scale=MM)
    for tripod, leg, of in _legs(planned):
        _number(axes, leg, MM * planned.place[of][0], TRIPODS[tripod])


def _draw_prints(
    axes: Axes,
    tripod: str,
    prints: Footprints,
    of: Array,
    marker: str,
    size: float,
    label: str,
    *,
    filled: bool = False,
    scale: float = 1.0,
) -> None:
    """Prints of a tripod, darker with time."""
    strength = PALEST + (1 - PALEST) * prints.begin[of] / prints.begin.max()
    colour = GROUPS[[*TRIPODS].index(tripod)]
    shades = [colour.tint(share).hex for share in strength.tolist()]
    fill: Style = {"color": shades} if filled else {"ec": shades, "fc": "none"}
    x, y = scale * prints.place[of].T
    width = 0 if filled else 0.5
    axes.scatter(x, y, s=size**2, marker=marker, linewidths=width, **fill)
    key: Style = {"color": TRIPODS[tripod], "markersize": size, "markeredgewidth": 0.5}
    face = TRIPODS[tripod] if filled else "none"
    axes.plot([], [], marker, mfc=face, label=label, **key)


def _number(axes: Axes, leg: int, place: Array, colour: str) -> None:
    x, y = place
    axes.annotate(
        str(leg), (x, y), (-4, -4), textcoords="offset points", ha="right", va="top",
        color=colour, fontsize=8, fontweight="bold", zorder=4,
        bbox={"boxstyle": "circle,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8},
    )  # fmt: skip


def _draw_over_time(
    axes: Axes, planned: Footprints, values: Array, ideal: Array | None = None
) -> None:
    """A length of each print in the order of time, and ideally."""
    for tripod, of in _tripods(planned):
        order = np.argsort(planned.begin[of])
        stays = np.arange(of.sum()) / len(LEGS[tripod])
        style: Style = {"markersize": 2.5, "color": TRIPODS[tripod]}
        style |= {"markeredgewidth": 0, "label": f"tripod {tripod}"}
        axes.plot(stays, MM * values[of][order], MARKERS[tripod], **style)
        if ideal is not None:
            dots: Style = {"color": INK, "markersize": 1.5, "markeredgewidth": 0}
            name = "ideal" if tripod == "1" else "_"
            axes.plot(stays, MM * ideal[of][order], ".", label=name, **dots)


def _draw_tripods(axes: Axes, prints: Footprints) -> None:
    for tripod, leg, of in _legs(prints):
        places = prints.place[of]
        axes.plot(*places.T, color=TRIPODS[tripod], linewidth=0.3, alpha=0.5)
        _number(axes, leg, places[0], TRIPODS[tripod])
    for tripod, of in _tripods(prints):
        label = f"tripod {tripod}, legs {'-'.join(map(str, LEGS[tripod]))}"
        _draw_prints(axes, tripod, prints, of, MARKERS[tripod], 3.0, label, filled=True)


def _draw_walk(axes: Axes, walked: PaperWalk) -> None:
    axes.plot([0, GOAL[0]], [0, GOAL[1]], "--", color=NOMINAL, label="nominal")
    axes.plot(*walked.states[:, :2].T, color=IDEAL, linewidth=0.8, label="body centre")
    x, y, yaw = walked.states[np.concatenate([[0], walked.ends])][:, :3].T
    arrows: Style = {"angles": "xy", "scale_units": "xy", "scale": 2, "width": 0.004}
    axes.quiver(x, y, np.cos(yaw), np.sin(yaw), color=INK, zorder=3, **arrows)
