"""Examples share what their walks build and measure, as the points of a sweep do."""

import pytest

from sim.evaluation.assessment import evaluate
from sim.preparation.setup import prepare
from sim.preparation.shared import Shared
from sim.simulation import simulate


@pytest.fixture(scope="session")
def built():
    return Shared()


@pytest.fixture(autouse=True)
def shared(built, monkeypatch):
    """A test of sharing shows that walks have the numbers of those that do not.

    Tests elsewhere write robots anew under names that they had before, and share none.
    """
    monkeypatch.setattr(prepare, "__defaults__", (None, built, None))
    without, _, progress = evaluate.__defaults__
    monkeypatch.setattr(evaluate, "__defaults__", (without, built, progress))
    own = simulate.__kwdefaults__ | {"shared": built}
    monkeypatch.setattr(simulate, "__kwdefaults__", own)
