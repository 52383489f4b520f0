"""Figs. 2 and 3: strata as graphs of systems, and as sheets of configurations.

Every set of feet on the ground is a node, placed by the number of these feet; the
system has a stratum for some of them. A gait is a closed walk along the edges. Near
both feet on the ground a biped's configurations are two sheets, which cross in S12.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Patch
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from models import Kinematics, equations, load, shipped_system
from planner import Array, Gait, StratifiedSystem
from sim import palette
from sim.figures.physics import Walked
from sim.figures.sheet import Cell, Shown
from sim.figures.style import INK, MM, NOMINAL, STRATA
from sim.motion.stability import margin_at_rest
from sim.palette import Style

ABSENT = palette.OUTLINE.hex  # sets of feet that are no strata
Place = tuple[float, float]
LANE, HALF = 0.07, 0.25  # of arrows beside their edges; half the bottom's height
SPREAD, NUMBERED = 0.62, 0.4  # of edges at the bottom; of the way to a step's number


@dataclass(frozen=True)
class Node:
    """A set of feet on the ground."""

    name: str  # its feet, `0` for none; the stratum's own name where there is one
    feet: frozenset[str]
    at: Place  # where it is drawn
    fields: tuple[str, ...]  # of its stratum
    present: bool  # whether the system has such a stratum


@dataclass(frozen=True)
class Graph:
    """The strata of a system within all sets of its feet."""

    nodes: Mapping[str, Node]  # by name, those with more feet on the ground first
    edges: tuple[tuple[str, str], ...]  # (lower, higher) that differ by one foot
    joined: tuple[tuple[str, str], ...]  # strata next to each other in the system
    gait: tuple[str, ...]  # strata in order, the first again at the end
    dimensions: Mapping[str, int]  # of every stratum that there is


def paper(axes: Mapping[str, Axes], systems: Sequence[str]) -> Shown:
    """Strata of systems with their gaits; in a panel before them, a biped's sheets."""
    panels = [*axes.values()]
    spaces, panels = panels[: -len(systems)], panels[-len(systems) :]
    for space in spaces:
        draw_sheets(space, (0.0, 1.0))
        space.set_xlabel("everything else", labelpad=-12)
        space.set_xticks([])
    rows: list[tuple[Cell, ...]] = []
    for panel, name in zip(panels, systems, strict=True):
        problem = shipped_system(name)
        graph = graph_of(problem.system, problem.gait)
        draw_graph(panel, graph)
        rows += _rows(name, graph)
    return Shown(rows)


def metres(
    axes: Mapping[str, Axes], walks: Mapping[str, Walked], robots: Sequence[str]
) -> Shown:
    """Strata, gaits and margins of robots that walk in MuJoCo."""
    rows = []
    for panel, name in zip(axes.values(), robots, strict=True):
        robot = load(name)
        kinematics, gait = Kinematics(robot), robot.card.gait
        margins = {s: margin_at_rest(kinematics, s) for s in dict.fromkeys(gait)}
        graph = graph_of(equations(robot).system, gait)
        draw_graph(panel, graph, {s: f"${MM * m:.0f}$ mm" for s, m in margins.items()})
        for row in _rows(name, graph):
            rows.append((*row, margins[str(row[1]).removeprefix("S")]))
    return Shown(rows)


def graph_of(system: StratifiedSystem, gait: Sequence[str]) -> Graph:
    """The graph of a system's strata and a closed gait in it."""
    own = {
        frozenset(contact.rpartition("_")[2] for contact in system.contacts[s]): s
        for s in system.strata
    }
    everything = sorted(frozenset().union(*own))
    nodes = {}
    for size in range(len(everything), -1, -1):
        level = [frozenset(some) for some in combinations(everything, size)]
        for place, standing in enumerate(level):
            stratum = own.get(standing)
            name = stratum or "".join(sorted(standing)) or "0"
            at = (place - (len(level) - 1) / 2, float(len(everything) - size))
            fields = tuple(system.strata[stratum]) if stratum else ()
            nodes[name] = Node(name, standing, at, fields, stratum is not None)
    edges = tuple(
        (low.name, high.name)
        for low, high in product(nodes.values(), repeat=2)
        if high.feet < low.feet and len(low.feet) == len(high.feet) + 1
    )
    whole = system.dimension
    dimensions = {s: whole - len(system.level_set(s).functions) for s in system.strata}
    walked = Gait(system, tuple(gait)).strata
    return Graph(nodes, edges, system.edges, walked, dimensions)


def draw_graph(
    axes: Axes, graph: Graph, notes: Mapping[str, str] | None = None
) -> None:
    """Draw a graph, its gait as numbered arrows, and notes below names of strata."""
    nodes, bottom = graph.nodes, graph.nodes[graph.gait[0]]
    boxes = {
        n.name: _draw_node(axes, n, (notes or {}).get(n.name, ""), n is not bottom)
        for n in nodes.values()
    }
    above = [SPREAD * n.at[0] for n in nodes.values() if n.at[1] == 1]
    # A box as wide as the edges that leave it, so that arrows do not meet.
    left, right, y = min(above) - 3 * LANE, max(above) + 3 * LANE, bottom.at[1]
    shape: Style = {"facecolor": "white", "edgecolor": NOMINAL, "linewidth": 1.2}
    shape["boxstyle"] = "round,pad=0,rounding_size=0.06"
    box = FancyBboxPatch((left, y - HALF), right - left, 2 * HALF, zorder=3, **shape)
    axes.add_patch(box)
    faint: Style = {"color": ABSENT, "linewidth": 0.5, "zorder": 0}
    strong: Style = {"color": NOMINAL, "linewidth": 1.2, "zorder": 1}
    for pairs, style in ((graph.edges, faint), (graph.joined, strong)):
        for one, other in pairs:
            axes.plot(*np.transpose(_ends(nodes[one], nodes[other], bottom)), **style)
    for number, (one, other) in enumerate(pairwise(graph.gait), start=1):
        ends = _ends(nodes[one], nodes[other], bottom)
        _draw_step(axes, ends, [boxes[one], boxes[other]], number)
    axes.set_axis_off()
    axes.margins(x=0.2, y=0.08)


