"""Messages on unknown names lead to the known ones."""

import pytest

from planner.errors import SETUP, did_you_mean, installing, unknown


@pytest.mark.parametrize(
    ("name", "known", "remedy"),
    [
        ("lien", ["line", "ellipse"], "did you mean 'line'? there are line, ellipse"),
        ("zigzag", ["line", "ellipse"], "there are line, ellipse"),
        ("line", [], "there are none"),
        ("b", iter(["a", "b"]), "did you mean 'b'? there are a, b"),
    ],
)
def test_remedy_names_the_nearest_if_it_is_near_and_all_of_them(name, known, remedy):
    assert did_you_mean(name, known) == remedy


def test_unknown_names_are_called_so_with_the_remedy():
    message = "is unknown; did you mean 'line'? there is only line"
    assert unknown("lien", ["line"]) == message


@pytest.mark.parametrize(("count", "listed"), [(1, True), (40, True), (41, False)])
def test_many_names_are_listed_only_where_none_is_near(count, listed):
    known = ["line", *(f"{k:04d}" for k in range(count - 1))]
    remedy = did_you_mean("lien", known)
    assert remedy.startswith("did you mean 'line'?")
    assert (known[-1] in remedy.partition("?")[2]) == listed
    assert did_you_mean("zigzag", known).endswith(", ".join(known))
    assert did_you_mean("rate", ["command_rate", "x"]).startswith(
        "did you mean 'command_rate'?"
    )


def test_a_checkout_installs_extras_by_its_own_script():
    """Which is there, and which the message names by its path."""
    assert SETUP.is_file()
    assert installing("sweep") == f"{SETUP} installs all extras"
