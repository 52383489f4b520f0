"""Fig. 9: through an L-shaped passage that a coarse plan would not fit through."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely

from models.shapes import KAPPA, PIVOT
from planner.paths import Path, recut
from planner.subdivide import Leeway, subdivide
from sim.figures.paper import PaperWalk, walk
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.style import (
    IDEAL,
    MM,
    NEAR_WALL,
    NOMINAL,
    PATHS,
    PHYSICS,
    WALL,
    as_map,
    draw_walk,
    letter,
    sheet_of,
)
from sim.obstacles.clearance import Surroundings, surroundings
from sim.scenario_file import load
from sim.setup import prepare

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = np.ndarray

COARSE_SEGMENTS = 24  # the fewest that keep the robot's joint range
LEAST = 0.005 / PIVOT  # clearance to keep [l], as the scenario asks for
SHOWN = 4  # outlines drawn along the way
PANELS = (("a", "c"), ("b", "d"))  # a map, and the course of clearance below it
SHARE = np.linspace(0, 1, 301)
SAMPLES = 6  # states looked at a flow

PAPER_CAPTION = """
Body centre and outlines on eqs. (16) to (18), l = 1, through an L-shaped passage,
turning uniformly by a quarter. Dark: walls. Light: where the centre is so close to a
wall that some heading would hit it. Outlines: a few places on the way, and the closest
one. (a) {coarse} segments hit the walls and overlap them by {hit:.2f} l. (b) Only the
segments whose tube is too wide are cut further, {fine} in all, until the swept outline
stays {least:.3f} l clear. (c), (d) Clearance along the way; the nominal path, legs at
rest, allows what the tube then takes away. The paper gives no dimensions: passage, path
and outline are those of the scenario `corridor` and the robot `hexapod`, measured in
the distance of its pivots (l = 67.5 mm).
"""
METRES_CAPTION = """
The scenario `corridor` in the physics, steered on the quasi-static prediction, open
loop: a passage 0.46 m wide, where `hexapod` needs 0.485 m to turn on the spot. (a) Body
centre and outlines in {fine} segments, no wall touched. (b) The same with the {coarse}
segments that the joint range alone asks for: {contacts} wall contacts. (c), (d)
Clearance of the outline, predicted and achieved. In (a) the plan keeps {least:.1f} mm
along the prediction; {achieved:.1f} mm were achieved. In (b) the physics stops at the
walls that the prediction goes through.
"""
WALKS = {
    "corridor": Job("corridor"),
    "corridor-coarse": Job("corridor", {"min_clearance": -1}),
}


@dataclass(frozen=True)
class Passage:
    """The scenario's passage, and walks through it on the paper's kinematics."""

    around: Surroundings
    path: Path  # in pivots' distances

    def qpos(self, pose: Array, phi: Array) -> Array:
        """The robot's joint positions at states, shape (T, nq)."""
        swing = phi / KAPPA  # the robot's legs turn farther for the same way
        metres = pose * (PIVOT, PIVOT, 1.0)
        return self.around.outline.configurations(metres, swing, np.zeros_like(phi))

    def clearance(self, pose: Array, phi: Array) -> tuple[Array, Array]:
        """Clearance at states and a lower bound up to each from the one before, [l].

        Args:
            pose: Shape (T, 3), lengths in pivots' distances.
            phi: Angles of the paper's legs, shape (T, 2).
        """
        sweep = self.around.sweep(self.qpos(pose, phi))
        least = sweep.least / PIVOT
        bound = np.concatenate([least[:1], sweep.bound / PIVOT])
        return least, np.minimum(least, bound)

    def through(self, cuts: Array, samples: int = SAMPLES) -> PaperWalk:
        """A walk along the path divided at the cuts, with states for each flow."""
        return walk(recut(self.path, cuts), len(cuts) - 1, samples=samples)

    def leeway(self, cuts: Array) -> Leeway:
        """What a walk leaves of the least clearance, and what the nominal path does."""
        walked = self.through(cuts)
        segment = np.searchsorted(walked.ends, np.arange(len(walked.states)))
        _, bound = self.clearance(walked.states[:, :3], walked.states[:, 3:])
        walking = np.full(len(cuts) - 1, np.inf)
        np.minimum.at(walking, segment, bound)
        s = np.linspace(cuts[:-1], cuts[1:], 9, axis=1)  # (segments, 9)
        poses = self.path.at(s.ravel())
        standing, _ = self.clearance(poses[:, :3], poses[:, 3:])
        standing = standing.reshape(s.shape).min(axis=1)
        return Leeway("clearance", LEAST, standing - LEAST, walking - LEAST)

    @cached_property
    def fine(self) -> Array:
        """Cuts of the path that keep the clearance."""
        return subdivide(self.coarse, lambda cuts: [self.leeway(cuts)])

    @property
    def coarse(self) -> Array:
        """Cuts of the path to begin with."""
        return np.linspace(0.0, 1.0, COARSE_SEGMENTS + 1)


