"""The table of quantities: in the summary, in words, and in the documentation."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from sim.evaluation.quantities import QUANTITIES
from sim.evaluation.summary import Accomplished, Departure, Predicted, Summary

DOCUMENTED = Path(__file__).resolve().parents[3] / "docs" / "numbers.md"


def test_the_documentation_names_every_quantity_as_it_is_shown():
    _, _, table = DOCUMENTED.read_text().partition("## The table of quantities")
    rows = re.findall(r"^\| `([^`]+)` \| ([^|]+) \|", table, flags=re.MULTILINE)
    assert rows == [(quantity.key, quantity.title) for quantity in QUANTITIES]


def summary():
    """A summary in which every number has another value."""
    error = Departure(position=0.002, yaw=-1e-4)
    walked = {"slip_swing": 0.2, "slip_transition": 0.1, "slip_per_foot": {}}
    numbers = {"path_length": 0.2, "distance_walked": 1.8, "timestep": 0.001}
    counted = ("contact_switches", "contact_switches_achieved", "bounces")
    return Summary(
        **{item.name: "-" for item in fields(Summary) if item.type == "str"},
        **{name: i for i, name in enumerate((*counted, "segments"))},
        **numbers | {"swing_travel": 5.0, "air_travel": 3.0, "simulated_time": 9.0},
        replan=False,
        goal=[0.1, 0.2, 0.0],
        saturated_segments=0,
        walk_starts=0.5,
        predicted={"ideal": Predicted(pose=[0, 0, 0], min_margin=0.05, slip=0.25)},
        achieved=Accomplished(
            pose=[0, 0, 0], min_margin=0.04, slip=0.3, creep_floor=2e-6, **walked
        ),
        error={"goal": error},
    )


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda one: one.key)
def test_every_quantity_is_in_the_summary(quantity):
    row = "goal" if quantity.key.startswith("error") else "achieved"
    if not quantity.key.endswith("farthest"):  # a goal has no way to be far from
        assert quantity.value(summary(), row) is not None


def test_numbers_are_shown_in_their_unit_with_their_digits():
    by_key = {quantity.key: quantity for quantity in QUANTITIES}
    margin, yaw = by_key["predicted.*.min_margin"], by_key["error.*.yaw"]
    assert margin.title == "least margin [mm]"
    assert margin.cell(summary(), "achieved") == "40.0"
    assert margin.cell(summary(), "ideal", finer=1) == "50.00"
    assert margin.cell(summary(), "identified") == "\N{EN DASH}"
    assert margin.words(0.0401) == "40.1 mm"
    assert yaw.cell(summary(), "goal") == "\N{MINUS SIGN}0.10"


def test_a_summary_is_read_as_it_is_written():
    written = summary().to_json()
    assert Summary.read(written).to_json() == written
    assert Summary.read(written)["error"]["goal"]["position"] == 0.002
    with pytest.raises(KeyError, match="scenario"):
        Summary.read({k: v for k, v in written.items() if k != "scenario"})
