"""Summaries of older versions, which wrote fewer numbers, say what these did."""

from sim.evaluation.summary import Summary
from tests.sim.evaluation.test_comparison import SUMMARY


def test_what_an_older_version_did_not_write_is_what_it_did():
    """It walked once, optimised nothing, and neither counted nor measured the rest."""
    found = Summary.read(SUMMARY)
    assert (found.verdict, found.verdict_text) == ("not judged", "not judged")
    assert (found.optimise, found.together, found.correct) == ("none", False, 1)
    counted = found.wall_contacts, found.self_contacts, found.let_down
    assert counted == (0, 0, 0.0)
    assert (found.fastest_swing, found.swing_speed) == (0.0, 0.0)
    assert (found.weighed, found.feedback, found.measured) == (None, None, None)
    assert (found.fallback, found.least_time, found.error_sources) == (None, None, None)
    assert (found.missed, dict(found.deviation), dict(found.unpredicted)) == (
        [],
        {},
        {},
    )
    per_metre = found.per_metre
    assert (per_metre.seconds, per_metre.strokes) == (None, None)
    assert found.predicted["ideal"].ignores == ""
    assert found.predicted["ideal"].slip_swing is None
    assert found.achieved.min_clearance is None


def test_poses_are_those_of_goal_predictions_and_physics():
    found = Summary.read(SUMMARY)
    assert [*found.poses] == ["goal", "ideal", "achieved"]
    table = found.to_json()
    assert "measured" not in table
    assert table["goal"] == [0.1, 0.2, 0.0]
    played = Summary.read({**SUMMARY, "goal": None})
    assert [*played.poses] == ["ideal", "achieved"]
    assert not {"goal", "missed"} & played.to_json().keys()
    seen = Summary.read({**SUMMARY, "measured": {"pose": [0.1, 0.2, 0.3]}})
    assert seen.poses["measured"] == [0.1, 0.2, 0.3]
