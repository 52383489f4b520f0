"""Fig. 2: the strata of a biped, and of robots that walk on two sets of feet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes

from models import Kinematics, equations, load, shipped_system
from sim.figures import strata
from sim.figures.physics import Walked
from sim.figures.sheet import Shown
from sim.figures.style import MM
from sim.motion.stability import margin_at_rest


def paper(axes: Mapping[str, Axes]) -> Shown:
    """The biped's configuration space, its graph and that of the paper's hexapod."""
    strata.draw_sheets(axes["a"], (0.0, 1.0))
    axes["a"].set_xlabel("everything else", labelpad=-12)
    axes["a"].set_xticks([])
    return of_systems([axes["b"], axes["c"]], ("biped", "paper-hexapod"))


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """Robots that walk on two groups of legs, with their margins."""
    return of_robots([*axes.values()], ("hexapod", "hexapod-radial", "octopod"))


def of_systems(axes: Sequence[Axes], names: Sequence[str]) -> Shown:
    """The strata of shipped systems with their gaits; the first panel gets the key."""
    problems = {name: shipped_system(name) for name in names}
    graphs = {name: strata.graph_of(p.system, p.gait) for name, p in problems.items()}
    for panel, graph in zip(axes, graphs.values(), strict=True):
        strata.draw_graph(panel, graph)
    strata.add_key(axes[0])
    return Shown(strata.rows_of_graphs(graphs))


def of_robots(axes: Sequence[Axes], names: Sequence[str]) -> Shown:
    """The strata, gaits and margins of shipped robots; the first panel gets the key."""
    rows = []
    for panel, name in zip(axes, names, strict=True):
        robot = load(name)
        kinematics, gait = Kinematics(robot), robot.card.gait
        margins = {s: margin_at_rest(kinematics, s) for s in dict.fromkeys(gait)}
        graph = strata.graph_of(equations(robot).system, gait)
        notes = {s: f"{MM * margin:.0f} mm" for s, margin in margins.items()}
        strata.draw_graph(panel, graph, notes)
        for row in strata.rows_of_graphs({name: graph}):
            rows.append((*row, margins[str(row[1]).removeprefix("S")]))
    strata.add_key(axes[0])
    return Shown(rows)
