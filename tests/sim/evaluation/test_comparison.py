"""The comparison on the terminal, from summaries written by hand."""

import copy
import io
import sys

import pytest

from sim.evaluation import quantities
from sim.evaluation.quantities import Quantity, describe as described
from sim.evaluation.summary import Summary
from sim.progress import bar, silent

SUMMARY = {
    "scenario": "line",
    "robot": "hexapod",
    "fields": "lifted",
    "stance": "centred",
    "segments": 40,
    "replan": False,
    "steer": "ideal",
    "goal": [0.1, 0.2, 0.0],
    "path_length": 0.2,
    "distance_walked": 1.8,
    "contact_switches": 326,
    "contact_switches_achieved": 324,
    "bounces": 3,
    "saturated_segments": 0,
    "simulated_time": 100.0,
    "predicted": {
        "ideal": {"pose": [0.1, 0.19, 0.0], "min_margin": 0.05, "slip": 0.25},
        "quasi_static": None,
    },
    "achieved": {
        "pose": [0.1, 0.198, -1e-9],
        "min_margin": 0.04,
        "slip": 0.3,
        "slip_swing": 0.2,
        "slip_transition": 0.1,
        "slip_per_foot": {"1": 0.3},
        "creep_floor": None,
    },
    "swing_travel": 5.0,
    "air_travel": 3.0,
    "walk_starts": 0.5,
    "timestep": 0.001,
    "error": {
        "goal": {"position": 0.002, "yaw": 0.0},
        "ideal": {"position": 0.008, "yaw": 0.1},
        "quasi_static": None,
    },
    "timing": {"simulate": 5.0},
}


@pytest.fixture
def summary():
    return copy.deepcopy(SUMMARY)


def describe(table):
    """The text of a summary, as it is read from a file."""
    return described(Summary.read(table))


def row(summary, name):
    (line,) = (ln for ln in describe(summary).splitlines() if ln.startswith(f"{name} "))
    return line.removeprefix(name).split()


def test_goal_is_compared_in_millimetres_and_per_cent_of_the_path(summary):
    assert row(summary, "goal")[3:] == ["2.00", "mm", "1.00%", "0.0000", "rad"]


def test_prediction_shows_its_end_its_error_its_margin_and_its_slip(summary):
    assert " ".join(row(summary, "ideal")) == (
        "0.1000 0.1900 0.0000 8.00 mm 4.00% 0.1000 rad 50.0 mm 250.0 mm"
    )


def test_achieved_pose_is_compared_with_nothing_and_has_no_negative_zero(summary):
    assert " ".join(row(summary, "achieved")) == "0.1000 0.1980 0.0000 40.0 mm 300.0 mm"


def test_prediction_that_was_not_made_has_no_row(summary):
    assert "quasi-static" not in describe(summary)
    for part in ("predicted", "error"):
        summary[part]["quasi_static"] = SUMMARY[part]["ideal"]
    assert row(summary, "quasi-static") == row(summary, "ideal")


def test_path_of_no_length_has_no_per_cent(summary):
    summary["path_length"] = 0.0
    assert row(summary, "goal")[3:] == ["2.00", "mm", "0.0000", "rad"]


def test_saturated_segments_are_told_when_there_are_any(summary):
    assert "saturated" not in describe(summary)
    summary["saturated_segments"] = 7
    assert row(summary, "saturated")[0] == "7"


def test_one_of_a_kind_is_not_told_as_several(summary):
    summary |= {"bounces": 1, "saturated_segments": 1, "self_contacts": 1}
    said = describe(summary)
    assert "1 bounce," in said
    assert "1 segment scaled" in said
    assert "each other 1 time," in said


def test_lines_fit_a_terminal_of_a_hundred_columns(summary):
    summary["achieved"]["slip"] = 99.0
    for stance in ("centred", "paper"):
        summary["stance"] = stance
        assert max(map(len, describe(summary).splitlines())) <= 100


def test_an_optimised_plan_is_not_said_to_be_one_of_the_ideal_fields(summary):
    assert "planned on the ideal prediction\n" in describe(summary)
    summary["optimise"] = "time"
    said = describe(summary)
    assert "steered by the quasi-static prediction, optimised for time\n" in said
    assert "as the optimised plan says" in said
    summary["fallback"] = "no shorter plan was found"
    assert "planned on the ideal prediction" in describe(summary)


def test_slip_of_lift_offs_is_told_of_planned_walks_alone(summary):
    assert "\nswitch slip " in describe(summary)
    summary["goal"] = None
    assert "\nswitch slip " not in describe(summary)


class Terminal(io.StringIO):
    """A standard error that says it is a terminal."""

    def isatty(self):
        """What a terminal answers."""
        return True


@pytest.mark.parametrize(
    ("stream", "term", "shown"),
    [
        (io.StringIO(), "xterm", False),
        (Terminal(), "xterm", True),
        (Terminal(), "dumb", False),  # it cannot draw over what it has drawn
    ],
    ids=["pipe", "terminal", "dumb terminal"],
)
def test_bar_is_for_terminals_alone(monkeypatch, stream, term, shown):
    monkeypatch.setenv("TERM", term)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setattr(sys, "stderr", stream)
    with bar() as progress:
        progress("walking", 0.5)
    assert ("walking" in stream.getvalue()) == shown


def test_bar_can_be_kept_quiet(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with bar(quiet=True) as progress:
        assert progress is silent


def test_a_quantity_of_the_walk_that_asks_for_it_has_a_line(summary, monkeypatch):
    travel = Quantity("swing_travel", "strokes", "mrad", 1, line=True)
    silent_one = Quantity("air_travel", "in the air", "mrad", 1)
    monkeypatch.setattr(quantities, "OF_WALKS", (travel, silent_one))
    lines = describe(summary).splitlines()
    assert "strokes      5000.0 mrad" in lines
    assert not any(line.startswith("in the air") for line in lines)
