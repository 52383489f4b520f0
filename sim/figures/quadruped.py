"""Fig. 3: the strata of four feet, and a crawl that lifts one at a time."""

from __future__ import annotations

from collections.abc import Mapping

from models import shipped_system
from sim.figures.biped import robots_sheet
from sim.figures.graphs import draw_graph, graph_of, key, table_of
from sim.figures.physics import Job, Walked
from sim.figures.sheet import Sheet, words
from sim.figures.style import letter, sheet_of

PAPER_CAPTION = """
All sixteen sets of feet on which four legs can stand, and of these the strata of the
system `quadruped-crawl` with its gait, drawn from the system itself. Each row has one
foot fewer on the ground than the row below it; an edge lifts or sets down one foot. The
crawl uses the two lowest rows: it sets a foot down before it lifts the next one.
"""
METRES_CAPTION = """
The robot `quadruped` in MuJoCo with the gait of its card. Below each stratum: its
margin of static stability with all legs at angle 0. On S123 and S124, with a rear leg
in the air, the robot would tip over there (negative), and with a front leg it would
stand only just: it swings its legs to where it is safer before it lifts one.
"""
ROBOT = "quadruped"
WALKS: Mapping[str, Job] = {}


def paper() -> Sheet:
    """The crawl of four legs within all sets of their feet."""
    figure, axes = sheet_of("a", 4.2)
    problem = shipped_system("quadruped-crawl")
    graphs = {problem.name: graph_of(problem.system, problem.gait)}
    draw_graph(axes["a"], graphs[problem.name])
    key(figure, absent=True)
    letter(axes, {"a": problem.name})
    return Sheet(
        name="fig3-quadruped-paper",
        title="Fig. 3, strata of four feet, in the paper's units",
        caption=words(PAPER_CAPTION),
        figure=figure,
        table=table_of(graphs),
    )


def metres(walks: Mapping[str, Walked]) -> Sheet:
    """The robot that crawls in MuJoCo, with its margins.

    Args:
        walks: None are needed.
    """
    title = "Fig. 3, strata of four legs, in metres"
    return robots_sheet("fig3-quadruped-metres", title, METRES_CAPTION, [ROBOT], 4.2)
