"""Figures on the paper's kinematics: what they show is so, and they are drawn."""

import csv
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from models.morphology import PIVOT
from planner.planning.paths import ellipse, line
from sim.figures import NAMES, corridor, diagonal, stability
from sim.figures.diagonal import footprints
from sim.figures.line import GOAL
from sim.figures.paper import (
    configuration,
    envelope,
    exponent,
    feet,
    standing,
    swing_out,
    tube,
    walk,
)
from sim.figures.sheet import KINDS, Table, drawn, layouts, page, save
from sim.figures.stability import sign_map
from sim.figures.style import extremes
from sim.scenarios.file import load_scenario

ROUNDING = 1e-12
ALL = ("line", "ellipse", "diagonal", "corridor")


@pytest.fixture(scope="module")
def turning():
    path = line(configuration((0, 0, 0)), configuration((1.0, 1.0, 0.5)))
    return walk(path, 4, fields="lifted")


def test_the_tube_is_as_wide_as_the_square_root_of_its_segments():
    measured = tube(GOAL, (15, 60, 240, 960))
    # the next term is of relative size sqrt(length): 0.05 and less over this range
    assert exponent(measured.length, measured.width) == pytest.approx(0.5, abs=0.02)
    assert exponent(measured.length, measured.turn) == pytest.approx(0.5, abs=0.02)


def test_the_end_error_falls_as_one_over_the_number_of_segments():
    measured = tube(GOAL, (30, 60, 120))
    products = measured.error * measured.segments
    assert products == pytest.approx([0.042] * 3, abs=5e-4)  # two digits given


def test_feet_stand_still_under_the_paper_s_equations(turning):
    """Eqs. (17), (18) turn the body about its loaded tripod's pivot."""
    prints = footprints(feet(turning), standing(turning))
    assert len(prints.foot) > 6
    assert prints.slid.max() < ROUNDING


def test_a_foot_leaves_a_new_print_only_where_it_was_in_the_air(turning):
    on_ground = standing(turning)
    prints = footprints(feet(turning), on_ground)
    for foot, begin, end in zip(prints.foot, prints.begin, prints.end, strict=True):
        assert on_ground[begin : end + 1, foot].all()
        assert begin == 0 or not on_ground[begin - 1, foot]
        assert end == len(on_ground) - 1 or not on_ground[end + 1, foot]
    stood = sum(prints.end + 1 - prints.begin)
    assert stood == on_ground.sum()


def test_both_choices_of_fields_walk_the_body_the_same_way():
    path = ellipse(configuration((0, 0, 0)), (1.0, 0.6))
    paper, lifted = (walk(path, 8, fields=fields) for fields in ("paper", "lifted"))
    ends = paper.states[paper.ends], lifted.states[lifted.ends]
    assert ends[0][:, :3] == pytest.approx(ends[1][:, :3], abs=ROUNDING)


def test_a_chain_that_leaves_its_nominal_is_measured_segment_by_segment():
    points = np.array([(0, 0), (1, 0.5), (2, 0), (3, -2), (4, 0)], float)
    nominal = np.array([(0, 0), (4, 0)], float)
    assert swing_out(points, np.array([2, 4]), nominal) == pytest.approx([0.5, 2.0])


def test_closed_form_and_polygon_disagree_nowhere_in_the_drawing():
    signs = sign_map(stability.STANCE)
    assert (signs.closed > 0).any()
    assert (signs.closed < 0).any()
    assert signs.disagreements == 0


@pytest.fixture(scope="module")
def sheet():
    return drawn("diagonal", "paper")


