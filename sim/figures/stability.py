"""Fig. 5: angles at which a tripod is stable, by closed forms and support polygons."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.axes import Axes

from models import PaperStance
from planner import Array, Flow
from sim import palette
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Shown, rows_of
from sim.figures.style import IDEAL, INK, MM, NOMINAL, TRIPODS
from sim.motion.stability import stability_margin, support_polygons
from sim.palette import Style

# The proportions of `hexapod-parallel`, in leg lengths: the paper gives none.
STANCE = PaperStance(body_length=20 / 7, leg_length=1.0, half_width=3 / 7)
BODY = PaperStance(body_length=0.3, leg_length=0.105, half_width=0.045)  # the same [m]
SWAY = 0.4  # [rad] to either side
SWAYING = (  # each tripod from end to end, standing on it alone
    Flow("2", "g2_1", -SWAY), Flow("1", "g1_1", 2 * SWAY),
    Flow("1", "g1_2", -SWAY), Flow("2", "g2_2", 2 * SWAY),
    Flow("2", "g2_1", -SWAY), Flow("1", "g1_2", -SWAY),
)  # fmt: skip
DRAWN_ANGLE = 0.5  # [rad], of the stance
WIDEST = 1.2  # [rad] to either side of the angles compared
PHI = np.linspace(-WIDEST, WIDEST, 241)
TABLED = np.linspace(-WIDEST, WIDEST, 15)  # [rad], angles in the table
MARKED = np.linspace(-1.05, 1.05, 8)  # [rad], angles that crossings are marked at
STANDS = palette.STABLE.tint(0.35).hex
WALKS = {
    robot: Job("line", {"robot": robot, "segments": 1}, flows=SWAYING)
    for robot in ("hexapod", "hexapod-parallel")
}


def paper(axes: Mapping[str, Axes]) -> Shown:
    """In leg lengths, the weight in the middle of the body."""
    signs = sign_map(STANCE)
    crossed = [crossings(STANCE, tripod, MARKED) for tripod in (1, 2)]
    apart = np.abs(np.subtract(crossed, STANCE.bounds(MARKED))).max()
    _draw_stance(axes["a"])
    _draw_signs(axes["b"], signs, crossed)
    _draw_margins(axes["c"])
    counts = {"points": signs.polygon.size, "disagree": signs.disagreements}
    columns = *STANCE.bounds(TABLED), *_margins(TABLED)
    return Shown(rows_of(TABLED, *columns), {**counts, "apart": apart})


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """Both hexapods swinging one loaded tripod after the other from end to end."""
    rows: list[tuple[Cell, ...]] = []
    for panel, robot in zip("ab", WALKS, strict=True):
        _draw_sway(axes[panel], walks[robot], robot == "hexapod-parallel")
        for group in range(2):
            found = np.array(_sway_rows(walks[robot], group))
            for angle in np.linspace(-SWAY, SWAY, 9):
                k = np.abs(found[0] - angle).argmin()
                rows.append((robot, group + 1, *found[:, k].tolist()))
    return Shown(rows)


def _sway_rows(walked: Walked, group: int) -> tuple[Array, Array, Array]:
    """Angle, predicted and achieved margin while a tripod swings under load."""
    on, margin = walked.moving == group, walked.margin
    return walked.swing[on, group], margin["ideal"][on], margin["achieved"][on]


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
        point: Style = {"color": colour, "markersize": 4, "mfc": "white"}
        label = f"{tripod}, physics"
        axes.plot(phi[few], MM * achieved[few], marker, label=label, **point)


def draw_body(axes: Axes) -> float:
    """Draw the body from above; where its front is."""
    front = STANCE.body_length / 2
    sides = STANCE.half_width * np.array([1, 1, -1, -1, 1])
    axes.plot(front * np.array([1, -1, -1, 1, 1]), sides, color=NOMINAL)
    return front


def _draw_stance(axes: Axes) -> None:
    """The body from above, tripod 1 at one angle, the other at rest and in the air."""
    front = draw_body(axes)
    looks = (1, DRAWN_ANGLE, 1.0, "on the ground"), (2, 0.0, 0.35, "in the air")
    for tripod, phi, alpha, words in looks:
        hips, feet = STANCE.hips(tripod), STANCE.feet(tripod, phi)
        look: Style = {"color": TRIPODS[str(tripod)], "alpha": alpha}
        axes.plot(*np.stack([hips, feet]).transpose(2, 0, 1), **look)
        axes.plot(*feet.T, "o", markersize=3.5, **look)
        label = f"tripod {tripod}, {words}"
        axes.plot([], [], "o-", markersize=3.5, label=label, **look)
    triangle = STANCE.feet(1, DRAWN_ANGLE)
    axes.fill(*triangle.T, color=TRIPODS["1"], alpha=0.15, linewidth=0)
    axes.plot(0, 0, "P", color=INK, markersize=5, label="centre of mass")
    low, high = STANCE.bounds(DRAWN_ANGLE)
    ticks: Style = {"color": IDEAL, "markersize": 9, "label": "bounds for $b$"}
    axes.plot(front - np.array([low, high]), [0, 0], "|", **ticks)
    arrow = {"arrowstyle": "<->", "lw": 0.6}
    axes.annotate("", (0, -0.72), (front, -0.72), arrowprops=arrow)
    axes.text(front / 2, -0.78, "$b$", ha="center", va="top")


def _draw_signs(axes: Axes, signs: "SignMap", crossed: Sequence[Array]) -> None:
    stands = [0.0, float(signs.polygon.max())]
    axes.contourf(signs.phi, signs.b, signs.polygon[0], stands, colors=[STANDS])
    low, high = STANCE.bounds(PHI)
    axes.plot(PHI, low, color=IDEAL, label="closed form, both bounds")
    axes.plot(PHI, high, color=IDEAL)
    for tripod, size, bounds in zip((1, 2), (5, 2.5), crossed, strict=True):
        ring: Style = {"color": TRIPODS[str(tripod)], "mfc": "none", "mew": 0.8}
        label = ["polygon's sides, both tripods", "_"] if tripod == 1 else "_"
        axes.plot(MARKED, bounds.T, "o", markersize=size, label=label, **ring)
    axes.plot([], [], color=STANDS, linewidth=6, label="support polygon: margin > 0")
    middle: Style = {"color": NOMINAL, "linestyle": "--", "label": r"$b = l_b/2$"}
    axes.axhline(STANCE.body_length / 2, **middle)


def _draw_margins(axes: Axes) -> None:
    along, *margins = _margins(PHI)
    axes.plot(PHI, along, color=NOMINAL, linestyle="--", label="along the axis, both")
    for name, margin, style, width in zip("12", margins, "-:", (1.2, 2.0), strict=True):
        line: Style = {"color": TRIPODS[name], "linewidth": width}
        label = f"tripod {name}, to the nearest side"
        axes.plot(PHI, margin, style, label=label, **line)


def _margins(phi: Array) -> tuple[Array, ...]:
    """Margins along the axis and of both polygons, the weight in the middle."""
    middle = np.full_like(phi, STANCE.body_length / 2)
    polygons = (polygon_margin(STANCE, tripod, phi, middle) for tripod in (1, 2))
    return STANCE.margin_along_axis(phi, middle), *polygons


def polygon_margin(stance: PaperStance, tripod: int, phi: Array, b: Array) -> Array:
    """Margin by the support polygon, the weight on the body's axis, shape as phi.

    The loaded tripod, 1 or 2, is at angle phi [rad], the weight b behind the front.
    """
    weight = np.stack([stance.body_length / 2 - b, np.zeros_like(b)], axis=-1)
    feet = stance.feet(tripod, phi)
    return stability_margin(feet, np.ones(feet.shape[:-1], dtype=bool), weight)


@dataclass(frozen=True)
class SignMap:
    """Both margins on a grid of angles and places of the weight."""

    phi: Array  # (P,) [rad]
    b: Array  # (B,)
    closed: Array  # (B, P)
    polygon: Array  # of tripods 1 and 2, (2, B, P)

    @property
    def disagreements(self) -> int:
        """Points at which the signs differ by more than rounding, of both tripods."""
        off = np.abs(self.closed) > 1e-12
        return int((np.sign(self.polygon) != np.sign(self.closed))[:, off].sum())


def sign_map(stance: PaperStance, points: int = 121) -> SignMap:
    """Compare the closed form with the support polygon everywhere."""
    phi = np.linspace(-WIDEST, WIDEST, points)
    b = np.linspace(-0.5, 1.5, points) * stance.body_length
    at_phi, at_b = (grid.ravel() for grid in np.meshgrid(phi, b))
    polygon = [polygon_margin(stance, tripod, at_phi, at_b) for tripod in (1, 2)]
    closed = stance.margin_along_axis(at_phi, at_b).reshape(points, points)
    return SignMap(phi, b, closed, np.reshape(polygon, (2, points, points)))


def crossings(stance: PaperStance, tripod: int, phi: Array) -> Array:
    """Least and largest b at which the axis is in the support polygon, (2, P)."""
    feet = stance.feet(tripod, phi)
    polygons = support_polygons(feet, np.ones(feet.shape[:-1], dtype=bool))
    far = 2 * (stance.body_length + stance.leg_length)
    axis = shapely.LineString([(-far, 0), (far, 0)])
    rear, _, front, _ = shapely.bounds(shapely.intersection(polygons, axis)).T
    return stance.body_length / 2 - np.array([front, rear])
