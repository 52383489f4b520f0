"""Figures of the corridor with fewer outlines of the robot, whose union takes long."""

import pytest

from sim.figures import corridor


@pytest.fixture(autouse=True, scope="session")
def fewer_outlines():
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(corridor, "SWEEPS", 100)
        yield
