"""Steps of plans: where segments begin and end, and aims that are extrapolated."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from planner import ConvergenceError, Flow
from planner.planning import grid
from sim.planning import bounds, open_loop
from sim.planning.open_loop import (
    _extrapolated,
    _path,
    joined_plans,
    plan_along,
    segment_ends,
    segment_target,
    split,
    unaimed,
)
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario


@pytest.fixture(scope="module")
def setup():
    return prepare(
        load_scenario("line", {"path.goal": [0.02, 0.01, 0.3], "segments": 4})
    )


def test_a_configuration_is_a_pose_and_an_angle_of_each_group(setup):
    pose, swing = split(setup, np.arange(7.0))
    assert pose.tolist() == [0.0, 1.0, 2.0]
    assert swing == (3.0, 4.0)
    state = setup.state(np.array([1.0, 2.0, 3.0]), (0.1, 0.2))
    assert state.tolist() == [1.0, 2.0, 3.0, 0.1, 0.2, 0.0, 0.0]
    assert setup.state(np.ones(3)).tolist() == [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("segment", range(4))
def test_a_segment_ends_on_the_path_where_the_next_one_begins(setup, segment):
    found = segment_target(setup, segment)
    assert found == pytest.approx(np.array([0.02, 0.01, 0.3]) * (segment + 1) / 4)


def test_plans_of_segments_are_joined_to_one(setup):
    one, two = (
        replace(setup, scenario=replace(setup.scenario, segments=n)) for n in (1, 2)
    )
    whole = plan_along(one, setup.nominal())
    joined = joined_plans(two, [whole, whole])
    count = len(whole.flows)
    assert joined.flows == whole.flows * 2
    assert joined.segment_ends == (count, 2 * count)
    assert len(joined.inputs) == 2 * len(whole.inputs)
    assert len(joined.hall_coordinates) == 2 * len(whole.hall_coordinates)
    assert joined.nominal == pytest.approx(setup.nominal().at(grid(setup.nominal(), 2)))


def test_aims_whose_errors_shrink_evenly_are_extrapolated_to_where_they_end():
    """Of a linear map of two unknowns three trials tell the fixed point."""
    rng = np.random.default_rng(0)
    factor, end = np.array([[0.5, 0.2], [0.1, 0.3]]), rng.normal(size=2)
    tried, found = [], []
    now = np.zeros(2)
    for _ in range(3):
        after = end + factor @ (now - end)
        tried.append(now.reshape(1, 2))
        found.append(after.reshape(1, 2))
        now = after
    assert _extrapolated(tried, found) == pytest.approx(end.reshape(1, 2))


def test_a_path_leads_straight_from_aim_to_aim_in_equal_shares(setup):
    aims = np.array([[0.1, 0.0, np.pi / 2], [0.1, 0.0, 0.0]])
    path = _path(setup, np.array([1.0, 0.0, 0.0]), aims)
    assert path(0.0)[:3] == pytest.approx([1.0, 0.0, 0.0])
    assert path(0.5)[:3] == pytest.approx([1.1, 0.0, np.pi / 2])
    assert path(0.25)[:3] == pytest.approx([1.05, 0.0, np.pi / 4])
    assert path(1.0)[:3] == pytest.approx([1.1, 0.1, np.pi / 2])
    assert path.corners == (0.5,)


def test_ends_of_segments_are_those_of_their_strokes(setup):
    """By twists of one metre a radian of the first group on its stratum."""
    planned = plan_along(setup, setup.nominal())

    def twists(stratum, swing, rates):
        ahead = rates[:, 0] if stratum == "1" else 0 * rates[:, 0]
        return np.stack([ahead, 0 * ahead, 0 * ahead], axis=1)

    ends = segment_ends(setup, planned, twists)
    begin, best = 0, [0.0]
    for stop in planned.segment_ends:
        strokes = [f.duration * setup.equations.swings[f.field][0]
                   for f in planned.flows[begin:stop] if f.stratum == "1"]  # fmt: skip
        best.append(best[-1] + sum(strokes))
        begin = stop
    assert ends[:, 0] == pytest.approx(best, abs=1e-9)
    assert ends[:, 1:] == pytest.approx(np.zeros((5, 2)))


def test_what_cannot_be_aimed_is_told_with_its_miss_and_twice_the_segments(setup):
    error = unaimed(setup, "segment 2 of 4", 0.0123456)
    assert isinstance(error, ConvergenceError)
    assert str(error) == (
        "segment 2 of 4 still misses its end by 12.3 mm or mrad, steered by the ideal "
        "prediction; give --segments 8, or another --steer"
    )


def test_where_the_plan_keeps_the_range_its_closest_segment_is_divided(monkeypatch):
    """Only the steered plan leaves it then; the range is -0.5 to 0.4 rad."""
    angles = np.array([0.0, 0.1, 0.3, 0.2, -0.3])  # two flows in each of two segments
    shape = SimpleNamespace(
        names=["x", "a"], trajectory=lambda i, flows, start: i * angles
    )
    planned = SimpleNamespace(segment_ends=(2, 4), flows=range(4))
    monkeypatch.setattr(bounds.planner, "plan", lambda *_, **__: planned)
    setup = SimpleNamespace(
        equations=SimpleNamespace(static_stability=True, limits={"a": (-0.5, 0.4)}),
        scenario=SimpleNamespace(segments=2),
        extended=SimpleNamespace(shape=shape),
        stance="stepped",
        nominal=lambda: None,
    )
    slack = bounds._reach(setup)
    assert slack.walking == pytest.approx([-1e-9, 0.2], rel=1e-6)
    assert slack.standing == pytest.approx([0.4, 0.4])


@dataclass(frozen=True)
class Trial:
    """As much of a step and its plan as is looked at."""

    plan: object = None
    fraction: float = 1.0
    flows: tuple = ()
    segment_ends: tuple = ()


@pytest.mark.parametrize(("miss", "fine"), [(0.019, True), (0.021, False)])
def test_the_closest_attempt_is_taken_if_it_misses_by_a_tenth_of_the_segment(
    setup, monkeypatch, miss, fine
):
    """Of 0.2 m; every attempt misses alike, and the first one least."""
    tried = []

    def plan_step(extended, here, there, execution):
        tried.append(Trial(plan=len(tried)))
        return tried[-1]

    def segment_ends(setup, planned, twists, swing):
        return [np.array([0.2 + miss * (1 + planned), 0.0, 0.0])]

    monkeypatch.setattr(open_loop, "plan_step", plan_step)
    monkeypatch.setattr(open_loop, "segment_ends", segment_ends)
    given = setup, None, 2, np.array([0.2, 0.0, 0.0]), np.zeros(3), (0.0, 0.0)
    if fine:
        assert open_loop.steer_towards(*given) is tried[0]
    else:
        with pytest.raises(ConvergenceError, match="segment 3 of 4 still misses .* 21"):
            open_loop.steer_towards(*given)
    assert len(tried) == 12


def test_strokes_end_on_counts_however_fast_their_field_turns_the_group(monkeypatch):
    """One turns its group by -0.5 rad a unit; strokes to nowhere are left out."""
    setup = SimpleNamespace(
        servo=SimpleNamespace(resolution=0.1),
        equations=SimpleNamespace(swings={"f": (0.0, -0.5), "g": (1.0, 0.0)}),
    )
    nearest = lambda setup, group, angle: 0.1 * round(angle / 0.1)  # noqa: E731
    monkeypatch.setattr(open_loop, "_count", nearest)
    flows = Flow("1", "f", 0.55), Flow("2", "g", 0.02), Flow("1", "f", -1.15)
    step = open_loop._step_on_counts(setup, Trial(plan=Trial(flows=flows)), (0.0, 0.1))
    kept = step.plan
    assert [flow.field for flow in kept.flows] == ["f", "f"]
    ends = 0.1 + np.cumsum([-0.5 * flow.duration for flow in kept.flows])
    assert ends == pytest.approx([-0.2, 0.4])
    assert kept.segment_ends == (2,)