def _ends(one: Node, other: Node, bottom: Node) -> list[Place]:
    """Where an edge leaves its nodes; on the bottom one all ends are apart."""
    return [
        (x + SPREAD * (to - x), y + HALF) if node is bottom else node.at
        for node, (x, y), to in (
            (one, one.at, other.at[0]),
            (other, other.at, one.at[0]),
        )
    ]


def _draw_node(axes: Axes, node: Node, note: str, framed: bool) -> Patch | None:
    text = f"$S_{{{node.name}}}$" + (f"\n{note}" if note else "")
    size, pad, width = (8, 0.35, 1.2) if node.present else (6, 0.2, 0.5)
    colour, edge = (INK, NOMINAL) if node.present else (NOMINAL, ABSENT)
    box: Style = {"boxstyle": f"round,pad={pad}", "edgecolor": edge}
    box |= {"facecolor": "white" if framed else "none", "linewidth": framed * width}
    look: Style = {"fontsize": size, "color": colour, "ha": "center", "va": "center"}
    return axes.annotate(text, node.at, zorder=4, bbox=box, **look).get_bbox_patch()


def _draw_step(
    axes: Axes, ends: Sequence[Place], boxes: Sequence[Patch | None], number: int
) -> None:
    """An arrow beside its edge, from the box of a node to that of the next."""
    start, end = np.array(ends)
    lane = np.array([LANE * np.sign(end[1] - start[1]), 0.0])
    both = zip(ends, boxes, strict=True)
    first, last = (None if at[1] == HALF else box for at, box in both)
    arrow: Style = {"color": INK, "linewidth": 1.0, "mutation_scale": 8, "zorder": 2}
    arrow |= {"patchA": first, "patchB": last, "shrinkA": 0, "shrinkB": 0}
    arrow["arrowstyle"] = "-|>"
    axes.add_patch(FancyArrowPatch(start + lane, end + lane, **arrow))
    way = NUMBERED if end[1] > start[1] else 1 - NUMBERED  # beside that back
    x, y = start + lane + way * (end - start)
    axes.text(x, y, str(number), zorder=3, **numbered(INK))


def numbered(colour: str) -> Style:
    """The look of a number in a disc, as matplotlib's text takes it."""
    box = {"boxstyle": "circle,pad=0.15", "facecolor": colour, "edgecolor": "none"}
    look: Style = {"color": "white", "fontsize": 6.5, "bbox": box}
    return look | {"ha": "center", "va": "center"}


def _rows(name: str, graph: Graph) -> Iterator[tuple[Cell, ...]]:
    """The strata of a system, by their names, and the places of its gait."""
    for node in filter(lambda node: node.present, graph.nodes.values()):
        own = node.name
        near = [f"S{b if a == own else a}" for a, b in graph.joined if own in (a, b)]
        places = [str(i) for i, s in enumerate(graph.gait, start=1) if s == own]
        cells = (" ".join(several) or "none" for several in (node.fields, near, places))
        yield name, f"S{own}", len(node.feet), graph.dimensions[own], *cells


def draw_sheets(axes: Axes3D, span: tuple[float, float], top: float = 1.25) -> None:
    """Draw S1 and S2 up to a height of feet, and the line S12 that they share."""
    low, high = span
    for stratum, (y, z) in (("1", (0, top)), ("2", (top, 0))):
        corners = [(low, 0, 0), (high, 0, 0), (high, y, z), (low, y, z)]
        faint: Style = {"facecolor": STRATA[stratum], "alpha": 0.12}
        axes.add_collection3d(Poly3DCollection([corners], edgecolor="none", **faint))
    axes.plot([low, high], [0, 0], [0, 0], color=INK, linewidth=1.2)
    axes.text(high, 0, top, "$S_1$", color=STRATA["1"], ha="right", va="top")
    axes.text(high, top, 0.02, "$S_2$", color=STRATA["2"], ha="right")
    axes.text(high, 0, 0, " $S_{12}$", ha="left", va="top")
    axes.text(high, top, top, "$h_2$", ha="center", va="bottom")
    axes.set(xlim=span, ylim=(0, top), zlim=(0, top), yticks=(1,), zticks=(1,))
    axes.set_ylabel("$h_1$", labelpad=-10)
    axes.tick_params(pad=-4)
    axes.view_init(elev=24, azim=-52)
    axes.set_box_aspect((1.5, 1.1, 1.0), zoom=1.2)
    axes.grid(visible=False)
    for pane in (axes.xaxis, axes.yaxis, axes.zaxis):
        pane.set_pane_color((1, 1, 1, 0))


def draw_way(axes: Axes, points: Array, strata: Sequence[str]) -> None:
    """Draw points (anything, height 1, height 2), (N, 3), in colours of the strata."""
    changes = np.flatnonzero(np.array(strata[1:]) != strata[:-1]) + 1
    for begin, end in pairwise([0, *changes, len(strata)]):
        colour = STRATA[strata[begin]]
        axes.plot(*points[begin : end + 1].T, color=colour, linewidth=1.6)
