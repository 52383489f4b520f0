"""Graphs of strata, drawn from systems: Figs. 2 and 3.

Every set of feet on the ground is a node, placed by the number of these feet; the
system has a stratum for some of them. A gait is a closed walk along the edges.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

from planner import Gait, StratifiedSystem
from sim.figures.sheet import Cell, Table
from sim.figures.style import IDEAL, NOMINAL, WEIGHT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ABSENT = "#C8C8C8"
GAIT = "#D55E00"
BOW = 0.16  # of the arrows of a gait, so that there and back are two lines


@dataclass(frozen=True)
class Node:
    """A set of feet on the ground.

    Attributes:
        name: Its feet, `0` for none; the stratum's own name where there is one.
        feet: The feet.
        at: Where it is drawn.
        fields: Fields of its stratum.
        present: Whether the system has such a stratum.
    """

    name: str
    feet: frozenset[str]
    at: tuple[float, float]
    fields: tuple[str, ...]
    present: bool


@dataclass(frozen=True)
class Graph:
    """The strata of a system within all sets of its feet.

    Attributes:
        nodes: By their names, those with more feet on the ground first.
        edges: Pairs (lower, higher) of sets that differ by one foot.
        joined: Pairs of strata that are neighbours in the system's own graph.
        gait: Strata in the order of the gait, the first again at the end.
        dimensions: Dimension of every stratum that there is.
    """

    nodes: Mapping[str, Node]
    edges: tuple[tuple[str, str], ...]
    joined: tuple[tuple[str, str], ...]
    gait: tuple[str, ...]
    dimensions: Mapping[str, int]

    @property
    def steps(self) -> tuple[tuple[str, str], ...]:
        """The gait's steps in order."""
        return tuple(zip(self.gait, self.gait[1:], strict=False))


def graph_of(system: StratifiedSystem, gait: Sequence[str]) -> Graph:
    """The graph of a system's strata and a gait in it.

    Args:
        system: System whose bottom stratum has all its feet on the ground.
        gait: Strata in order, the first again at the end.

    Raises:
        StratumError: The gait is no closed walk in the graph.
    """
    feet = {contact: contact.rpartition("_")[2] for c in system.contacts.values()
            for contact in c}  # fmt: skip
    own = {frozenset(feet[c] for c in system.contacts[s]): s for s in system.strata}
    everything = sorted(set(feet.values()))
    nodes = {}
    for size in range(len(everything), -1, -1):
        level = [frozenset(some) for some in combinations(everything, size)]
        for place, standing in enumerate(level):
            stratum = own.get(standing)
            name = stratum or "".join(sorted(standing)) or "0"
            nodes[name] = Node(
                name=name,
                feet=standing,
                at=(place - (len(level) - 1) / 2, float(len(everything) - size)),
                fields=tuple(system.strata[stratum]) if stratum else (),
                present=stratum is not None,
            )
    edges = tuple(
        (low.name, high.name)
        for low in nodes.values()
        for high in nodes.values()
        if high.feet < low.feet and len(low.feet) == len(high.feet) + 1
    )
    return Graph(
        nodes=nodes,
        edges=edges,
        joined=system.edges,
        gait=Gait(system, tuple(gait)).strata,
        dimensions={
            s: system.dimension - len(system.level_set(s).functions)
            for s in system.strata
        },
    )


def draw_graph(
    axes: Axes, graph: Graph, notes: Mapping[str, str] | None = None
) -> None:
    """Draw a graph with its gait as numbered arrows.

    Args:
        axes: Where to draw.
        graph: What to draw.
        notes: A line to write below the names of some strata.
    """
    at = {name: node.at for name, node in graph.nodes.items()}
    for low, high in graph.edges:
        ends = tuple(zip(at[low], at[high], strict=True))
        axes.plot(*ends, color=ABSENT, linewidth=0.5, zorder=0)
    for low, high in graph.joined:
        ends = tuple(zip(at[low], at[high], strict=True))
        axes.plot(*ends, color=NOMINAL, linewidth=1.2, zorder=1)
    for number, (start, end) in enumerate(graph.steps, start=1):
        _draw_step(axes, at[start], at[end], number, 22 if notes else 13)
    for node in graph.nodes.values():
        _draw_node(axes, node, (notes or {}).get(node.name, ""))
    axes.set_axis_off()
    axes.margins(x=0.2, y=0.14)


