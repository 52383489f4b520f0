"""Paths by formulas and by tables: poses, exact lengths, and how they are refused."""

import math

import numpy as np
import pytest
from scipy.special import ellipe

from sim.errors import UsageError
from sim.scenarios.body_path import decode, encode, line
from sim.scenarios.file import dumps, load_scenario

S = {"kind": "formulas", "x": "0.15*s", "y": "0.02*sin(2*pi*s)", "yaw": "pi/2*s"}


def test_formulas_give_poses():
    path = decode(S)
    assert path(0.25) == pytest.approx([0.0375, 0.02, math.pi / 8], abs=1e-15)
    assert path.goal == pytest.approx((0.15, 0, math.pi / 2), abs=1e-15)
    assert decode(encode(path)) == path


def test_arc_length_of_formulas_is_exact():
    circle = decode({"kind": "formulas", "x": "sin(2*pi*s)", "y": "1 - cos(2*pi*s)"})
    assert circle.length == pytest.approx(2 * math.pi, rel=1e-12)
    a, b = 0.10, 0.06
    words = {"x": f"{a}*cos(2*pi*s) - {a}", "y": f"{b}*sin(2*pi*s)"}
    ellipse = decode({"kind": "formulas", **words})
    assert ellipse.length == pytest.approx(4 * a * ellipe(1 - (b / a) ** 2), rel=1e-12)
    shipped = decode({"kind": "ellipse", "semi_axes": [a, b]})
    s = np.linspace(0, 1, 7)
    assert ellipse.curve.at(s) == pytest.approx(shipped.curve.at(s), abs=1e-15)


def test_table_passes_through_its_poses_without_corners(tmp_path):
    turns = np.linspace(0, math.pi / 2, 200)
    poses = np.stack([np.sin(turns), 1 - np.cos(turns), turns], axis=-1)
    path = decode({"kind": "table", "poses": poses.tolist()})
    where = np.linspace(0, 1, 200)  # evenly spaced poses
    assert path.curve.at(where) == pytest.approx(poses, abs=1e-9)
    assert path.curve.corners == ()
    assert path.length == pytest.approx(math.pi / 2, rel=1e-4)  # of cubics in between
    assert decode(encode(path)) == path


def test_file_beside_the_scenario_is_read_and_kept_as_poses(tmp_path, monkeypatch):
    lines = ["yaw, x ,y", "0,0,0", "0.1,0.05,0.0", "0.2,0.1,0.05"]
    (tmp_path / "poses.csv").write_text("\n".join(lines))
    scenario = tmp_path / "mine.toml"
    scenario.write_text('[path]\nkind = "table"\nfile = "poses.csv"\n')
    monkeypatch.chdir("/")
    loaded = load_scenario(str(scenario))
    assert loaded.path.goal == (0.1, 0.05, 0.2)
    again = tmp_path / "again.toml"
    again.write_text(dumps(loaded))
    (tmp_path / "poses.csv").unlink()
    assert load_scenario(str(again)).path == loaded.path


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"kind": "formulas", "x": "s + 1"}, r"is not allowed.*\[0, 0, 0\]"),
        ({"kind": "formulas", "x": "t"}, "t"),
        ({"kind": "formulas", "x": "log(s)"}, "not finite at s = 0"),
        ({"kind": "formulas", "x": True}, "x is True"),
        ({"kind": "formulas", "z": "s"}, "z"),
        ({"kind": "formulas", "x": "0*s"}, "all poses are the same: path; let x"),
        (
            {"kind": "formulas", "x": "1e9*s"},
            r"path\(1\) = .*give numbers, none beyond",
        ),
        ({"kind": "table"}, "file"),
        ({"kind": "table", "poses": [[0, 0, 0]]}, "at least two poses"),
        ({"kind": "table", "poses": [[0, 0, 0]] * 2}, "all poses are the same"),
        ({"kind": "table", "poses": [[1, 0, 0]] * 2}, "the start pose"),
        ({"kind": "table", "file": "nowhere.csv"}, "cannot be read, No such file"),
        ({"kind": "table", "file": 3}, "the name of a CSV file"),
    ],
)
def test_impossible_curves_are_refused(table, message):
    with pytest.raises(UsageError, match=message):
        decode(table)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (b"x,y\n0,0", "no column 'yaw'"),
        (b"x,y,yaw,x\n0,0,0,0", "two columns 'x'"),
        (b"x,y,yaw\n0,0,0\n\n\n1,a,0", "line 5 holds no pose: .*; give numbers"),
        (b"x,y,yaw\n0,0,0\n1_0,0,0", "line 3 holds no"),
        ("x,y,yaw\n0,0,0\n\u0661,0,0".encode(), "line 3 holds no"),
        (b"x,y,yaw\n0,0,0\n1,2,0,3", "line 3 has 4 of 3 columns: .*; part"),
        (b"x,y,yaw\n0,0,0\n0,02", "line 3 has 2 of 3 columns"),
        (b"x,y,yaw\n0,0,\xff", "is no text in UTF-8"),
    ],
)
def test_impossible_files_are_refused(tmp_path, text, message):
    file = tmp_path / "poses.csv"
    file.write_bytes(text)
    with pytest.raises(UsageError, match=message):
        decode({"kind": "table", "file": str(file)})


def test_files_of_spreadsheets_begin_with_a_mark_or_empty_lines(tmp_path):
    """And may have further columns, of whatever kind."""
    file = tmp_path / "poses.csv"
    file.write_text("\n\nx,name,y,yaw\n0,a,0,0\n1,b,0,0\n", encoding="utf-8-sig")
    path = decode({"kind": "table", "file": str(file)})
    assert path.goal == (1, 0, 0)


def test_a_path_that_is_divided_twice_knows_how_it_ran_before():
    path = line((0.2, 0.1, 0.3))
    divided = path.recut(np.array([0.0, 0.1, 1.0])).recut(np.array([0.0, 0.5, 1.0]))
    assert path.undivided is path.curve
    assert divided.undivided is path.curve
    assert divided.curve(0.25) != pytest.approx(path(0.25))
