"""The table of quantities: in the summary, in words, and in the documentation."""

import re
from dataclasses import fields
from pathlib import Path

import pytest

from sim.evaluation.quantities import OF_ROWS, OF_WALKS, POSITION, YAW
from sim.evaluation.summary import (
    Accomplished,
    Departed,
    Departure,
    PerMetre,
    Predicted,
    PredictionError,
    Real,
    Sensed,
    Summary,
    Weighed,
)

QUANTITIES = (POSITION, YAW, *OF_ROWS, *OF_WALKS)
DOCUMENTED = Path(__file__).resolve().parents[3] / "docs" / "numbers.md"


def test_the_documentation_names_every_quantity_as_it_is_shown():
    _, _, table = DOCUMENTED.read_text().partition("## The table of quantities")
    rows = re.findall(r"^\| `([^`]+)` \| ([^|]+) \|", table, flags=re.MULTILINE)
    assert rows == [(quantity.key, quantity.title) for quantity in QUANTITIES]


def test_quantities_that_are_compared_have_as_many_digits():
    digits = {}
    for quantity in QUANTITIES:
        kind, *_ = quantity.key.split(".")
        alike = digits.setdefault((kind, quantity.unit), quantity.digits)
        assert quantity.digits == alike or "." not in quantity.key, quantity.key


SAMPLES = {str: "-", bool: False, list[float]: [0.1, 0.2, 0.0]}
SAMPLES[list[float] | None] = SAMPLES[list[float]]


def filled(kind, **given):
    """One of the types with some value in every field; numbers are those given."""
    values = {item.name: SAMPLES.get(item.type, 0.5) for item in fields(kind)}
    return kind(**values | given)


def summary():
    """A summary in which every number is there."""
    empty = (
        "unpredicted",
        "error_sources",
        "servo",
        "deviation",
        "versions",
        "timing",
    )
    return filled(
        Summary,
        **dict.fromkeys(empty, {}),
        predicted={"ideal": filled(Predicted, min_margin=0.05)},
        achieved=filled(Accomplished, min_margin=0.04, slip_per_foot={}),
        error={
            "goal": Departure(position=0.002, yaw=-1e-4),
            "ideal": filled(PredictionError),
            "measured": filled(PredictionError),
        },
        weighed=filled(Weighed),
        per_metre=PerMetre(),
        feedback=filled(Sensed),
        measured=filled(Real, roll=filled(Departed), pitch=filled(Departed)),
        missed=[0.002],
    )


@pytest.mark.parametrize("quantity", QUANTITIES, ids=lambda one: one.key)
def test_every_quantity_is_in_the_summary(quantity):
    row = "ideal" if "*" in quantity.key else ""
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
