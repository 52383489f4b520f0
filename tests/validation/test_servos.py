"""What hobby servos and imperfect robots promise, on whole walks and in real physics.

Everything is walked open loop but the draws that are replanned. The numbers measured
when the bounds were written stand beside them.
"""

import json

import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.folder import RunFolder
from sim.run_folder import run
from sim.scenarios.file import load_scenario
from sim.simulation import simulate

pytestmark = [pytest.mark.physics, pytest.mark.full]

NOT_TOLD = ("identified", "compliant")
DAMPING = {50.0: 1.0, 20.0: 0.6}  # [N m s/rad] by stiffness
FARTHEST = {50.0: 0.003, 20.0: 0.005}  # of the path
HALF_DEGREE = {"resolution": 0.0089, "command_rate": 60.0, "servo_stiffness": 50.0}


def walked(name, **changes):
    scenario = load_scenario(name, changes)
    return simulate(scenario, without=NOT_TOLD).summary


@pytest.mark.parametrize("stiffness", [50.0, 20.0])
@pytest.mark.parametrize("name", ["line", "ellipse", "diagonal"])
def test_soft_servos_at_fifty_commands_a_second_follow_the_prediction(name, stiffness):
    soft = {"servo_stiffness": stiffness, "servo_damping": DAMPING[stiffness]}
    summary = walked(name, command_rate=50.0, **soft)
    off = summary["error"]["quasi_static"]["farthest"] / summary["path_length"]
    assert off < FARTHEST[stiffness]  # 0.0005 to 0.0017 measured


def test_servos_of_half_a_degree_arrive():
    summary = walked("line", segments=10, **HALF_DEGREE)
    goal = summary["error"]["goal"]["position"]
    assert goal < 0.005 * summary["path_length"]  # 0.0034 measured
    assert summary["bounces"] == 0


def test_stiff_servos_at_fifty_commands_a_second_are_refused():
    with pytest.raises(UsageError, match="raise command_rate to"):
        walked("line", command_rate=50.0)


@pytest.fixture(scope="module")
def classroom(tmp_path_factory):
    """Run folder of `line` as shipped, on the robot's own servos."""
    folder = tmp_path_factory.mktemp("classroom") / "run"
    folder.mkdir()
    scenario = load_scenario("line", {"robot": "hexapod-classroom"})
    return folder, run(scenario, RunFolder(folder), without=NOT_TOLD)


def test_the_classroom_robot_arrives_without_a_bounce(classroom):
    _, summary = classroom
    assert summary["segments"] == 40
    goal = summary["error"]["goal"]["position"]
    assert goal < 0.01 * summary["path_length"]  # 0.0010 measured
    assert summary["bounces"] == 0
    assert summary["achieved"]["min_margin"] > 0.03  # 0.042 measured


def test_its_header_of_counts_leads_where_the_walk_led(classroom, tmp_path, capsys):
    folder, summary = classroom
    words = ["export", str(folder), "--format", "header", "--json"]
    assert main([*words, "--out", str(tmp_path / "line.h")]) == 0
    played = json.loads(capsys.readouterr().out)["exported"]
    goal = played["error"]["goal"]["position"]
    assert goal == pytest.approx(summary["error"]["goal"]["position"], abs=1e-6)
    assert played["bounces"] == 0
    assert played["min_margin"] > 0.03


@pytest.mark.parametrize("draw", [0, 1])
def test_a_hobby_robot_that_replans_arrives_within_a_hundredth_of_its_path(draw):
    summary = walked("line", imperfect="hobby", draw=draw, replan=True)
    goal = summary["error"]["goal"]["position"]
    assert goal < 0.01 * summary["path_length"]  # 0.0007 and 0.0003 measured
