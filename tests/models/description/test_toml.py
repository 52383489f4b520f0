"""TOML that Python would choke on is refused with one kind of error."""

from time import process_time

import pytest

from models.description.table import parse_toml

DEEPEST_NESTING = 32  # tables and lists inside each other


def nested(depth):
    return f"a = {'[' * depth}1{']' * depth}"


def test_values_may_be_nested_so_deep_and_no_deeper():
    assert parse_toml(nested(DEEPEST_NESTING - 1))["a"]
    for depth in (DEEPEST_NESTING, 300, 5000):
        with pytest.raises(ValueError, match=f"nested deeper than {DEEPEST_NESTING}"):
            parse_toml(nested(depth))


@pytest.mark.parametrize("part", ["a", '"a.b"', "'a' ", r'"\"" '])
@pytest.mark.parametrize(
    "form", ["{} = 1", "[ {} ]", "[[{}]]", "k = {{b = 1, {} = 1}}"]
)
def test_a_key_has_so_many_parts_and_no_more(part, form):
    """Python reads the longest in 1 s, twice as long ones in four; here 0.1 ms."""
    fits = DEEPEST_NESTING - 2  # in a table, or in a list
    assert parse_toml(form.format(".".join([part] * fits)))
    began = process_time()
    with pytest.raises(ValueError, match=f"nested deeper than {DEEPEST_NESTING}"):
        parse_toml("name = 'x'\n" + form.format(".".join([part] * 10_000)))
    assert process_time() - began < 0.1


def test_a_text_may_have_as_many_dots_as_it_likes():
    text = "a.b." * 1000
    assert parse_toml(f'name = "{text}"  # {text}') == {"name": text}


@pytest.mark.parametrize("digits", [str(2**63), "-" + "9" * 30, "1" * 5000])
def test_whole_numbers_have_64_bits(digits):
    assert parse_toml(f"a = {2**63 - 1}") == {"a": 2**63 - 1}
    with pytest.raises(ValueError, match="more than 64 bits"):
        parse_toml(f"a = [{digits}]")


@pytest.mark.parametrize("part", ["#\n", "0,"], ids=["lines", "items"])
def test_a_text_has_two_million_lines_commas_and_equals_signs_at_most(part):
    """Comments of 10 MB took 6 s, and items 20 s, each time they were read."""
    assert parse_toml("a = [\n" + part * 10**5 + "]\n")
    said = "more than 2,000,000 lines, commas and equals signs"
    with pytest.raises(ValueError, match=said):
        parse_toml("a = [\n" + part * (2 * 10**6 - 2) + "]\n")
