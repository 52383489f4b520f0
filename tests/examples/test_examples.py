"""The examples run, and show what their docstrings say."""

import ast
import json
import re
from importlib import import_module
from pathlib import Path

import imageio.v3 as iio
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples"
NAMES = sorted(path.stem for path in FOLDER.glob("*.py"))


@pytest.fixture
def shown(capsys):
    """Run an example and return what it prints."""

    def run(name, *words):
        import_module(f"examples.{name}").main(list(words))
        return capsys.readouterr().out

    return run


def numbers(line):
    return [float(word) for word in re.findall(r"[-+]?\d[\d.e+-]*", line)]


def test_every_example_is_run_below():
    source = ast.parse(Path(__file__).read_text())
    calls = [
        node.args[0].value
        for node in ast.walk(source)
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "shown"
    ]
    assert sorted(set(calls)) == NAMES


def test_the_loop_of_a_unicycle_tends_to_the_bracket(shown):
    first, *lines = shown("unicycle_sideways", "--halvings", "8").splitlines()
    assert first == "[drive, turn] = [sin(theta), -cos(theta), 0]"
    ends = [numbers(line.partition("=")[2].partition("=")[2]) for line in lines]
    assert ends[-1] == pytest.approx([0, -1, 0], abs=0.5**8)  # the error is below t


def test_the_third_hall_coordinate_is_5_8_and_3_4_ends_elsewhere(shown):
    out = shown("hall_coordinates")
    assert "Hall coordinates 0.5 0.5 0.625\n" in out
    right, wrong = re.findall(r"lead to x = 0.9589, y = ([\d.]+)", out)
    assert abs(float(right) - 1) < abs(float(wrong) - 1)


def test_the_biped_needs_brackets_across_strata(shown):
    without, across = shown("biped_controllability").split("brackets to degree")[1:]
    assert "no motion along     y" in without
    assert ": controllable" in across
    assert "strata one by one   4 of 5" in across


@pytest.mark.full
@pytest.mark.physics
@pytest.mark.render
def test_the_hexapod_walks_and_is_filmed(shown, tmp_path, driver):
    film = tmp_path / "walk.mp4"
    out = shown("hexapod_in_physics", "--film", str(film), "--playback", "60")
    (off,) = re.findall(r"^quasi-static .* mm  ([\d.]+)%  0", out, re.MULTILINE)
    assert float(off) < 1  # per cent of the path; 0.1 measured
    assert iio.improps(film).shape[0] > 1


def test_the_cupboard_meets_its_goal(shown):
    *_, last, _ = shown("system_of_your_own").splitlines()
    assert numbers(last)[-1] < 1e-9  # what `steer` promises


def test_a_robot_elsewhere_is_steered_by_what_its_camera_sees(shown):
    def segments(pose):
        rows = shown("feedback_from_a_camera", pose).splitlines()
        assert len(rows) == 46  # 11 flows a segment, for each a change of legs
        assert set(json.loads(rows[22]).values()) == {0.0}  # at rest, on all feet
        assert set(json.loads(rows[-1]).values()) == {0.0}
        return rows[:23], rows[23:]

    expected, unseen, aside = "0.004 0 0", "", "0.004 0.003 0.02"
    assert segments(unseen) == segments(expected)
    assert segments(aside)[0] == segments(expected)[0]
    assert segments(aside)[1] != segments(expected)[1]


@pytest.mark.physics
def test_the_paper_fields_part_ideal_from_quasi_static(shown):
    out = shown("predictions_over_segments", "--segments", "2")
    rows = {line.split()[0]: numbers(line) for line in out.splitlines()[1:]}
    _, ideal, real, _ = rows["paper"]
    assert ideal > 100 * real  # measured: 271 times
    _, ideal, real, _ = rows["lifted"]
    assert max(ideal, real) < 0.1  # mm; 0.02 measured
