"""The pace that a sweep's bar shows."""

from sim.sweeps.progress import Pace


def test_the_pace_counts_from_the_first_point_that_is_finished_now():
    moments = iter([0.0, 60.0, 61.0, 65.0])  # a minute until workers are there
    pace = Pace(clock=lambda: next(moments))
    assert [pace(done) for done in (7, 8, 10, 18)] == [0.0, 0.0, 2.0, 2.0]