def passage() -> Passage:
    """The passage of the scenario, path and all, in the paper's units."""
    setup = prepare(load("corridor"))
    curve, scale = setup.scenario.path.curve, np.array([PIVOT, PIVOT, 1.0])

    def at(s: Array) -> Array:
        return np.pad(curve.at(s) / scale, ((0, 0), (0, 2)))

    return Passage(surroundings(setup), Path(at, curve.corners))


def paper() -> Sheet:
    """In pivots' distances: a coarse plan that hits, and one cut where it must be."""
    made = passage()
    walks = {"coarse": made.through(made.coarse), "fine": made.through(made.fine)}
    nominal = made.path.at(SHARE)
    standing, _ = made.clearance(nominal[:, :3], nominal[:, 3:])
    figure, axes = sheet_of("ab\ncd", 5.2, height_ratios=[2.4, 1])
    overlap = 0.0
    for (above, below), walked in zip(PANELS, walks.values(), strict=True):
        pose, phi = walked.states[:, :3], walked.states[:, 3:]
        least, _ = made.clearance(pose, phi)
        overlap = min(overlap, float(least.min()))
        draw_place(axes[above], made.around, made.qpos(pose, phi), least, 1 / PIVOT)
        axes[above].plot(*nominal[:, :2].T, "--", color=NOMINAL)
        axes[above].plot(*pose[:, :2].T, color=IDEAL, linewidth=0.6)
        as_map(axes[above], "$l$", "box")
        axes[below].plot(
            SHARE, standing, "--", color=NOMINAL, label="nominal path, standing"
        )
        axes[below].plot(walked.share, least, color=IDEAL, linewidth=0.6, label="walk")
        finish_clearance(axes[below], "$l$", "part of the segments", (-0.4, 1.1))
    counts = {name: len(w.plan.segment_ends) for name, w in walks.items()}
    label(axes, tuple(counts.values()))
    return Sheet(
        name="fig9-corridor-paper",
        title="Fig. 9, obstacles, in the paper's units",
        caption=words(PAPER_CAPTION, **counts, hit=-overlap, least=LEAST),
        figure=figure,
        table=_paper_table(made, walks),
    )


def label(axes: Mapping[str, Axes], segments: Sequence[int]) -> None:
    """Titles of the two maps and the two courses of clearance below them."""
    first, second = (f"{count} segments" for count in segments)
    below = ("clearance of (a)", "clearance of (b)")
    letter(axes, dict(zip("abcd", (first, second, *below), strict=True)))


def draw_place(
    axes: Axes, around: Surroundings, qpos: Array, clearance: Array, scale: float
) -> None:
    """Walls, where the robot's centre is too close to them, and its outlines."""
    outline = around.outline
    rest = outline.configurations(*(np.zeros((1, n)) for n in (3, 2, 2)))[0]
    near = shapely.buffer(around.area, outline.radius(rest))
    for area, colour in ((near, NEAR_WALL), (around.area, WALL)):
        _fill(axes, area, scale, facecolor=colour, edgecolor="none", zorder=0)
    closest = int(clearance.argmin())
    for row in (*np.linspace(0, len(qpos) - 1, SHOWN).astype(int), closest):
        _fill(
            axes, outline.area(qpos[row]), scale, facecolor="none", zorder=3,
            edgecolor=PHYSICS if row == closest else WALL,
            linewidth=1.0 if row == closest else 0.4,
        )  # fmt: skip
    x, y, right, top = scale * np.array(around.area.bounds)
    rim = 0.02 * (right - x)
    axes.set(xlim=(x - rim, right + rim), ylim=(y - rim, top + rim))
    axes.grid(visible=False)


