"""Colours: no two meanings share one, for readers with and without all three cones."""

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from models.morphology.mjcf import COLOURS
from sim import palette
from sim.world.sensors import COLOUR

ROOT = Path(__file__).parents[2]
TINTS = 4  # groups of the shipped robots, at most
MEANINGS = {
    "paper": palette.PAPER,
    "grid": palette.GRID,
    "contours": palette.RELIEF,
    "text and centre of mass": palette.TEXT,
    "outline": palette.OUTLINE,
    "swept": palette.SWEPT,
    "obstacle": palette.OBSTACLE,
    "support polygon": palette.STABLE,
    "limit": palette.LIMIT,
    "nose": palette.Colour(242, 140, 38),  # of the shipped robots
    "nominal": palette.NOMINAL.colour,
    "achieved": palette.ACHIEVED.colour,
    "thought": palette.THOUGHT.colour,
    **{name: mark.colour for name, mark in palette.PREDICTED.items()},
    **{f"group {i}": colour for i, colour in enumerate(palette.GROUPS)},
    **{f"footprint of group {i}": palette.footprint(i) for i in range(TINTS)},
}
RUNS = {name: MEANINGS[name] for name in ("paper", "nominal", "obstacle", "limit")} | {
    f"run {i}": colour for i, colour in enumerate(palette.RUNS)
}
OUTCOMES = {f"outcome {i}": colour for i, colour in enumerate(palette.OUTCOMES)}
# Machado, Oliveira and Fernandes 2009, severity 1, on linear sRGB.
SIGHT = {
    "all cones": np.eye(3),
    "protanopia": np.array([
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ]),
    "deuteranopia": np.array([
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ]),
    "tritanopia": np.array([
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ]),
}  # fmt: skip
TO_XYZ = np.array([
    [0.4124564, 0.3575761, 0.1804375],
    [0.2126729, 0.7151522, 0.0721750],
    [0.0193339, 0.1191920, 0.9503041],
])  # fmt: skip
APART = 8.0  # in CIE Lab; about 2 can be told apart side by side


def lab(colour, sight):
    """Coordinates in CIE Lab of a colour as it is seen, white point D65."""
    share = np.array(colour) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    xyz = TO_XYZ @ np.clip(SIGHT[sight] @ linear, 0, 1) / TO_XYZ.sum(axis=1)
    x, y, z = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def too_close(meanings, sight):
    seen = {name: lab(colour, sight) for name, colour in meanings.items()}
    return {
        f"{one} and {other}: {np.linalg.norm(seen[one] - seen[other]):.1f}"
        for one, other in combinations(seen, 2)
        if np.linalg.norm(seen[one] - seen[other]) < APART
    }


@pytest.mark.parametrize("sight", SIGHT)
@pytest.mark.parametrize(
    "picture", [MEANINGS, OUTCOMES, RUNS], ids=["walk", "map", "runs compared"]
)
def test_meanings_of_one_picture_are_told_apart(picture, sight):
    assert too_close(picture, sight) == set()


def luminance(colour):
    share = np.array(colour) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return TO_XYZ[1] @ linear


@pytest.mark.parametrize("hue", [*palette.GROUPS, *palette.OUTCOMES])
@pytest.mark.parametrize("strength", [0.5, 0.75, 1.0])
def test_words_on_a_colour_are_written_in_the_ink_that_is_read_best(hue, strength):
    """Contrast as the rules for accessible pages count it, 3 for large letters."""
    colour = hue.tint(strength)
    inks = {
        ink: (max(pair) + 0.05) / (min(pair) + 0.05)
        for ink in (palette.WHITE, palette.TEXT)
        for pair in [(luminance(colour), luminance(ink))]
    }
    assert inks[colour.ink] > 0.8 * max(inks.values())
    assert inks[colour.ink] > 3.9  # measured; white on the middle green had 2.6


def test_a_colour_is_the_same_to_mujoco_and_to_matplotlib():
    colour = palette.Colour(10, 100, 200)
    assert colour.rgba() == pytest.approx(to_rgba(colour.hex))
    assert colour.rgba(0.3) == pytest.approx(to_rgba(colour.hex, 0.3))


def test_no_two_meanings_share_a_colour():
    every = [*MEANINGS.values(), *OUTCOMES.values(), *palette.RUNS]
    assert len(set(every)) == len(every)


def test_pictures_take_their_colours_from_the_palette():
    """No module of pictures, figures, pages and viewers has a colour of its own."""
    rooms = ("pictures", "viewing", "figures", "reports", "studies")
    files = [p for room in rooms for p in (ROOT / "sim" / room).rglob("*.py")]
    own = re.compile(
        r"""["']#[0-9A-Fa-f]{6}|tab:|Colour\(\d|["'](?:red|green|blue)["']"""
    )
    assert len(files) > 40
    assert [str(p) for p in files if own.search(p.read_text())] == []


def test_pictures_of_the_pages_have_colours_of_the_palette():
    """Scripts know the front door of `sim` alone, and write them down."""
    written = {
        code
        for path in (ROOT / "scripts").glob("*.py")
        for code in re.findall(r"""["'](#[0-9a-f]{6})["']""", path.read_text())
    }
    known = [*palette.RUNS, palette.LIMIT]
    known += [mark.colour for mark in palette.PREDICTED.values()]
    assert written
    assert written <= {colour.hex for colour in known}


def test_colours_too_close_are_found():
    close = {"one": palette.PAPER, "other": palette.Colour(246, 247, 246)}
    assert too_close(close, "all cones")


def test_white_is_where_cie_lab_has_it():
    assert lab((255, 255, 255), "all cones") == pytest.approx([100, 0, 0], abs=0.01)


def test_predictions_are_told_apart_in_grey_by_their_dashes():
    dashes = [mark.dashes for mark in palette.PREDICTED.values()]
    assert len(set(dashes)) == len(dashes)


@pytest.mark.parametrize("mark", palette.PREDICTED.values())
def test_dashes_begin_where_their_line_begins(mark):
    assert mark.line()["linestyle"] in ("-", (0.0, mark.dashes))


def test_walls_are_opaque_and_have_a_colour_that_there_is():
    assert COLOUR[3] == 1
    assert all(0 <= share <= 1 for share in COLOUR)


def test_legs_of_a_robot_have_the_colour_of_their_groups_footprints():
    painted = [
        tuple(round(255 * float(c)) for c in text.split()[:3]) for text in COLOURS
    ]
    assert painted == list(palette.GROUPS)
