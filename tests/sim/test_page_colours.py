"""The interactive page, which is written by hand, has the colours of the reports."""

from pathlib import Path

import pytest

from sim import palette

PAGE = Path(__file__).parents[2] / "docs" / "_static" / "hands-on.html"


@pytest.mark.parametrize(
    "colour",
    [
        palette.GRID,
        palette.TEXT,
        palette.FAINT,
        palette.NOMINAL.colour,
        palette.ACHIEVED.colour,
    ],
    ids=["grid", "text", "faint text", "nominal path", "achieved motion"],
)
def test_what_the_interactive_page_draws_has_the_colour_of_the_reports(colour):
    assert colour.hex.lower() in PAGE.read_text().lower()
