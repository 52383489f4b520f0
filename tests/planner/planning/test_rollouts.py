"""Rollouts: states along flows, dense or not, against closed forms."""

import numpy as np
import pytest

from planner.errors import ConvergenceError
from planner.planning.algorithm import plan
from planner.planning.paths import line
from planner.planning.rollouts import play, rollout
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem
from tests.systems import PAPER, X, hexapod

ROUNDING = 1e-13


def test_rollout_starts_at_the_start_and_has_a_state_a_flow():
    planned = plan(hexapod(), line(np.zeros(5), [0.3, 0.1, 0, 0, 0]), 2, PAPER)
    states = rollout(planned)
    assert states.shape == (1 + len(planned.flows), 5)
    assert states[0].tolist() == [0] * 5


def test_dense_samples_pass_through_the_ends_of_flows():
    planned = plan(hexapod(), line(np.zeros(5), [0.3, 0.1, 0, 0, 0]), 2, PAPER)
    dense = rollout(planned, samples=4)
    assert dense[::4] == pytest.approx(rollout(planned), abs=ROUNDING)


def test_dense_samples_lie_on_the_arc_of_a_tripod():
    states = play(hexapod(), [Flow("1", "g1_1", 2.0)], np.zeros(5), samples=10)
    # the pivot (0, 1) keeps its distance of one
    distances = np.hypot(states[:, 0], states[:, 1] - 1)
    assert distances == pytest.approx(np.ones(11), abs=ROUNDING)


def test_flows_back_and_forth_return():
    flows = [Flow("1", "g1_1", 0.7), Flow("2", "g2_2", -0.4)]
    back = [flow._replace(duration=-flow.duration) for flow in reversed(flows)]
    start = np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    assert play(hexapod(), flows + back, start)[-1] == pytest.approx(
        start, abs=ROUNDING
    )


@pytest.mark.parametrize(
    ("flow", "size", "message"),
    [
        (Flow("1", "g1_9", 1.0), 5, "field g1_9 is unknown; did you mean 'g1_"),
        (Flow("3", "g1_1", 1.0), 5, "flow on stratum '3', which is unknown; there are"),
        (Flow("2", "g1_1", 1.0), 5, "along g1_1 on S2; the field belongs to S1"),
        (Flow("1", "g1_1", np.nan), 5, "duration of flow S1: .nan g1_1 is not b"),
        (Flow("1", "g1_1", -1e100), 5, "duration of flow S1: -1e.100 g1_1 is not b"),
        (
            Flow("1", "g1_1", 1.0),
            4,
            r"start has shape \(4,\); 5 coordinates are needed",
        ),
    ],
)
def test_flow_that_the_system_does_not_have_is_refused(flow, size, message):
    with pytest.raises(ValueError, match=message):
        play(hexapod(), [flow], np.zeros(size))


def test_samples_below_one_are_refused():
    with pytest.raises(ValueError, match="samples is 0; at least 1"):
        play(hexapod(), [], np.zeros(5), samples=0)


def test_flow_that_escapes_is_refused():
    explosion = StratifiedSystem((X,), {"0": {"g": [X**2]}}, "0")
    with pytest.raises(ConvergenceError, match=r"flow for 1 from \(1\)"):
        play(explosion, [Flow("0", "g", 1.0)], np.ones(1))
