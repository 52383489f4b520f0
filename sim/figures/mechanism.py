"""Fig. 1: the robots whose legs swing and lift, and cannot do anything else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from models import Kinematics, load
from planner import Array
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Cell, Sheet, Table, words
from sim.figures.stability import STANCE
from sim.figures.style import MM, NOMINAL, TRIPODS, WEIGHT, as_map, letter, sheet_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PAPER_CAPTION = """
The hexapod of Fig. 1 in leg lengths, with the proportions chosen for Fig. 5 (the paper
gives none). (a) From above: legs are numbered from the front, odd ones on the left;
tripod 1 is legs 1, 4 and 5, tripod 2 legs 2, 3 and 6. A leg swings about the vertical
through its hip, by the angle phi, which is positive where the foot goes backward. (b) A
leg from behind: it lifts its foot by the height h. That is all that a leg can do, so no
foot can be set down farther to the left or to the right.
"""
METRES_CAPTION = """
Three robots as they stand in MuJoCo, from above: hips (squares), feet (dots) and the
arcs that the feet reach within the joint range. Dotted lines lead from each foot
through its hip. In `hexapod` those of a tripod meet in one point, about which its
planted feet turn the body without slipping (crosses); `hexapod-parallel` is Fig. 1
taken literally, and its lines do not meet. Every leg of `quadruped` is a group of its
own.
"""
ROBOTS = ("hexapod", "hexapod-parallel", "quadruped")
OTHERS = ("#009E73", "#CC79A7")  # of further groups
SWUNG = 0.5  # [rad], to either side
LIFTED = 0.35  # [l]
WALKS: Mapping[str, Job] = {}


def paper() -> Sheet:
    """The hexapod of the paper in leg lengths."""
    figure, axes = sheet_of("ab", 2.9, width_ratios=[1.6, 1])
    legs = _paper_legs()
    _draw_above(axes["a"], legs)
    _draw_side(axes["b"])
    letter(axes, {"a": "from above", "b": "one leg, from behind"})
    handles, labels = axes["a"].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    header = ("leg", "tripod", "hip x [l]", "hip y [l]", "foot x [l]", "foot y [l]")
    return Sheet(
        name="fig1-mechanism-paper",
        title="Fig. 1, the minimalist hexapod, in the paper's units",
        caption=words(PAPER_CAPTION),
        figure=figure,
        table=Table(header, tuple(legs)),
    )


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """Three of the robots that walk in MuJoCo.

    Args:
        walks: None are needed.
    """
    figure, axes = sheet_of("abc", 3.0)
    rows: list[tuple[Cell, ...]] = []
    for name, robot in zip("abc", ROBOTS, strict=True):
        rows += _draw_robot(axes[name], robot)
    letter(axes, dict(zip("abc", ROBOTS, strict=True)))
    for group in range(4):
        axes["c"].plot([], [], "o", color=_colour(group), markersize=4,
                       label=f"group {group + 1}")  # fmt: skip
    axes["c"].plot([], [], "s", color=WEIGHT, markersize=2.5, label="hip")
    axes["c"].plot([], [], "+", color=WEIGHT, label="centre of mass")
    axes["c"].plot([], [], "x", color=NOMINAL, label="pivot of a group")
    handles, labels = axes["c"].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return Sheet(
        name="fig1-mechanism-metres",
        title="Fig. 1, robots with two joints a leg, in metres",
        caption=words(METRES_CAPTION),
        figure=figure,
        table=Table(
            header=(
                "robot",
                "leg",
                "group",
                "hip x [m]",
                "hip y [m]",
                "foot x [m]",
                "foot y [m]",
                "from hip to foot [m]",
                "swings to either side [rad]",
            ),
            rows=tuple(rows),
        ),
    )


def _paper_legs() -> list[tuple[Cell, ...]]:
    """Leg, tripod, hip and foot at angle 0, numbered from the front."""
    found: dict[int, tuple[Cell, ...]] = {}
    for tripod, legs in ((1, (1, 4, 5)), (2, (2, 3, 6))):
        places = zip(STANCE.hips(tripod), STANCE.feet(tripod, 0.0), strict=True)
        for leg, (hip, foot) in zip(legs, places, strict=True):
            found[leg] = (leg, tripod, *hip.tolist(), *foot.tolist())
    return [found[leg] for leg in sorted(found)]


def _draw_above(axes: Axes, legs: Sequence[tuple[Cell, ...]]) -> None:
    front = STANCE.body_length / 2
    sides = STANCE.half_width * np.array([1, 1, -1, -1, 1])
    axes.plot(front * np.array([1, -1, -1, 1, 1]), sides, color=NOMINAL)
    axes.annotate("", (front + 0.75, 0), (front + 0.1, 0),
                  arrowprops={"arrowstyle": "-|>", "color": NOMINAL})  # fmt: skip
    axes.text(front + 0.8, 0, "forward", va="center", color=NOMINAL, fontsize=7)
    for leg, tripod, *places in legs:
        hip, foot = np.reshape(np.array(places, dtype=float), (2, 2))
        colour = TRIPODS[str(tripod)]
        side = np.sign(foot[1])
        axes.plot(*np.transpose([hip, foot]), color=colour, linewidth=1.6)
        axes.plot(*foot, "o", color=colour, markersize=4)
        axes.plot(*hip, "s", color=WEIGHT, markersize=3)
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
    for tripod, which in (("1", "1, 4, 5"), ("2", "2, 3, 6")):
        axes.plot([], [], color=TRIPODS[tripod], label=f"tripod {tripod}: legs {which}")
    axes.plot([], [], "s", color=WEIGHT, markersize=3, label="hip, axis of the swing")
    axes.plot([], [], "o", color=WEIGHT, markersize=4, label="foot")
    as_map(axes, "$l$", "box")
    axes.set(xlim=(-2.3, 3.1), ylim=(-1.9, 1.9))


def _draw_side(axes: Axes) -> None:
    """A leg on the ground and raised, seen along the body."""
    hip = np.array([0.0, 0.5])
    down = np.array([0.85, 0.0])
    length = np.linalg.norm(down - hip)
    up = np.array([np.sqrt(length**2 - (hip[1] - LIFTED) ** 2), LIFTED])
    axes.axhline(0, color=WEIGHT, linewidth=0.8)
    axes.plot([-0.35, 0.0], [0.5, 0.5], color=NOMINAL, linewidth=5, alpha=0.5,
              solid_capstyle="butt")  # fmt: skip
    axes.plot(*np.transpose([hip, down]), color=TRIPODS["1"], linewidth=1.6)
    axes.plot(*np.transpose([hip, up]), ":", color=TRIPODS["1"], linewidth=1.6)
    axes.plot(*np.transpose([down, up]), "o", color=TRIPODS["1"], markersize=4)
    axes.plot(*hip, "s", color=WEIGHT, markersize=3)
    axes.annotate("", (1.15, LIFTED), (1.15, 0.0),
                  arrowprops={"arrowstyle": "<->", "lw": 0.6})  # fmt: skip
    axes.text(1.19, LIFTED / 2, "$h_1$", va="center")
    axes.text(-0.33, 0.58, "body", color=NOMINAL)
    axes.text(-0.33, -0.04, "ground", va="top")
    axes.set_xlim(-0.4, 1.4)
    axes.set_ylim(-0.3, 0.9)
    axes.set_aspect("equal")
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
    for i, leg in enumerate(robot.legs):
        group = int(robot.group_of_leg[i])
        colour, hip, foot = _colour(group), hips[i], stance.feet[i]
        low, high = robot.swing_range[robot.groups[group]]
        angles = np.linspace(low, high, 25)[:, None] * (np.arange(len(still)) == group)
        axes.plot(*(MM * kinematics.stance(angles).feet[:, i].T), color=colour,
                  linewidth=0.7)  # fmt: skip
        axes.plot(*(MM * np.transpose([hip, foot])), color=colour, linewidth=1.4)
        axes.plot(*(MM * foot), "o", color=colour, markersize=4)
        axes.plot(*(MM * hip), "s", color=WEIGHT, markersize=2.5)
        axes.annotate(str(leg), MM * foot, (0, 8 * np.sign(foot[1])), ha="center",
                      va="center", textcoords="offset points", color=colour,
                      xycoords="data", annotation_clip=False)  # fmt: skip
        reach = float(np.hypot(*(foot - hip)))
        rows.append(
            (name, leg, robot.groups[group], *hip.tolist(), *foot.tolist(), reach, high)
        )
        inward = hip - (foot - hip) / reach * 0.12
        axes.plot(*(MM * np.transpose([hip, inward])), ":", color=colour, linewidth=0.6)
    if name == "hexapod":
        for pivot in _pivots(hips, stance.feet, robot.group_of_leg):
            axes.plot(*(MM * pivot), "x", color=NOMINAL, markersize=5)
    axes.plot(*(MM * stance.center_of_mass), "+", color=WEIGHT)
    as_map(axes, "mm")
    return rows


def _pivots(hips: Array, feet: Array, groups: Array) -> list[Array]:
    """Point nearest to the lines of each group's legs, shape (2,)."""
    found = []
    for group in np.unique(groups):
        on = groups == group
        along = (feet - hips)[on]
        across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
        found.append(np.linalg.lstsq(across, (across * hips[on]).sum(axis=1))[0])
    return found


def _colour(group: int) -> str:
    return (*TRIPODS.values(), *OTHERS)[group]
