"""Examples share what their walks build and measure, as the points of a sweep do."""

import pytest

from sim.evaluation.assessment import evaluate
from sim.preparation.setup import prepare
from sim.preparation.shared import Shared
from sim.simulation import simulate


@pytest.fixture(autouse=True, scope="session")
def shared():
    """A test of sharing shows that walks have the numbers of those that do not."""
    with pytest.MonkeyPatch.context() as patched:
        cached = Shared()
        patched.setattr(prepare, "__defaults__", (None, cached, None))
        without, _, progress = evaluate.__defaults__
        patched.setattr(evaluate, "__defaults__", (without, cached, progress))
        own = simulate.__kwdefaults__ | {"shared": cached}
        patched.setattr(simulate, "__kwdefaults__", own)
        yield
