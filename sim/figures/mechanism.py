"""Fig. 1: the robots whose legs swing and lift, and cannot do anything else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import shapely
from matplotlib.axes import Axes

from models import Kinematics, load
from planner import Array
from sim import palette
from sim.figures.physics import Walked
from sim.figures.sheet import Cell, Shown
from sim.figures.stability import STANCE, draw_body
from sim.figures.style import INK, LEGS, MM, NOMINAL, TRIPODS, as_map
from sim.palette import Style
from sim.pictures.ghost import body_corners

ROBOTS = ("hexapod", "hexapod-parallel", "quadruped")
SWUNG = 0.5  # [rad], to either side
BODY = palette.OUTLINE.tint(0.35).hex
LIFTED = 0.35  # [l]


def paper(axes: Mapping[str, Axes]) -> Shown:
    """The hexapod of the paper in leg lengths."""
    legs: list[tuple[Cell, ...]] = []
    for tripod, of in LEGS.items():
        places = STANCE.hips(int(tripod)), STANCE.feet(int(tripod), 0.0)
        rows = np.hstack(places).tolist()
        legs += [(leg, int(tripod), *row) for leg, row in zip(of, rows, strict=True)]
    legs.sort()  # numbered from the front
    _draw_above(axes["a"], legs)
    _draw_side(axes["b"])
    return Shown(legs)


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """Three of the robots that walk in MuJoCo."""
    rows: list[tuple[Cell, ...]] = []
    for panel, robot in zip(axes.values(), ROBOTS, strict=True):
        rows += _draw_robot(panel, robot)
    last = axes["c"]
    for group in range(4):
        dots: Style = {"markersize": 4, "label": f"group {group + 1}"}
        last.plot([], [], "o", color=palette.group(group).hex, **dots)
    last.fill([], [], facecolor=BODY, edgecolor=NOMINAL, label="body")
    last.plot([], [], ">", color=NOMINAL, markersize=6, label="front")
    last.plot([], [], "s", color=INK, markersize=2.5, label="hip")
    last.plot([], [], "+", color=INK, label="centre of mass")
    last.plot([], [], "x", color=NOMINAL, label="pivot of a group")
    return Shown(rows)


def _draw_above(axes: Axes, legs: Sequence[tuple[Cell, ...]]) -> None:
    front = draw_body(axes)
    axes.annotate("", (front + 0.75, 0), (front + 0.1, 0),
                  arrowprops={"arrowstyle": "-|>", "color": NOMINAL})  # fmt: skip
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
        axes.text(foot[0], foot[1] + 0.14 * side, str(leg), color=colour, ha="center",
                  va="bottom" if side > 0 else "top")  # fmt: skip
    hip = STANCE.hips(1)[0]
    swept = hip + np.array([-np.sin(SWUNG), np.cos(SWUNG)])
    axes.plot(*np.transpose([hip, swept]), ":", color=TRIPODS["1"])
    x, y = hip + [-0.2, 1.04]
    axes.text(x, y, r"$\varphi_1$", ha="center", color=TRIPODS["1"])
    for name, of in LEGS.items():
        label = f"tripod {name}: legs {', '.join(map(str, of))}"
        axes.plot([], [], color=TRIPODS[name], label=label)
    axes.plot([], [], "s", color=INK, markersize=3, label="hip, axis of the swing")
    axes.plot([], [], "o", color=INK, markersize=4, label="foot")
    as_map(axes, "$l$", "box")
    axes.set(xlim=(-2.3, 3.1), ylim=(-1.9, 1.9))


def _draw_side(axes: Axes) -> None:
    """A leg on the ground and raised, seen along the body."""
    hip = np.array([0.0, 0.5])
    down = np.array([0.85, 0.0])
    length = np.linalg.norm(down - hip)
    up = np.array([np.sqrt(length**2 - (hip[1] - LIFTED) ** 2), LIFTED])
    axes.axhline(0, color=INK, linewidth=0.8)
    axes.plot([-0.35, 0.0], [0.5, 0.5], color=NOMINAL, linewidth=5, alpha=0.5,
              solid_capstyle="butt")  # fmt: skip
    axes.plot(*np.transpose([hip, down]), color=TRIPODS["1"], linewidth=1.6)
    axes.plot(*np.transpose([hip, up]), ":", color=TRIPODS["1"], linewidth=1.6)
    axes.plot(*np.transpose([down, up]), "o", color=TRIPODS["1"], markersize=4)
    axes.plot(*hip, "s", color=INK, markersize=3)
    axes.annotate("", (1.15, LIFTED), (1.15, 0.0),
                  arrowprops={"arrowstyle": "<->", "lw": 0.6})  # fmt: skip
    axes.text(1.19, LIFTED / 2, "$h_1$", va="center")
    axes.text(-0.33, 0.58, "body", color=NOMINAL)
    axes.text(-0.33, -0.04, "ground", va="top")
    axes.set(xlim=(-0.4, 1.4), ylim=(-0.3, 0.9), aspect="equal")
    axes.set_axis_off()


def _draw_robot(axes: Axes, name: str) -> list[tuple[Cell, ...]]:
    """Draw a robot from above and return a row for each leg."""
    robot = load(name)
    kinematics = Kinematics(robot)
    still = np.zeros(len(robot.groups))
    stance = kinematics.stance(still)
    rows: list[tuple[Cell, ...]] = []
    turned = stance.rates / robot.swing_gain[:, None]  # per radian of the joint
    hips = stance.feet - np.stack([turned[:, 1], -turned[:, 0]], axis=-1)
    _draw_body(axes, body_corners(robot.model, robot.model.body(robot.root).id))
    for i, leg in enumerate(robot.legs):
        group = int(robot.group_of_leg[i])
        colour, hip, foot = palette.group(group).hex, hips[i], stance.feet[i]
        low, high = robot.swing_range[robot.groups[group]]
        angles = np.linspace(low, high, 25)[:, None] * (np.arange(len(still)) == group)
        axes.plot(*(MM * kinematics.stance(angles).feet[:, i].T), color=colour,
                  linewidth=0.7)  # fmt: skip
        axes.plot(*(MM * np.transpose([hip, foot])), color=colour, linewidth=1.4)
        axes.plot(*(MM * foot), "o", color=colour, markersize=4)
        axes.plot(*(MM * hip), "s", color=INK, markersize=2.5)
        axes.annotate(str(leg), MM * foot, (0, 8 * np.sign(foot[1])), ha="center",
                      va="center", textcoords="offset points", color=INK,
                      xycoords="data", annotation_clip=False)  # fmt: skip
        reach = float(np.hypot(*(foot - hip)))
        places = *hip.tolist(), *foot.tolist()
        rows.append((name, leg, robot.groups[group], *places, reach, high))
        inward = hip - (foot - hip) / reach * 0.12
        axes.plot(*(MM * np.transpose([hip, inward])), ":", color=colour, linewidth=0.6)
    if name == "hexapod":
        for pivot in _pivots(hips, stance.feet, robot.group_of_leg):
            axes.plot(*(MM * pivot), "x", color=NOMINAL, markersize=5)
    axes.plot(*(MM * stance.center_of_mass), "+", color=INK)
    as_map(axes, "mm")
    return rows


def _draw_body(axes: Axes, corners: Array) -> None:
    """The body from above, and where its front is."""
    hull = shapely.convex_hull(shapely.MultiPoint(MM * corners[:, :2]))
    rim = shapely.get_coordinates(hull)
    axes.fill(*rim.T, facecolor=BODY, edgecolor=NOMINAL, linewidth=0.8, zorder=0)
    front = rim[:, 0].max()
    axes.plot(0.8 * front, 0, ">", color=NOMINAL, markersize=6)


def _pivots(hips: Array, feet: Array, groups: Array) -> list[Array]:
    """Point nearest to the lines of each group's legs, shape (2,)."""
    found = []
    for group in np.unique(groups):
        on = groups == group
        along = (feet - hips)[on]
        across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        found.append(np.linalg.lstsq(across, (across * hips[on]).sum(axis=1))[0])
    return found
