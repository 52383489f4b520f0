"""A scenario's gait is one of the robot, or refused in words."""

import json

import numpy as np
import pytest

from sim.cli import main
from sim.errors import UsageError
from sim.evaluation.assessment import summarise
from sim.preparation.setup import prepare
from sim.preparation.shared import Shared
from sim.scenarios.file import dumps, load_scenario
from tests.walks import simulated

TRIPODS = ["12", "1", "12", "2", "12"]
CRAWL = ["1234", "123", "1234", "124", "1234", "134", "1234", "234", "1234"]


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        (
            {"gait": ["12", "7", "12"]},
            "'7' .* is unknown: gait = .*; there are 12, 1, 2",
        ),
        ({"gait": ["12", "1", "2", "12"]}, "S1.*S2"),
        (
            {"gait": ["12", "1"]},
            r"S12 -> S1 does not close.*\['12', '1'\]; end it in S12",
        ),
        ({"gait": ["12", "1", "12"]}, "hexapod cannot walk without S2"),
        ({"gait": ["1", "12", "2", "12", "1"]}, "starts on S1, .* begin with S12"),
        ({"gait": []}, "gait"),
        ({"gait": "12"}, "gait"),
        ({"gait": [12, 1, 12]}, "gait"),
        ({"gait": TRIPODS, "optimise": "time"}, "optimise = time chooses the order"),
        (
            {"robot": "quadruped", "gait": CRAWL},
            "quadruped lifts its legs in the order in which it stands safely",
        ),
    ],
)
def test_a_gait_that_the_robot_cannot_follow_is_refused(changes, what):
    with pytest.raises(UsageError, match=what):
        prepare(load_scenario("line", {"segments": 2} | changes))


def test_a_gait_is_refused_whatever_was_prepared_before(hexapod):
    shared, plain = Shared(), {"segments": 2, "gait": TRIPODS}
    prepare(load_scenario("line", plain), hexapod, shared)
    with pytest.raises(UsageError, match="chooses the order"):
        prepare(load_scenario("line", plain | {"optimise": "time"}), hexapod, shared)


def test_a_gait_is_written_into_the_scenario_and_read_back():
    scenario = load_scenario("line", {"gait": TRIPODS})
    assert 'gait = ["12", "1", "12", "2", "12"]' in dumps(scenario)
    assert scenario.gait == tuple(TRIPODS)


def test_the_command_plans_in_the_order_of_a_gait(capsys):
    def facts(*gait):
        words = "plan", "line", "--segments", "4", "--json"
        assert main([*words, *(("--gait", *gait) if gait else ())]) == 0
        return json.loads(capsys.readouterr().out)

    plain, slow = facts(), facts("12", "1", "12", "1", "12", "2", "12")
    assert slow["contact_switches"] > plain["contact_switches"]
    assert slow["pose"] == pytest.approx(plain["pose"], abs=1e-9)


@pytest.mark.physics
def test_a_robot_walks_every_stratum_of_its_gait_in_the_physics():
    """Tripod 1 stands twice before tripod 2: more touchdowns, the same way."""
    short = {"path.goal": [0.01, 0.01, 0.0], "segments": 1}
    walks = [
        simulated(load_scenario("line", short | changes)).evaluation
        for changes in ({}, {"gait": ["12", "1", "12", "1", "12", "2", "12"]})
    ]
    plain, slow = (summarise(walk) for walk in walks)
    assert slow["contact_switches"] > plain["contact_switches"]
    assert slow["contact_switches_achieved"] == slow["contact_switches"]
    poses = [walk.achieved.pose[-1] for walk in walks]
    assert poses[0] == pytest.approx(poses[1], abs=3e-4)  # 1e-4 measured
    assert np.isfinite(poses).all()