def test_a_sheet_is_saved_as_pictures_and_numbers(sheet, tmp_path):
    save(sheet, tmp_path)
    with Image.open(tmp_path / f"{sheet.name}.png") as picture:
        assert picture.width > 1500  # seven inches at 300 dots each, trimmed
        assert np.ptp(np.asarray(picture.convert("L"))) > 200  # ink on paper
    drawing = ET.parse(tmp_path / f"{sheet.name}.svg").getroot()
    assert len(list(drawing.iter("{http://www.w3.org/2000/svg}path"))) > 20
    with (tmp_path / f"{sheet.name}.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == list(sheet.table.header)
    assert [float(cell) for cell in rows[1]] == [float(c) for c in sheet.table.rows[0]]


def test_the_same_sheet_is_saved_as_the_same_bytes(sheet, tmp_path):
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        save(sheet, tmp_path / name)
    for kind in ("png", "svg", "csv"):
        first, second = (
            (tmp_path / name / f"{sheet.name}.{kind}").read_bytes()
            for name in ("first", "second")
        )
        assert first == second


def test_the_page_shows_every_sheet_with_caption_and_numbers(sheet):
    text = page([sheet])
    assert f"({sheet.name}.png)" in text
    assert sheet.caption in text
    assert "| tripod | leg |" in text


def test_a_row_has_one_cell_a_column():
    with pytest.raises(ValueError, match="row 1 has 1 cells for 2 columns"):
        Table(("a", "b"), ((1, 2), (3,)))


def test_an_envelope_joins_the_farthest_points_of_each_segment():
    points = np.array([(0, 0), (1, 0.5), (2, 0), (3, -2), (3.5, 1), (4, 0)], float)
    ends = np.array([2, 5])
    right, left = envelope(points, ends, points[-1])
    assert right.tolist() == [[0, 0], [3, -2]]
    assert left.tolist() == [[1, 0.5], [3.5, 1]]


def test_a_band_lies_between_the_extremes_of_each_segment():
    values, segment = np.array([3.0, 1.0, 2.0, 7.0, 5.0]), np.array([0, 0, 0, 1, 1])
    least, most = extremes(values, segment)
    assert (least.tolist(), most.tolist()) == ([1, 5], [3, 7])


@pytest.fixture(scope="module")
def papers():
    return {name: drawn(name, "paper") for name in ALL}


def panel_of(sheet, letter):
    return {a.get_title(loc="left")[1:2]: a for a in sheet.figure.axes}[letter]


def test_panels_are_in_reading_order(papers):
    """From left to right, then down: (a), (b), (c), ..."""
    figure = papers["line"].figure
    figure.canvas.draw()
    places = {a.get_title(loc="left")[1]: a.get_position() for a in figure.axes}
    for row in ("abc", "def"):
        assert sorted(row, key=lambda name: places[name].x0) == list(row)
    assert all(places[up].y0 > places[down].y1 for up in "abc" for down in "def")


def test_many_segments_are_drawn_as_areas_and_not_as_combs(papers):
    """No curve of Fig. 6 (d) or Fig. 7 (c) goes to and fro in every segment."""
    for name, letter in (("line", "d"), ("ellipse", "c"), ("corridor", "d")):
        panel = panel_of(papers[name], letter)
        assert panel.patches or panel.collections
        for curve in panel.lines:
            heights = np.asarray(curve.get_ydata(), dtype=float)
            assert (np.diff(np.sign(np.diff(heights))) != 0).sum() < 12


def test_the_nominal_path_of_the_diagonal_leads_from_the_start_to_the_goal(papers):
    (nominal,) = (
        curve for curve in panel_of(papers["diagonal"], "b").lines
        if curve.get_label() == "nominal"
    )  # fmt: skip
    assert nominal.get_xydata().tolist() == [[0, 0], list(diagonal.GOAL[:2])]


def test_the_robot_is_drawn_at_the_start_and_at_the_end_of_its_passage(papers):
    """An outline is as large as the robot, about five pivots' distances."""
    path = load_scenario("corridor").path
    for letter in "ab":
        outlines = [
            patch.get_path().get_extents() for patch in panel_of(
                papers["corridor"], letter
            ).patches
            if to_hex(patch.get_edgecolor()) == corridor.OUTLINE
        ]  # fmt: skip
        for place in (path(0.0), path(1.0)):
            at = place[:2] / PIVOT
            assert any(box.contains(*at) and box.width < 10 for box in outlines)


def test_the_body_is_drawn_with_the_outer_hips_at_its_corners():
    axes = Figure().add_subplot()
    front = stability.draw_body(axes)
    drawn_corners = {tuple(corner) for corner in axes.lines[0].get_xydata().round(12)}
    hips = np.concatenate([stability.STANCE.hips(tripod) for tripod in (1, 2)])
    outer = hips[np.abs(hips[:, 0]) > 0]
    assert drawn_corners == {tuple(hip) for hip in outer.round(12)}
    assert front == outer[:, 0].max()


def test_the_table_of_the_ellipse_ends_with_its_last_segment_and_leaves_even_gaps(
    papers,
):
    segments = [row[0] for row in papers["ellipse"].table.rows]
    assert segments == [5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60]


def test_every_leg_is_numbered_among_its_footprints(papers):
    written = {t.get_text() for t in papers["diagonal"].figure.axes[0].texts}
    assert {"1", "2", "3", "4", "5", "6"} <= written


def test_a_sheet_is_saved_under_its_title(papers, tmp_path):
    sheet = papers["ellipse"]
    save(sheet, tmp_path)
    assert sheet.figure.get_suptitle() == sheet.title
    keys = [*sheet.figure.legends, *(a.get_legend() for a in sheet.figure.axes)]
    assert any(keys)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", NAMES)
def test_a_caption_says_what_every_panel_is(name, kind):
    layout = layouts()[name][kind]
    letters = re.findall(r"\((\w)\)", layout.caption)
    for first, last in re.findall(r"\((\w)\) to \((\w)\)", layout.caption):
        letters += map(chr, range(ord(first), ord(last)))
    assert len(layout.panels) == 1 or set(letters) >= set(layout.panels)
