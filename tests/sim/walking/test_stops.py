"""Where a walk stands still, and which part of it is carried out."""

from types import SimpleNamespace

import pytest

from sim.walking import walks


def gone(monkeypatch, segments, *given):
    """Times that are stood still [s], the first segment and the part of the walk."""
    held, played = [], []
    scheduler = SimpleNamespace(segment=None, hold=held.append, finish=lambda: "it")
    walk = SimpleNamespace(
        setup=SimpleNamespace(
            scenario=SimpleNamespace(segments=4), limits=SimpleNamespace(hold=0.5)
        ),
        _scheduler=lambda: scheduler,
        _play=lambda schedule, share: played.append(share),
    )
    monkeypatch.setattr(walks, "schedule_flows", lambda *_: None)
    walks.Walker.go(walk, [()] * segments, *given)
    return held, scheduler.segment, *played


@pytest.mark.parametrize(
    ("segments", "given", "found"),
    [
        (4, (), ([0.5], 0, (0.0, 1.0))),  # still once at the end
        (1, (), ([], 0, (0.0, 0.25))),
        (1, (2, 0.3), ([0.3], 2, (0.5, 0.75))),
        (1, (3, 0.3), ([0.3, 0.5], 3, (0.75, 1.0))),
    ],
)
def test_a_walk_begins_with_its_first_segment_and_stops_where_that_is_said(
    segments, given, found, monkeypatch
):
    assert gone(monkeypatch, segments, *given) == found
