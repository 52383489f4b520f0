"""TOML that Python would choke on is refused with one kind of error."""

import pytest

from models.description.table import DEEPEST_NESTING, parse_toml


def nested(depth):
    return f"a = {'[' * depth}1{']' * depth}"


def test_values_may_be_nested_so_deep_and_no_deeper():
    assert parse_toml(nested(DEEPEST_NESTING - 1))["a"]
    for depth in (DEEPEST_NESTING, 300, 5000):
        with pytest.raises(ValueError, match=f"nested deeper than {DEEPEST_NESTING}"):
            parse_toml(nested(depth))


@pytest.mark.parametrize("digits", [str(2**63), "-" + "9" * 30, "1" * 5000])
def test_whole_numbers_have_64_bits(digits):
    assert parse_toml(f"a = {2**63 - 1}") == {"a": 2**63 - 1}
    with pytest.raises(ValueError, match="more than 64 bits"):
        parse_toml(f"a = [{digits}]")
