"""Robots as their owners write them, adopted and walked without any correction."""

import pytest

from models.adoption.draft import draft_card
from models.adoption.source import source_of
from sim.scenarios.file import load_scenario
from tests.owners import OWNED
from tests.walks import simulated

pytestmark = [pytest.mark.physics, pytest.mark.full]
PATH = {"path.goal": [0.03, 0.03, 0.0], "segments": 6}


@pytest.mark.parametrize("write", OWNED, ids=lambda write: write.__name__)
def test_an_owner_s_robot_walks_as_adopted(write, tmp_path):
    source = source_of(str(write(tmp_path)))
    if source.text is not None:
        source.path.write_text(source.text)
    source.path.with_suffix(".toml").write_text(draft_card(source).card)
    robot = {"robot": str(source.path)}
    summary = simulated(load_scenario("line", robot | PATH)).summary
    # 0 bounces and 0.10 to 0.30 % measured; the turntable's front and rear left feet
    # leave the floor again 8 times, for 1 ms each, as they touch down: 0.24 %
    most = 12 if write.__name__ == "turntable" else 2
    assert summary["bounces"] <= most
    assert summary["error"]["quasi_static"]["position_per_path"] < 0.01
    assert summary["verdict"] in ("arrived", "slipped")
