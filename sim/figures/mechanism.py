"""Fig. 1: the robots whose legs swing and lift, and cannot do anything else."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models import Kinematics, load
from models.morphology import PIVOTS
from planner import Array
from sim import palette
from sim.figures.physics import Walked
from sim.figures.sheet import Cell, Shown
from sim.figures.stability import STANCE, draw_body
from sim.figures.style import COLOURS, INK, LEGS, MM, NOMINAL, STYLE, TRIPODS
from sim.motion.stability import support_polygons
from sim.palette import Style
from sim.pictures.ghost import body_corners
from sim.preparation.setup import Setup

ROBOTS = ("hexapod", "hexapod-parallel", "quadruped")
SWUNG = 0.5  # [rad], to either side


def paper(axes: Mapping[str, Axes]) -> Shown:
    """The hexapod of the paper in leg lengths."""
    legs: list[tuple[Cell, ...]] = []
    for tripod, of in LEGS.items():
        places = STANCE.hips(int(tripod)), STANCE.feet(int(tripod), 0.0)
        rows = np.hstack(places).tolist()
        legs += [(leg, int(tripod), *row) for leg, row in zip(of, rows, strict=True)]
    legs.sort()  # numbered from the front
    _draw_above(axes["a"], legs)
    return Shown(legs)


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """Three of the robots that walk in MuJoCo."""
    panels = zip(axes.values(), ROBOTS, strict=True)
    return Shown([row for panel, robot in panels for row in _draw_robot(panel, robot)])


def _draw_above(axes: Axes, legs: Sequence[tuple[Cell, ...]]) -> None:
    front = draw_body(axes)
    arrow = {"arrowstyle": "-|>", "color": NOMINAL}
    axes.annotate("", (front + 0.75, 0), (front + 0.1, 0), arrowprops=arrow)
    axes.text(front + 0.8, 0, "forward", va="center", color=NOMINAL, fontsize=7)
    for leg, tripod, *places in legs:
        hip, foot = np.reshape(np.array(places, dtype=float), (2, 2))
        colour = TRIPODS[str(tripod)]
        side = np.sign(foot[1])
        axes.plot(*np.transpose([hip, foot]), color=colour, linewidth=1.6)
        axes.plot(*foot, "o", color=colour, markersize=4)
        axes.plot(*hip, "s", color=INK, markersize=3)
        phi = np.linspace(-SWUNG, SWUNG, 30)
        reach = np.stack([-np.sin(phi), side * np.cos(phi)])
        axes.plot(*(hip[:, None] + reach), color=colour, linewidth=0.7)
        number: Style = {"ha": "center", "va": "bottom" if side > 0 else "top"}
        axes.text(foot[0], foot[1] + 0.14 * side, str(leg), color=colour, **number)
    x, y = STANCE.hips(1)[0]
    axes.plot([x, x - np.sin(SWUNG)], [y, y + np.cos(SWUNG)], ":", color=TRIPODS["1"])
    axes.text(x - 0.17, y + 0.62, r"$\varphi_1$", ha="center", color=TRIPODS["1"])


def _draw_robot(axes: Axes, name: str) -> list[tuple[Cell, ...]]:
    """Draw a robot from above and return a row for each leg."""
    robot = load(name)
    kinematics = Kinematics(robot)
    still = np.zeros(len(robot.groups))
    stance = kinematics.stance(still)
    rows: list[tuple[Cell, ...]] = []
    turned = stance.rates / robot.swing_gain[:, None]  # per radian of the joint
    hips = stance.feet - np.stack([turned[:, 1], -turned[:, 0]], axis=-1)
    corners = MM * body_corners(robot.model, robot.model.body(robot.root).id)[:, :2]
    rim = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(corners)))
    axes.fill(
        *rim.T, facecolor=COLOURS["body"], edgecolor=NOMINAL, linewidth=0.8, zorder=0
    )
    axes.plot(0.8 * rim[:, 0].max(), 0, ">", color=NOMINAL, markersize=6)
    for i, leg in enumerate(robot.legs):
        group = int(robot.group_of_leg[i])
        colour, hip, foot = palette.group(group).hex, hips[i], stance.feet[i]
        low, high = robot.swing_range[robot.groups[group]]
        angles = np.linspace(low, high, 25)[:, None] * (np.arange(len(still)) == group)
        reached = kinematics.stance(angles).feet[:, i]
        axes.plot(*(MM * reached.T), color=colour, linewidth=0.7)
        axes.plot(*(MM * np.transpose([hip, foot])), color=colour, linewidth=1.4)
        axes.plot(*(MM * foot), "o", color=colour, markersize=4)
        axes.plot(*(MM * hip), "s", color=INK, markersize=2.5)
        number: Style = {"color": INK, "ha": "center", "va": "center"}
        number |= {"textcoords": "offset points", "annotation_clip": False}
        axes.annotate(str(leg), MM * foot, (0, 8 * np.sign(foot[1])), **number)
        reach = float(np.hypot(*(foot - hip)))
        places = *hip.tolist(), *foot.tolist()
        rows.append((name, leg, robot.groups[group], *places, reach, high))
        inward = hip - (foot - hip) / reach * 0.12
        axes.plot(*(MM * np.transpose([hip, inward])), ":", color=colour, linewidth=0.6)
    for pivot in dict.fromkeys(PIVOTS.values()) if name == "hexapod" else ():
        axes.plot(*np.multiply(MM, pivot), "x", color=NOMINAL, markersize=5)
    axes.plot(*(MM * stance.center_of_mass), "+", color=INK)
    axes.margins(0.15)  # for the numbers
    return rows


def save_standing(setup: Setup, pivots: Sequence[Array], path: Path) -> None:
    """Draw a robot from above as it starts, as PNG, with its support polygons.

    Pivots are the points, (2,) [m], that its groups turn the body about, if any.
    """
    robot, stance = setup.robot, setup.kinematics.standing
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.0, 5.0), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        strata = [s for s in dict.fromkeys(robot.card.gait) if s != robot.card.bottom]
        for number, name in enumerate(strata):
            colour, on = palette.group(number).hex, robot.planted(name)[None]
            hull = support_polygons(stance.feet[None], on)[0]
            if hull.geom_type == "Polygon":
                axes.fill(*np.array(hull.exterior.coords).T, color=colour, alpha=0.12)
            axes.plot(*stance.feet[on[0]].T, "o", color=colour)
        for number, (pivot, name) in enumerate(zip(pivots, robot.groups, strict=False)):
            colour = palette.group(number).hex
            axes.plot(*pivot, "x", color=colour, label=f"pivot of group {name}")
            for foot in stance.feet[robot.planted(name)]:
                axes.plot(*np.transpose([pivot, foot]), ":", color=colour, lw=0.8)
        for leg, foot in zip(robot.legs, stance.feet, strict=True):
            axes.annotate(str(leg), foot, xytext=(4, 4), textcoords="offset points")
        axes.plot(*stance.center_of_mass, "k+", label="centre of mass")
        axes.set(xlabel="x [m], forward", ylabel="y [m], left")
        axes.set_title(robot.name, parse_math=False)
        axes.legend(loc="best", fontsize="small")
        figure.savefig(path, dpi=120)
