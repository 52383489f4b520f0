"""Figs. 1 to 4 on the systems themselves: what they draw is what the algebra says."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure

from models.systems.catalogue import shipped_system
from planner.extension.height_functions import stratified_panels
from planner.planning.rollouts import play
from sim.figures import panels, sequence
from sim.figures.sheet import drawn
from sim.figures.strata import draw_graph, graph_of

WALKERS = (
    "biped",
    "paper-hexapod",
    "quadruped-crawl",
    "octopod-pairs",
    "finger-gaiting",
)
ROUNDING = 1e-12


def graph_named(name):
    problem = shipped_system(name)
    return problem, graph_of(problem.system, problem.gait)


@pytest.mark.parametrize("name", WALKERS)
def test_a_graph_holds_the_strata_and_edges_of_the_system(name):
    problem, graph = graph_named(name)
    system = problem.system
    present = {node.name for node in graph.nodes.values() if node.present}
    assert present == set(system.strata)
    assert set(graph.joined) == set(system.edges)
    feet = len(graph.nodes[system.bottom].feet)
    assert len(graph.nodes) == 2**feet
    assert len(graph.edges) == feet * 2 ** (feet - 1)  # of a cube in as many dimensions
    for low, high in graph.edges:
        assert len(graph.nodes[low].feet - graph.nodes[high].feet) == 1
    for node in graph.nodes.values():
        if node.present:
            assert graph.dimensions[node.name] + len(node.feet) == system.dimension


@pytest.mark.parametrize("name", WALKERS)
def test_a_gait_is_drawn_along_edges_and_closes(name):
    problem, graph = graph_named(name)
    joined = {frozenset(edge) for edge in graph.joined}
    assert graph.gait[0] == graph.gait[-1] == problem.system.bottom
    assert all(frozenset(step) in joined for step in pairwise(graph.gait))
    axes = Figure().add_subplot()
    draw_graph(axes, graph)
    written = [text.get_text() for text in axes.texts]
    numbers = [text for text in written if text.isdigit()]
    assert numbers == [str(i) for i in range(1, len(problem.gait))]
    assert {f"$S_{{{s}}}$" for s in problem.system.strata} <= set(written)


@pytest.mark.parametrize("name", WALKERS)
def test_a_graph_takes_most_of_its_panel_and_stays_inside(name):
    _, graph = graph_named(name)
    axes = Figure().add_subplot()
    draw_graph(axes, graph)
    places = np.array([node.at for node in graph.nodes.values()])
    limits = np.array([axes.get_xlim(), axes.get_ylim()])
    share = np.ptp(places, axis=0) / np.ptp(limits, axis=1)
    assert (share > 1 / 2).all()
    assert (share < 1).all()


def test_strata_one_foot_higher_are_drawn_one_row_higher():
    _, graph = graph_named("quadruped-crawl")
    for low, high in graph.edges:
        assert graph.nodes[high].at[1] - graph.nodes[low].at[1] == 1
    places = [node.at for node in graph.nodes.values()]
    assert len(set(places)) == len(places)


@pytest.fixture(
    scope="module", params=["mechanism", "biped", "quadruped", "sequence", "panels"]
)
def sheet(request):
    return drawn(request.param, "paper")


def test_every_sheet_has_panels_a_key_and_numbers(sheet):
    assert "{" not in sheet.caption
    assert sheet.table.rows
    titles = [axes.get_title(loc="left") for axes in sheet.figure.axes]
    several = sum(map(bool, titles)) > 1
    assert any(title.startswith("(a)") for title in titles) == several
    legends = [
        *sheet.figure.legends,
        *(axes.get_legend() for axes in sheet.figure.axes),
    ]
    assert any(legends)


def test_robots_have_legs_that_meet_in_their_pivots_only_if_they_do():
    rows = drawn("mechanism", "metres").table.rows
    for name, meet in (("hexapod", True), ("hexapod-parallel", False)):
        legs = [row for row in rows if row[0] == name and row[2] == "1"]
        lines = [np.array(row[3:7], dtype=float).reshape(2, 2) for row in legs]
        pivot = np.array([0.0, 0.0675])
        off = [np.cross(np.append(foot - hip, 0), np.append(pivot - hip, 0))[2]
               / np.hypot(*(foot - hip)) for hip, foot in lines]  # fmt: skip
        assert (np.abs(off).max() < ROUNDING) == meet


def test_margins_of_robots_stand_with_their_strata():
    rows = {row[1]: row[-1] for row in drawn("quadruped", "metres").table.rows}
    assert set(rows) == {"S1234", "S123", "S124", "S134", "S234"}
    assert rows["S123"] < 0 < rows["S134"] < rows["S1234"]  # as its caption says


def test_lifts_commute_with_strokes_so_that_the_sequence_is_its_strokes():
    system = shipped_system("biped").system
    start = np.zeros(system.dimension)
    end = play(system, sequence.SEQUENCE, start)[-1]
    reordered = play(system, sequence.REORDERED, start)[-1]
    alone = play(system, [f for f in sequence.SEQUENCE if f.field[-1] != "3"], start)
    assert reordered == pytest.approx(end, abs=ROUNDING)
    assert alone[-1] == pytest.approx(end, abs=ROUNDING)


def test_the_sequence_leaves_the_bottom_stratum_and_comes_back():
    rows = drawn("sequence", "paper").table.rows
    heights = np.array([row[-2:] for row in rows], dtype=float)
    assert heights[[0, 3, 6]] == pytest.approx(0.0, abs=ROUNDING)
    assert [row[1] for row in rows] == ["S12", *["S1"] * 3, *["S2"] * 3]
    assert heights[[1, 2]] == pytest.approx(np.tile([0, 1], (2, 1)), abs=ROUNDING)
    assert heights[[4, 5]] == pytest.approx(np.tile([1, 0], (2, 1)), abs=ROUNDING)


def test_the_loops_drawn_change_the_pose_by_the_heights_drawn():
    system = shipped_system("paper-hexapod").system
    made = stratified_panels(system, panels.STROKES)
    sheet = drawn("panels", "paper")
    for first, second, x, y, *flows, alone in sheet.table.rows:
        assert flows == pytest.approx([x, y], abs=ROUNDING)
        by_hand = made.change("y", (0, 0), (first, second))
        assert y == by_hand != pytest.approx(alone, rel=1e-3)
    coloured = sheet.figure.axes[0].collections[0]
    low, high = coloured.get_array().min(), coloured.get_array().max()
    assert (low, high) == pytest.approx((-2, 2), rel=0.1)  # between levels
