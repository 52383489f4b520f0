"""Fig. 5: angles at which a tripod is statically stable, by both criteria."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from models import PaperStance
from planner import Array, Flow
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.signs import (
    WIDEST,
    SignMap,
    crossings,
    polygon_margin,
    sign_map,
)
from sim.figures.style import (
    IDEAL,
    MM,
    NOMINAL,
    TRIPODS,
    WEIGHT,
    as_map,
    letter,
    sheet_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# The proportions of `hexapod-parallel`, in leg lengths: the paper gives none.
STANCE = PaperStance(body_length=20 / 7, leg_length=1.0, half_width=3 / 7)
BODY = PaperStance(body_length=0.3, leg_length=0.105, half_width=0.045)  # the same [m]
SWAY = 0.4  # [rad] to either side
SWAYING = (  # each tripod from end to end, standing on it alone
    Flow("2", "g2_1", -SWAY), Flow("1", "g1_1", 2 * SWAY),
    Flow("1", "g1_2", -SWAY), Flow("2", "g2_2", 2 * SWAY),
    Flow("2", "g2_1", -SWAY), Flow("1", "g1_2", -SWAY),
)  # fmt: skip
SHOWN = 0.5  # [rad], the angle that the stance is drawn at
PHI = np.linspace(-WIDEST, WIDEST, 241)
PAPER_CAPTION = """
A tripod stands while the weight, at a distance b behind the front, lies over the
triangle of its feet: l_b/4 + l sin(phi) <= b <= 3 l_b/4 + l sin(phi). Both bounds hold
for either tripod; the paper prints one for each. The sides of both tripods' support
polygons cross the body's axis on them (circles; {apart:.0e} l apart at most), and the
margin of the polygon has the sign of the closed form everywhere ({points} points of
both tripods compared, {disagree} disagree). (c) Along the body's axis the distance to
the nearer bound is the closed form; the margin proper, to the nearest side, is smaller
by the sides' slope. The paper leaves the proportions open; chosen are those of the
robot `hexapod-parallel`: l_b = 20/7 l, hips 3/7 l beside the axis, weight in the
middle, b = l_b/2.
"""
METRES_CAPTION = """
Each tripod alone under load, swung from -0.4 to 0.4 rad. Lines: margin of the support
polygon predicted from the commanded angles, with the weight of the legs moving along.
Markers: margin in the physics, from measured contacts and centre of mass. The tripod in
the air stays where its own sweep left it, at 0.4 rad while tripod 2 sweeps.
`hexapod-parallel` is the paper's stance as a body (l_b = 0.30 m, l = 0.105 m); its grey
line is the closed form along the body's axis, for a weight that stays in the middle.
`hexapod`, whose legs point to their tripod's pivot, has no closed form in the paper.
"""
ROWS = 15  # of the table
FEW = np.linspace(-1.05, 1.05, 8)  # [rad], angles that crossings are marked at
ANGLE = r"$\varphi$ of the loaded tripod  [rad]"
STANDS = "#CFE3F1"


def paper() -> Sheet:
    """In leg lengths, the weight in the middle of the body."""
    figure, axes = sheet_of("abc", 3.2, width_ratios=[0.9, 1, 1])
    signs = sign_map(STANCE)
    crossed = [crossings(STANCE, tripod, FEW) for tripod in (1, 2)]
    apart = np.abs(np.subtract(crossed, STANCE.bounds(FEW))).max()
    _draw_stance(axes["a"])
    _draw_signs(axes["b"], signs, crossed)
    _draw_margins(axes["c"])
    letter(axes, {"a": "tripod 1 loaded", "b": "where it stands", "c": "margin"})
    return Sheet(
        name="fig5-stability-paper",
        title="Fig. 5, stability of the tripods, in the paper's units",
        caption=words(
            PAPER_CAPTION,
            points=signs.polygon.size,
            disagree=signs.disagreements,
            apart=apart,
        ),
        figure=figure,
        table=_table(),
    )


WALKS = {
    robot: Job("line", {"robot": robot, "segments": 1}, flows=SWAYING)
    for robot in ("hexapod", "hexapod-parallel")
}


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """Both hexapods swinging one loaded tripod after the other from end to end."""
    figure, axes = sheet_of("ab", 2.9, sharey=True)
    for name, robot in zip("ab", WALKS, strict=True):
        _draw_sway(axes[name], walks[robot], robot == "hexapod-parallel")
    letter(axes, dict(zip("ab", WALKS, strict=True)))
    axes["a"].set_ylabel("margin  [mm]")
    return Sheet(
        name="fig5-stability-metres",
        title="Fig. 5, stability of the tripods, in metres",
        caption=words(METRES_CAPTION),
        figure=figure,
        table=_sway_table(walks),
    )


def _sway_rows(walked: Walked, group: int) -> tuple[Array, Array, Array]:
    """Angle, predicted and achieved margin while a tripod swings under load."""
    on = walked.moving == group
    return (
        walked.swing[on, group],
        walked.margin["ideal"][on],
        walked.margin["achieved"][on],
    )


def _draw_sway(axes: Axes, walked: Walked, parallel: bool) -> None:
    if parallel:
        phi = np.linspace(-SWAY, SWAY, 201)
        along = BODY.margin_along_axis(phi, BODY.body_length / 2)
        axes.plot(phi, MM * along, "--", color=NOMINAL, label="closed form, along x")
    for group, (marker, line) in enumerate((("^", "-"), ("v", ":"))):
        phi, predicted, achieved = _sway_rows(walked, group)
        colour, tripod = TRIPODS[str(group + 1)], f"tripod {group + 1}"
        axes.plot(phi, MM * predicted, line, color=colour, label=f"{tripod}, predicted")
        few = np.linspace(0, len(phi) - 1, 17).astype(int)[group::2]
        axes.plot(
            phi[few], MM * achieved[few], marker, color=colour, markersize=4,
            markerfacecolor="white", label=f"{tripod}, physics",
        )  # fmt: skip
    axes.set(xlabel=ANGLE, xlim=(-1.05 * SWAY, 1.05 * SWAY))
    axes.set_ylim(8, 80)  # room for the legend
    axes.legend(loc="lower center", ncols=2)


def _sway_table(walks: Mapping[str, Walked]) -> Table:
    rows: list[tuple[Cell, ...]] = []
    for robot in WALKS:
        for group in range(2):
            phi, predicted, achieved = _sway_rows(walks[robot], group)
            for angle in np.linspace(-SWAY, SWAY, 9):
                k = int(np.abs(phi - angle).argmin())
                margins = float(predicted[k]), float(achieved[k])
                rows.append((robot, group + 1, float(phi[k]), *margins))
    header = ("robot", "tripod", "phi [rad]", "predicted [m]", "achieved [m]")
    return Table(header, tuple(rows))


def _table() -> Table:
    phi = np.linspace(PHI[0], PHI[-1], ROWS)
    middle = np.full_like(phi, STANCE.body_length / 2)
    low, high = STANCE.bounds(phi)
    columns = (
        phi,
        low,
        high,
        STANCE.margin_along_axis(phi, middle),
        polygon_margin(STANCE, 1, phi, middle),
        polygon_margin(STANCE, 2, phi, middle),
    )
    return Table(
        header=(
            "phi [rad]",
            "least b [l]",
            "largest b [l]",
            "margin along x [l]",
            "margin of tripod 1 [l]",
            "margin of tripod 2 [l]",
        ),  # fmt: skip
        rows=tuple(zip(*(column.tolist() for column in columns), strict=True)),
    )


def _draw_stance(axes: Axes) -> None:
    """The body from above, tripod 1 at one angle, the other at rest and in the air."""
    as_map(axes, "$l$")
    front = STANCE.body_length / 2
    sides = STANCE.half_width * np.array([1, 1, -1, -1, 1])
    axes.plot(front * np.array([1, -1, -1, 1, 1]), sides, color=NOMINAL)
    for tripod, phi in ((1, SHOWN), (2, 0.0)):
        hips, feet = STANCE.hips(tripod), STANCE.feet(tripod, phi)
        colour, alpha = TRIPODS[str(tripod)], 1.0 if tripod == 1 else 0.35
        for hip, foot in zip(hips, feet, strict=True):
            axes.plot(*np.transpose([hip, foot]), color=colour, alpha=alpha)
        axes.plot(*feet.T, "o", markersize=3.5, color=colour, alpha=alpha)
    triangle = STANCE.feet(1, SHOWN)
    axes.fill(*triangle.T, color=TRIPODS["1"], alpha=0.15, linewidth=0)
    axes.plot(0, 0, "P", color=WEIGHT, markersize=5, label="centre of mass")
    low, high = STANCE.bounds(SHOWN)
    axes.plot(
        front - np.array([low, high]), [0, 0], "|", color=IDEAL, markersize=9,
        label="bounds for $b$",
    )  # fmt: skip
    for name, standing, faint in (
        ("1", "on the ground", 1.0),
        ("2", "in the air", 0.35),
    ):
        axes.plot(
            [], [], "o-", color=TRIPODS[name], alpha=faint, markersize=3.5,
            label=f"tripod {name}, {standing}",
        )  # fmt: skip
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22))
    axes.annotate(
        "", (0, -0.72), (front, -0.72), arrowprops={"arrowstyle": "<->", "lw": 0.6}
    )
    axes.text(front / 2, -0.78, "$b$", ha="center", va="top")
    axes.set_xlim(-2.3, 1.9)


def _draw_signs(axes: Axes, signs: SignMap, crossed: Sequence[Array]) -> None:
    stands = [0.0, float(signs.polygon.max())]
    axes.contourf(signs.phi, signs.b, signs.polygon[0], stands, colors=[STANDS])
    low, high = STANCE.bounds(PHI)
    axes.plot(PHI, low, color=IDEAL, label="closed form, both bounds")
    axes.plot(PHI, high, color=IDEAL)
    for tripod, size, bounds in zip((1, 2), (5, 2.5), crossed, strict=True):
        axes.plot(
            FEW, bounds.T, "o", color=TRIPODS[str(tripod)], markersize=size,
            markerfacecolor="none", markeredgewidth=0.8,
            label=["polygon's sides, both tripods", "_"] if tripod == 1 else "_",
        )  # fmt: skip
    axes.plot([], [], color=STANDS, linewidth=6, label="support polygon: margin > 0")
    axes.axhline(
        STANCE.body_length / 2, color=NOMINAL, linestyle="--", label=r"$b = l_b/2$"
    )
    axes.set(xlabel=ANGLE, ylabel="$b$  [$l$]", xlim=(PHI[0], PHI[-1]), ylim=(-1, 5.8))
    axes.legend(loc="upper left")


def _draw_margins(axes: Axes) -> None:
    middle = np.full_like(PHI, STANCE.body_length / 2)
    along = STANCE.margin_along_axis(PHI, middle)
    axes.plot(PHI, along, color=NOMINAL, linestyle="--", label="along the axis, both")
    for tripod, style in ((1, "-"), (2, ":")):
        axes.plot(
            PHI,
            polygon_margin(STANCE, tripod, PHI, middle),
            color=TRIPODS[str(tripod)],
            linestyle=style,
            linewidth=1.2 if tripod == 1 else 2.0,
            label=f"tripod {tripod}, to the nearest side",
        )
    axes.axhline(0, color=WEIGHT, linewidth=0.6)
    axes.set(xlabel=ANGLE, ylabel="margin  [$l$]", xlim=(PHI[0], PHI[-1]))
    axes.set_ylim(-0.65, 0.8)  # room for the legend
    axes.legend(loc="lower center")