def _fill(axes: Axes, area: shapely.Geometry, scale: float, **style: object) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    for polygon in getattr(area, "geoms", [area]):
        rings = [polygon.exterior, *polygon.interiors]
        paths = [Outline(scale * np.array(ring.coords)) for ring in rings]
        axes.add_patch(PathPatch(Outline.make_compound_path(*paths), **style))


def finish_clearance(
    axes: Axes, unit: str, along: str, limits: tuple[float, float]
) -> None:
    """Scales of a course of clearance, the walls' surface marked."""
    axes.axhline(0, color=WALL, linewidth=0.8)
    axes.set(xlabel=along, ylabel=f"clearance  [{unit}]", xlim=(0, 1), ylim=limits)
    axes.legend(loc="upper center", ncols=2)


def _paper_table(made: Passage, walks: Mapping[str, PaperWalk]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, cuts in (("coarse", made.coarse), ("fine", made.fine)):
        leeway = made.leeway(cuts)
        worst = int(leeway.walking.argmin())
        rows.append(
            (
                len(cuts) - 1,
                float(leeway.walking.min() + LEAST),
                float(cuts[worst]),
                float(leeway.standing.min() + LEAST),
                float(np.diff(cuts).min()),
                walks[name].error,
            )
        )
    return Table(
        header=(
            "segments",
            "least clearance [l]",
            "at s",
            "nominal path's [l]",
            "shortest segment, of s",
            "end error [l]",
        ),  # fmt: skip
        rows=tuple(rows),
    )


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The scenario as shipped, and with the segments that it starts from."""
    around = passage().around
    fine, coarse = made = [walks[name] for name in WALKS]
    figure, axes = sheet_of("ab\ncd", 5.2, height_ratios=[2.4, 1])
    for (above, below), walked in zip(PANELS, made, strict=True):
        achieved = walked.clearance["achieved"]
        draw_place(axes[above], around, walked.qpos, achieved, MM)
        draw_walk(axes[above], walked)
        as_map(axes[above], "mm", "box")
        share = np.linspace(0, 1, len(achieved))
        for name in ("achieved", "quasi_static"):
            colour, width, called = PATHS[name]
            course = MM * walked.clearance[name]
            axes[below].plot(share, course, color=colour, linewidth=width, label=called)
        finish_clearance(axes[below], "mm", "part of the time", (-15, 75))
    counts = [walked.segments for walked in made]
    label(axes, counts)
    return Sheet(
        name="fig9-corridor-metres",
        title="Fig. 9, obstacles, in metres",
        caption=words(
            METRES_CAPTION,
            fine=counts[0],
            coarse=counts[1],
            contacts=coarse.summary["wall_contacts"],
            least=MM * fine.clearance["quasi_static"].min(),
            achieved=MM * fine.clearance["achieved"].min(),
        ),
        figure=figure,
        table=_metres_table(made),
    )


def _metres_table(made: Sequence[Walked]) -> Table:
    rows = []
    for walked in made:
        summary, clearance = walked.summary, walked.clearance
        rows.append(
            (
                walked.segments,
                float(clearance["ideal"].min()),
                float(clearance["quasi_static"].min()),
                float(clearance["achieved"].min()),
                int(str(summary["wall_contacts"])),
                int(str(summary["contact_switches"])),
                float(walked.margin["achieved"].min()),
            )
        )
    header = (
        "segments", "least clearance, ideal [m]", "quasi-static [m]", "achieved [m]",
        "wall contacts", "contact switches", "least margin [m]",
    )  # fmt: skip
    return Table(header=header, rows=tuple(rows))
