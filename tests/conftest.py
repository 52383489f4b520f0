"""Shared parts: a world built from the shipped hexapod, and a short real walk."""

import pytest

from models.robot import load as load_robot
from sim.nominal import line
from sim.scenario import Scenario


@pytest.fixture(scope="session")
def hexapod():
    return load_robot("hexapod")


@pytest.fixture
def scenario():
    """Make a scenario that differs from a short straight line only in what is given."""

    def make(**changes):
        given = {"name": "short", "segments": 2, "path": line((0.01, 0.01, 0.0))} | changes
        return Scenario(**given)

    return make
