"""Fig. 2: the strata of a biped, and of robots that walk on two sets of feet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from models import Kinematics, Robot, equations, load, shipped_system
from sim.figures.graphs import draw_graph, graph_of, key, table_of
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Sheet, Table, words
from sim.figures.sheets_crossing import draw_sheets
from sim.figures.style import MM, letter, sheet_of
from sim.motion.stability import margin_at_rest

PAPER_CAPTION = """
(a) The configuration space of a biped where both feet are near the ground, by the
heights of the feet; all other coordinates are the one axis along which the sheets
cross. On S1 foot 1 stands, on S2 foot 2, and on S12 both. (b), (c) The strata of the
systems `biped` and `paper-hexapod` with their gaits, drawn from the systems themselves.
The hexapod walks in tripods, each of which counts as one foot, so its strata are those
of a biped; S0, with both tripods in the air, is in its system and not in its gait, and
the biped's system does without it (grey). The biped has no field on S12: with both feet
down it cannot move.
"""
METRES_CAPTION = """
The strata of three robots in MuJoCo that stand on two groups of legs in turn, with the
gaits of their cards. Below each stratum: its margin of static stability with all legs
at angle 0. No robot has a stratum without feet on the ground (grey): it would fall.
"""
SYSTEMS = ("biped", "paper-hexapod")
ROBOTS = ("hexapod", "hexapod-radial", "octopod")
WALKS: Mapping[str, Job] = {}


def paper() -> Sheet:
    """The biped's configuration space, its graph and that of the paper's hexapod."""
    figure, axes = sheet_of(
        "abc", 3.2, width_ratios=[1.1, 1, 1],
        per_subplot_kw={"a": {"projection": "3d", "computed_zorder": False}},
    )  # fmt: skip
    draw_sheets(axes["a"], (0.0, 1.0))
    axes["a"].set_xlabel("everything else", labelpad=-12)
    axes["a"].set_xticks([])
    problems = {name: shipped_system(name) for name in SYSTEMS}
    graphs = {n: graph_of(p.system, p.gait) for n, p in problems.items()}
    for name, graph in zip("bc", graphs.values(), strict=True):
        draw_graph(axes[name], graph)
    key(figure, absent=True)
    letter(
        axes, {"a": "the biped's configurations", "b": "biped", "c": "paper-hexapod"}
    )
    return Sheet(
        name="fig2-biped-paper",
        title="Fig. 2, strata of two feet, in the paper's units",
        caption=words(PAPER_CAPTION),
        figure=figure,
        table=table_of(graphs),
    )


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """Robots that walk on two groups of legs, with their margins.

    Args:
        walks: None are needed.
    """
    title = "Fig. 2, strata of two groups of legs, in metres"
    return robots_sheet("fig2-biped-metres", title, METRES_CAPTION, ROBOTS, 2.7)


def robots_sheet(
    name: str, title: str, caption: str, robots: Sequence[str], height: float
) -> Sheet:
    """The strata of shipped robots with the gaits of their cards and their margins.

    Args:
        name: Of the sheet.
        title: Of the sheet.
        caption: What there is to see.
        robots: Their names, at most three.
        height: Of the sheet [in].
    """
    letters = "abc"[: len(robots)]
    figure, axes = sheet_of(letters, height)
    graphs, margins = {}, {}
    for place, robot in zip(letters, map(load, robots), strict=True):
        own = equations(robot).system, robot.card.gait
        graphs[robot.name], margins[robot.name] = graph_of(*own), robot_margins(robot)
        draw_graph(axes[place], graphs[robot.name], in_words(margins[robot.name]))
    key(figure, absent=True)
    letter(axes, dict(zip(letters, robots, strict=True)))
    return Sheet(
        name=name,
        title=title,
        caption=words(caption),
        figure=figure,
        table=with_margins(table_of(graphs), margins),
    )


def robot_margins(robot: Robot) -> dict[str, float]:
    """Margin of a robot on every stratum, all legs at angle 0 [m]."""
    kinematics = Kinematics(robot)
    strata = dict.fromkeys(robot.card.gait)
    return {stratum: margin_at_rest(kinematics, stratum) for stratum in strata}


def in_words(margins: Mapping[str, float]) -> dict[str, str]:
    """Margins as notes below the names of strata."""
    return {stratum: f"{MM * margin:.0f} mm" for stratum, margin in margins.items()}


def with_margins(table: Table, margins: Mapping[str, Mapping[str, float]]) -> Table:
    """The table of strata with the margin of each in a last column."""
    return Table(
        header=(*table.header, "margin with legs at angle 0 [m]"),
        rows=tuple((*row, margins[str(row[0])][str(row[1])[1:]]) for row in table.rows),
    )
