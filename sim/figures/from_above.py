"""A robot from above: feet, pivots, and support polygons while others are lifted."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from planner import Array
from sim import palette
from sim.figures.style import STYLE
from sim.motion.stability import support_polygons
from sim.preparation.setup import Setup

SIZE = 5.0  # of the picture's side [inch]


def draw(setup: Setup, pivots: Sequence[Array], path: Path) -> None:
    """Draw a robot as it starts, as PNG.

    Pivots are the points, (2,) [m], that its groups turn the body about, if any.
    """
    robot, kinematics = setup.robot, setup.kinematics
    card = robot.card
    stance = kinematics.standing
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(SIZE, SIZE), layout="constrained")
        axes = figure.add_subplot(aspect="equal")
        standing = [s for s in dict.fromkeys(card.gait) if s != card.bottom]
        for number, name in enumerate(standing):
            colour = palette.group(number).hex
            on = robot.planted(name)[None]
            hull = support_polygons(stance.feet[None], on)[0]
            if hull.geom_type == "Polygon":
                axes.fill(*np.array(hull.exterior.coords).T, color=colour, alpha=0.12)
            axes.plot(*stance.feet[on[0]].T, "o", color=colour)
        for number, (pivot, name) in enumerate(zip(pivots, robot.groups, strict=False)):
            colour = palette.group(number).hex
            axes.plot(*pivot, "x", color=colour, label=f"pivot of group {name}")
            for foot in stance.feet[robot.planted(name)]:
                spoke = np.array([pivot, foot]).T
                axes.plot(*spoke, ":", color=colour, linewidth=0.8)
        for leg, foot in zip(robot.legs, stance.feet, strict=True):
            axes.annotate(str(leg), foot, xytext=(4, 4), textcoords="offset points")
        axes.plot(*stance.center_of_mass, "k+", label="centre of mass")
        axes.set_xlabel("x [m], forward")
        axes.set_ylabel("y [m], left")
        axes.set_title(robot.name, parse_math=False)
        axes.legend(loc="best", fontsize="small")
        figure.savefig(path, dpi=120)