def _draw_node(axes: Axes, node: Node, note: str) -> None:
    colour = WEIGHT if node.present else ABSENT
    text = f"$S_{{{node.name}}}$" + (f"\n{note}" if note else "")
    axes.annotate(
        text, node.at, ha="center", va="center", zorder=4,
        fontsize=8 if node.present else 6, color=WEIGHT if node.present else NOMINAL,
        bbox={
            "boxstyle": "round,pad=0.35" if node.present else "round,pad=0.2",
            "facecolor": "white",
            "edgecolor": IDEAL if node.present else colour,
            "linewidth": 1.2 if node.present else 0.5,
        },
    )  # fmt: skip


def _draw_step(
    axes: Axes,
    start: tuple[float, float],
    end: tuple[float, float],
    number: int,
    clear: float,
) -> None:
    """An arrow that ends some points clear of the middle of its nodes."""
    (x0, y0), (x1, y1) = start, end
    arrow = {
        "arrowstyle": "-|>", "color": GAIT, "linewidth": 1.0, "shrinkA": clear,
        "shrinkB": clear, "connectionstyle": f"arc3,rad={BOW}",
    }  # fmt: skip
    axes.annotate("", end, start, arrowprops=arrow, zorder=2)
    share = 0.5
    bow = BOW * share  # a quadratic curve passes half its control point's distance
    x = x0 + share * (x1 - x0) + bow * (y1 - y0)
    y = y0 + share * (y1 - y0) - bow * (x1 - x0)
    axes.annotate(
        str(number), (x, y), ha="center", va="center", fontsize=6.5, color="white",
        zorder=3,
        bbox={"boxstyle": "circle,pad=0.15", "facecolor": GAIT, "edgecolor": "none"},
    )  # fmt: skip


def key(figure: Figure, absent: bool) -> None:
    """Write the key of graphs below them.

    Args:
        figure: Figure that shows the graphs.
        absent: Whether they have sets of feet that are no strata.
    """
    from matplotlib.lines import Line2D

    box: dict[str, Any] = {"marker": "s", "markerfacecolor": "white", "linestyle": ""}
    handles = [
        Line2D([], [], color=IDEAL, markersize=7, label="stratum", **box),
        Line2D([], [], color=NOMINAL, linewidth=1.2, label="lift-off or touchdown"),
        Line2D([], [], color=GAIT, marker=">", label="steps of the gait, in order"),
    ]
    if absent:
        name = "feet on the ground that are no stratum of the system"
        handles.append(Line2D([], [], color=ABSENT, markersize=5, label=name, **box))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))


def table_of(graphs: Mapping[str, Graph]) -> Table:
    """The strata of several systems and the places of their gaits.

    Args:
        graphs: Graphs by the names of systems.
    """
    rows: list[tuple[Cell, ...]] = []
    for name, graph in graphs.items():
        for node in graph.nodes.values():
            if not node.present:
                continue
            near = [b if a == node.name else a for a, b in graph.joined
                    if node.name in (a, b)]  # fmt: skip
            places = [str(i) for i, s in enumerate(graph.gait, start=1)
                      if s == node.name]  # fmt: skip
            rows.append(
                (
                    name,
                    f"S{node.name}",
                    len(node.feet),
                    graph.dimensions[node.name],
                    " ".join(node.fields) or "none",
                    " ".join(f"S{s}" for s in near),
                    " ".join(places) or "none",
                )
            )
    return Table(
        header=(
            "system",
            "stratum",
            "feet on the ground, its codimension",
            "dimension",
            "fields",
            "neighbours",
            "places in the gait",
        ),
        rows=tuple(rows),
    )
