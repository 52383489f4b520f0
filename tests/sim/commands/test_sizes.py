"""Numbers of options that no robot has are taken for mistakes."""

import argparse

import pytest

from sim.commands.declared import real, whole


@pytest.mark.parametrize(
    ("text", "taken"), [("1e-6", True), ("0.9e-6", False), ("1e9", True),
                        ("1.1e9", False), ("0", False), ("-1", False)],
)  # fmt: skip
def test_numbers_are_from_a_millionth_to_a_billion(text, taken):
    if taken:
        assert real(text, "a length", 0.1) == float(text)
    else:
        with pytest.raises(argparse.ArgumentTypeError, match="is not a length; give"):
            real(text, "a length", 0.1)
    if text == "0":
        assert real(text, "a length", 0.1, zero=True) == 0.0


def test_whole_numbers_are_counted_from_zero():
    assert whole("0") == 0
    with pytest.raises(argparse.ArgumentTypeError, match="0 or more"):
        whole("-1")
