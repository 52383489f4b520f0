"""Fig. 9: an L-shaped passage in which a coarse plan collides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import shapely

from models.morphology import PIVOT
from planner import Array
from planner.planning import recut
from sim.figures.paper import PaperWalk
from sim.figures.passage import LEAST, Passage, passage
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.style import (
    IDEAL,
    MM,
    NOMINAL,
    PATHS,
    PHYSICS,
    SWEPT,
    WALL,
    as_map,
    band,
    draw_walk,
    extremes,
    letter,
    sheet_of,
)
from sim.obstacles.clearance import Surroundings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SWEEPS = 1600  # outlines that make up what is swept
PANELS = (("a", "c"), ("b", "d"))  # a map, and the course of clearance below it
SHARE = np.linspace(0, 1, 301)

PAPER_CAPTION = """
Body centre and outline on eqs. (16) to (18), l = 1, through an L-shaped passage,
turning uniformly by a quarter. Outlines of the body: at the start, at the end, and
(broad) where it is closest to a wall.
(a) {coarse} segments hit the walls and overlap them by {hit:.2f} l. (b) Only the
segments whose tube is too wide are cut further, {fine} in all, until the swept outline
stays {least:.3f} l clear. (c), (d) Clearance along the way, from the least to the
largest within each segment; the nominal path, legs at rest, allows what the tube then
takes away. The paper gives no dimensions: passage, path
and outline are those of the scenario `corridor` and the robot `hexapod`, measured in
the distance of its pivots (l = 67.5 mm).
"""
METRES_CAPTION = """
The scenario `corridor` in the physics, open loop: a passage 0.46 m wide, where
`hexapod` needs 0.485 m to turn on the spot. Outlines of the body: at the start, at the
end, and (broad) where it came closest to a wall. (a) The {coarse}
segments of the scenario uncut, not aimed, since that would leave the joint range:
{contacts} wall contacts. (b) {fine} segments, steered on the quasi-static prediction.
(c), (d) Clearance of the outline, from the least to the largest within each segment,
predicted and achieved. In (a) the physics stops at
the walls that the prediction goes through. In (b) the plan keeps {least:.1f} mm along
the prediction; {achieved:.1f} mm were achieved.
"""
WALKS = {
    "corridor-coarse": Job("corridor", {"min_clearance": -1, "steer": "ideal"}),
    "corridor": Job("corridor"),
}


def paper() -> Sheet:
    """In pivots' distances: a coarse plan that hits, and one cut where it must be."""
    made = passage()
    cuts = {"coarse": made.coarse, "fine": made.fine}
    walks = {name: made.through(divided) for name, divided in cuts.items()}
    figure, axes = sheet_of("ab\ncd", 5.6, height_ratios=[2.4, 1])
    overlap = 0.0
    for (above, below), (name, walked) in zip(PANELS, walks.items(), strict=True):
        pose, phi = walked.states[:, :3], walked.states[:, 3:]
        nominal = recut(made.path, cuts[name]).at(SHARE)
        standing, _ = made.clearance(nominal[:, :3], nominal[:, 3:])
        least, _ = made.clearance(pose, phi)
        overlap = min(overlap, float(least.min()))
        draw_place(axes[above], made.around, made.qpos(pose, phi), least, 1 / PIVOT)
        axes[above].plot(*nominal[:, :2].T, "--", color=NOMINAL, label="nominal path")
        axes[above].plot(
            *pose[:, :2].T, color=IDEAL, linewidth=0.7, label="body centre, walked"
        )
        as_map(axes[above], "$l$", "box")
        count = len(walked.plan.segment_ends)
        segment = np.searchsorted(walked.ends, np.arange(len(walked.states)))
        spread = extremes(least, segment, count)
        axes[below].plot(
            0.5 + count * SHARE, standing, "--", color=NOMINAL,
            label="nominal path, legs at rest",
        )  # fmt: skip
        band(axes[below], *spread, color=IDEAL, alpha=0.5, label="walk")
        finish_clearance(axes[below], "$l$", count, (-0.4, 1.1))
    key_below(figure, axes["a"])
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
    """Titles of the two maps and of the two plots of clearance below them."""
    coarse, fine = segments
    first = f"{coarse} segments, hits the walls"
    second = f"{fine} segments, stays clear of them"
    below = ("clearance of (a)", "clearance of (b)")
    letter(axes, dict(zip("abcd", (first, second, *below), strict=True)))


