"""Names of elements: fields, brackets and generators' numbers."""

import pytest

from planner.systems.elements import leaves, parse
from tests.systems import hexapod


def test_numbers_count_all_fields_in_order_of_declaration():
    assert str(parse("[1,[3,6]]", hexapod())) == "[g12_1,[g1_1,g2_2]]"


def test_names_and_numbers_may_be_mixed_and_spaced():
    assert str(parse(" [ g12_1 , 2 ]", hexapod())) == "[g12_1,g12_2]"


def test_leaves_count_the_degree():
    assert leaves(parse("[1,[1,2]]", hexapod())) == ("g12_1", "g12_1", "g12_2")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("g12_3", r"field g12_3 is unknown; did you mean 'g12_"),
        ("7", "generators are numbered 1 to 6"),
        ("0", "generators are numbered 1 to 6"),
        ("", "neither a field nor a bracket"),
        ("[1;2]", "neither a field nor a bracket"),
        ("[1,]", "neither a field nor a bracket"),
        ("[1,2", r"lacks a '\]'"),
        ("[1 2]", "lacks a ','"),
        ("1 2", "goes on after its end"),
        ("[" * 999 + "1", "element has more than 20 brackets; use fewer"),
    ],
)
def test_texts_that_are_no_elements_are_refused(text, message):
    with pytest.raises(ValueError, match=message):
        parse(text, hexapod())
