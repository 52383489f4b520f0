"""Fig. 9: an L-shaped passage in which a coarse plan collides.

In the paper's units the robot is `hexapod` on the paper's kinematics, measured in its
pivots' distance.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from models.morphology import KAPPA, PIVOT
from planner import Array, Path, subdivide
from planner.planning import Slack, recut
from sim import palette
from sim.figures import style
from sim.figures.paper import PaperWalk, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Shown
from sim.figures.style import IDEAL, MM, NOMINAL, PATHS
from sim.obstacles.clearance import Surroundings, surroundings
from sim.palette import Style
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario

COARSE_SEGMENTS = 24  # the scenario's own; 22 would leave the joint range
LEAST = 0.005 / PIVOT  # clearance to keep [l], as the scenario asks for
SWEEPS = 1600  # outlines that make up what is swept
PANELS = (("a", "c"), ("b", "d"))  # a map, and the course of clearance below it
SHARE = np.linspace(0, 1, 301)
WALL, OUTLINE = palette.OBSTACLE.hex, palette.OUTLINE.hex
MAGNIFIED = 0.025  # [m] to either side of where the path is magnified
WALKS = {
    "corridor-coarse": Job("corridor", {"min_clearance": -1, "steer": "ideal"}, cost=8),
    "corridor": Job("corridor", cost=16),
}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """In pivots' distances: a coarse plan that hits, and one cut where it must be."""
    made, rows = passage(), []
    for (above, below), cuts in zip(PANELS, (made.coarse, made.fine), strict=True):
        walked, slack = made.through(cuts), made.slack(cuts)
        nominal = recut(made.path, cuts).at(SHARE)
        (standing, _), (least, _) = map(made.clearance, (nominal, walked.states))
        qpos, at = made.qpos(walked.states), walked.states[least.argmin()]
        _draw_place(axes[above], made.around, qpos, least, 1 / PIVOT)
        line: Style = {"color": NOMINAL, "label": "nominal path", "zorder": 4}
        centre: Style = {"linewidth": 0.7, "label": "body centre, walked"}
        for panel in (axes[above], _magnified(axes[above], at[:2], MAGNIFIED / PIVOT)):
            panel.plot(*nominal[:, :2].T, "--", **line)
            panel.plot(*walked.states[:, :2].T, color=IDEAL, **centre)
        count = len(cuts) - 1
        course: Style = {"color": NOMINAL, "label": "nominal path, legs at rest"}
        axes[below].plot(0.5 + count * SHARE, standing, "--", **course)
        spread = style.extremes(least, walked.segment)
        style.band(axes[below], *spread, colour=IDEAL, alpha=0.5, label="walk")
        axes[below].set_xlim(0.5, count + 0.5)
        where, shortest = walked.share[least.argmin()], np.diff(cuts).min()
        bounds = slack.walking.min() + LEAST, slack.standing.min() + LEAST
        measured = least.min(), where, *bounds, shortest, walked.error
        rows.append((count, *map(float, measured)))
    counts: Style = {"coarse": rows[0][0], "fine": rows[1][0]}
    return Shown(rows, {**counts, "hit": -min(row[1] for row in rows), "least": LEAST})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The scenario as shipped, and with its initial number of segments."""
    around, rows = passage().around, []
    coarse, fine = made = [walks[name] for name in WALKS]
    for (above, below), walked in zip(PANELS, made, strict=True):
        clearance, summary = walked.clearance, walked.summary
        _draw_place(axes[above], around, walked.qpos, clearance["achieved"], MM)
        at = MM * walked.pose["achieved"][clearance["achieved"].argmin(), :2]
        for panel in (axes[above], _magnified(axes[above], at, MM * MAGNIFIED)):
            style.draw_walk(panel, walked)
        # Physics as a band, and the rims of the prediction's.
        achieved, predicted = (
            style.extremes(MM * walked.clearance[n], walked.segment)
            for n in ("achieved", "quasi_static")
        )
        colour = PATHS["achieved"]["color"]
        style.band(axes[below], *achieved, colour=colour, alpha=0.8, label="physics")
        segment = np.arange(1, walked.summary.segments + 1)
        for rim in predicted:
            axes[below].step(segment, rim, where="mid", **PATHS["quasi_static"])
        axes[below].lines[-1].set_label("_")
        axes[below].set_xlim(0.5, walked.summary.segments + 0.5)
        least = (clearance[n].min() for n in ("ideal", "quasi_static", "achieved"))
        counts = summary.wall_contacts, summary.contact_switches
        margin = float(walked.margin["achieved"].min())
        rows.append((walked.summary.segments, *map(float, least), *counts, margin))
    words = {
        "fine": fine.summary.segments,
        "coarse": coarse.summary.segments,
        "contacts": coarse.summary.wall_contacts,
        "least": MM * fine.clearance["quasi_static"].min(),
        "achieved": MM * fine.clearance["achieved"].min(),
    }
    return Shown(rows, words)


def _draw_place(
    axes: Axes, around: Surroundings, qpos: Array, clearance: Array, scale: float
) -> None:
    """Walls, what the robot sweeps, and its outline at three places."""
    outline = around.outline
    closest = int(clearance.argmin())
    rows = np.append(np.linspace(0, len(qpos) - 1, SWEEPS).astype(int), closest)
    swept = outline.solids.swept(qpos[rows])
    for area, colour, name in (
        (swept, palette.SWEPT.hex, "floor that it sweeps over"),
        (around.area, WALL, "walls"),
    ):
        _fill(axes, area, scale, facecolor=colour, edgecolor="none", zorder=0)
        axes.fill([], [], facecolor=colour, label=name)
    for row, colour, width, name in (
        (0, OUTLINE, 0.9, "_"),
        (-1, OUTLINE, 0.9, "robot at the start and at the end"),
        (closest, palette.LIMIT.hex, 1.2, "robot where it is closest to a wall"),
    ):
        axes.plot([], [], color=colour, linewidth=width, label=name)
        line: Style = {"facecolor": "none", "edgecolor": colour, "linewidth": width}
        _fill(axes, outline.solids.swept(qpos[[row]]), scale, zorder=3, **line)
    x, y, right, top = scale * np.array(around.area.bounds)
    rim = 0.02 * (right - x)
    axes.set(xlim=(x - rim, right + rim), ylim=(y - rim, top + rim))
    axes.grid(visible=False)


def _magnified(axes: Axes, middle: Array, half: float) -> Axes:
    """What is around a point, magnified in the corner that the robot never reaches."""
    x, y = middle
    limits: Style = {"xlim": (x - half, x + half), "ylim": (y - half, y + half)}
    part = axes.inset_axes((0.78, 0.06, 0.16, 0.16), xticks=[], yticks=[], **limits)
    part.grid(visible=False)
    part.spines[:].set(visible=True, color=NOMINAL)
    axes.indicate_inset_zoom(part, edgecolor=NOMINAL, alpha=1.0)
    return part


def _fill(axes: Axes, area: shapely.Geometry, scale: float, **look: object) -> None:
    for polygon in getattr(area, "geoms", [area]):
        rings = [polygon.exterior, *polygon.interiors]
        paths = [Outline(scale * np.array(ring.coords)) for ring in rings]
        axes.add_patch(PathPatch(Outline.make_compound_path(*paths), **look))


@dataclass(frozen=True)
class Passage:
    """The scenario's passage, and walks through it on the paper's kinematics."""

    around: Surroundings
    path: Path  # in pivots' distances

    def qpos(self, states: Array) -> Array:
        """The robot's joint positions at states of the paper's, shape (T, nq)."""
        swing = states[:, 3:] / KAPPA  # its legs turn farther for the same way
        metres = states[:, :3] * (PIVOT, PIVOT, 1.0)
        return self.around.outline.configurations(metres, swing, np.zeros_like(swing))

    def clearance(self, states: Array) -> tuple[Array, Array]:
        """Clearance at states and a lower bound up to each from the one before, [l]."""
        found = self.around.clearances(self.qpos(states))
        least = found.least / PIVOT
        bound = np.concatenate([least[:1], found.bound / PIVOT])
        return least, np.minimum(least, bound)

    def through(self, cuts: Array, samples: int = 6) -> PaperWalk:
        """A walk along the path divided at the cuts, with states for each flow."""
        return walk(recut(self.path, cuts), len(cuts) - 1, samples=samples)

    def slack(self, cuts: Array) -> Slack:
        """Slack of the least clearance along a walk, and along the nominal path."""
        walked = self.through(cuts)
        _, bound = self.clearance(walked.states)
        walking, _ = style.extremes(bound, walked.segment)
        s = np.linspace(cuts[:-1], cuts[1:], 9, axis=1)  # (segments, 9)
        standing, _ = self.clearance(self.path.at(s.ravel()))
        standing = standing.reshape(s.shape).min(axis=1)
        return Slack("clearance", LEAST, standing - LEAST, walking - LEAST)

    @cached_property
    def fine(self) -> Array:
        """Cuts of the path that keep the clearance."""
        return subdivide(self.coarse, lambda cuts: [self.slack(cuts)])

    coarse: ClassVar[Array] = np.linspace(0.0, 1.0, COARSE_SEGMENTS + 1)
    """Cuts of the path to begin with."""


def passage() -> Passage:
    """The passage of the scenario, path and all, in the paper's units."""
    setup = prepare(load_scenario("corridor"))
    curve, scale = setup.scenario.path.curve, np.array([PIVOT, PIVOT, 1.0])

    def at(s: Array) -> Array:
        return np.pad(curve.at(s) / scale, ((0, 0), (0, 2)))

    return Passage(surroundings(setup), Path(at, curve.corners))
