"""Examples share what their walks build and measure, as the points of a sweep do."""

import numpy as np
import pytest

from sim.evaluation import motions
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
    compute = motions.foreseen

    def foreseen(told, legs, rows, times, contact):
        """The compliant prediction, once for each world and what is commanded there."""
        rows = np.concatenate(list(rows))
        given = (*(leg.pose for leg in legs), rows, times, contact)
        key = (told.world.text, *(np.asarray(part).tobytes() for part in given))
        anew = lambda: compute(told, legs, [rows], times, contact)  # noqa: E731
        return built.cached("compliant", key, anew)

    monkeypatch.setattr(motions, "foreseen", foreseen)