def draw_place(
    axes: Axes, around: Surroundings, qpos: Array, clearance: Array, scale: float
) -> None:
    """Walls, what the robot sweeps, and its outline at three places."""
    outline = around.outline
    closest = int(clearance.argmin())
    rows = np.linspace(0, len(qpos) - 1, SWEEPS).astype(int)
    swept = outline.solids.swept(qpos[np.append(rows, closest)])
    for area, colour, name in (
        (swept, SWEPT, "floor that it sweeps over"), (around.area, WALL, "walls"),
    ):  # fmt: skip
        _fill(axes, area, scale, facecolor=colour, edgecolor="none", zorder=0)
        axes.fill([], [], facecolor=colour, label=name)
    for row, colour, width, name in (
        (0, WALL, 0.5, "_"), (-1, WALL, 0.5, "robot at the start and at the end"),
        (closest, PHYSICS, 1.2, "robot where it is closest to a wall"),
    ):  # fmt: skip
        axes.plot([], [], color=colour, linewidth=width, label=name)
        _fill(
            axes, outline.solids.swept(qpos[[row]]), scale, facecolor="none", zorder=3,
            edgecolor=colour, linewidth=width,
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
    axes: Axes, unit: str, count: int, limits: tuple[float, float]
) -> None:
    """Scales of a plot of clearance, with the surface of the walls marked."""
    axes.axhline(0, color=WALL, linewidth=0.8)
    axes.set(xlabel="segment", ylabel=f"clearance  [{unit}]", ylim=limits)
    axes.set_xlim(0.5, count + 0.5)
    axes.legend(loc="upper center", ncols=2)


def key_below(figure: Figure, axes: Axes) -> None:
    """The key of a map below all panels."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)


def _paper_table(made: Passage, walks: Mapping[str, PaperWalk]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for name, cuts in (("coarse", made.coarse), ("fine", made.fine)):
        slack, walked = made.slack(cuts), walks[name]
        least, _ = made.clearance(walked.states[:, :3], walked.states[:, 3:])
        rows.append(
            (
                len(cuts) - 1,
                float(least.min()),
                float(walked.share[least.argmin()]),
                float(slack.walking.min() + LEAST),
                float(slack.standing.min() + LEAST),
                float(np.diff(cuts).min()),
                walked.error,
            )
        )
    return Table(
        header=(
            "segments",
            "least clearance [l]",
            "after this share of the segments",
            "no less between samples than [l]",
            "nominal path's, standing [l]",
            "shortest segment, of the path",
            "end error [l]",
        ),  # fmt: skip
        rows=tuple(rows),
    )


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The scenario as shipped, and with its initial number of segments."""
    around = passage().around
    coarse, fine = made = [walks[name] for name in WALKS]
    figure, axes = sheet_of("ab\ncd", 5.6, height_ratios=[2.4, 1])
    for (above, below), walked in zip(PANELS, made, strict=True):
        achieved = walked.clearance["achieved"]
        draw_place(axes[above], around, walked.qpos, achieved, MM)
        draw_walk(axes[above], walked)
        as_map(axes[above], "mm", "box")
        _draw_clearance(axes[below], walked)
    key_below(figure, axes["a"])
    label(axes, [walked.segments for walked in made])
    return Sheet(
        name="fig9-corridor-metres",
        title="Fig. 9, obstacles, in metres",
        caption=words(
            METRES_CAPTION,
            fine=fine.segments,
            coarse=coarse.segments,
            contacts=coarse.summary["wall_contacts"],
            least=MM * fine.clearance["quasi_static"].min(),
            achieved=MM * fine.clearance["achieved"].min(),
        ),
        figure=figure,
        table=_metres_table(made),
    )


def _draw_clearance(axes: Axes, walked: Walked) -> None:
    """Physics as a band, and the rims of the prediction's."""
    spread = {
        name: extremes(MM * walked.clearance[name], walked.segment, walked.segments)
        for name in ("achieved", "quasi_static")
    }
    colour = PATHS["achieved"]["color"]
    band(axes, *spread["achieved"], color=colour, alpha=0.8, label="physics")
    segment = np.arange(1, walked.segments + 1)
    for rim in spread["quasi_static"]:
        axes.step(segment, rim, where="mid", **PATHS["quasi_static"])
    axes.lines[-1].set_label("_")
    finish_clearance(axes, "mm", walked.segments, (-15, 75))


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
