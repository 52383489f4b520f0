"""Kinds of values: what each takes at its borders, and how it is told in words."""

from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
import pytest

from sim.errors import UsageError
from sim.scenarios.declaration import (
    Range,
    Setting,
    Text,
    accept,
    is_list,
    is_number,
    options,
    read,
    require_keys,
    require_kind,
    setting,
    words,
)

SHARE = Annotated[float, Range(0.0, 1.5)]
COUNT = Annotated[int, Range(1, 9)]
NAME = Annotated[str, Text(file_name=True)]
EMPTY = Annotated[str, Text(empty=True)]


@pytest.mark.parametrize(
    ("value", "kind", "found"),
    [
        (0.0, SHARE, 0.0), (1.5, SHARE, 1.5), (1, SHARE, 1.0),
        (np.float64(0.5), SHARE, 0.5),
        (1, COUNT, 1), (9, COUNT, 9), (9.0, COUNT, 9),
        (True, bool, True), (False, bool, False), (None, SHARE | None, None),
        ("a", str, "a"), ("", EMPTY, ""), ("walk-2", NAME, "walk-2"),
        ("quasi-static", Literal["ideal", "quasi_static"], "quasi_static"),
        ("quasi_static", Literal["ideal", "quasi-static"], "quasi-static"),
        ([0.1, 1], tuple[SHARE, SHARE], (0.1, 1.0)),
        ((0.1, 0.2, 0.3), tuple[SHARE, ...], (0.1, 0.2, 0.3)),
        ({"b": 2, "a": 1.5}, Mapping[str, float], {"a": 1.5, "b": 2.0}),
        ("own", SHARE | Literal["own"], "own"), (0.5, SHARE | Literal["own"], 0.5),
        (["a", "b"], tuple[str, ...], ("a", "b")),
    ],
)  # fmt: skip
def test_values_of_a_kind_are_read(value, kind, found):
    read_ = read(value, kind)
    assert read_ == found
    assert type(read_) is type(found)


@pytest.mark.parametrize(
    ("value", "kind"),
    [
        (-1e-9, SHARE), (1.5000001, SHARE), (float("nan"), SHARE), (True, SHARE),
        ("1", SHARE),
        (0, COUNT), (10, COUNT), (1.5, COUNT), (False, COUNT),
        (1, bool), (0, bool), (None, SHARE), ("", str), (3, str), (3, EMPTY),
        ("a/b", NAME), (".a", NAME), ("-a", NAME), ("", NAME), ("a\nb", NAME),
        ("other", Literal["ideal"]), (1, Literal["ideal"]),
        ([], tuple[SHARE, ...]), ([0.1], tuple[SHARE, SHARE]), ("ab", tuple[str, ...]),
        ([0.1, 2.0], tuple[SHARE, SHARE]), (0.1, tuple[SHARE, ...]),
        ({"a": "x"}, Mapping[str, float]), ({"a": float("inf")}, Mapping[str, float]),
        ({"a": True}, Mapping[str, float]), ([1], Mapping[str, float]),
        (2.0, SHARE | Literal["own"]),
    ],
)  # fmt: skip
def test_other_values_are_none_of_a_kind(value, kind):
    with pytest.raises(UsageError, match="is not allowed: here; give another"):
        accept(value, kind, "another", "here")


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (SHARE, "a number from 0 to 1.5"),
        (COUNT, "a whole number from 1 to 9"),
        (SHARE | None, "a number from 0 to 1.5"),
        (SHARE | Literal["own"], "a number from 0 to 1.5, or own"),
        (Literal["a"], "a"),
        (Literal["a", "b", "c"], "a, b or c"),
        (tuple[str, ...], "a list of names in quotation marks"),
        (tuple[Literal["a", "b"], ...], "a list of a or b"),
        (tuple[SHARE, SHARE], "a list of 2 numbers: from 0 to 1.5, from 0 to 1.5"),
        (tuple[SHARE, ...], "a list of numbers from 0 to 1.5"),
        (NAME, "text in quotation marks, without slashes and a first dash or dot"),
        (EMPTY, "text in quotation marks"),
        (str, "text in quotation marks"),
        (Mapping[str, float], "numbers by name, { NAME = 0.5 }"),
        (bool, "true or false"),
    ],
)
def test_a_kind_is_told_in_words(kind, said):
    assert words(kind) == said


def declared(kind, meaning="how far; more or less", unit="m"):
    return Setting("x", kind, None, meaning, unit, frozenset(), False, "")


def test_what_a_setting_is_about_has_its_unit_before_a_remark():
    assert declared(SHARE).about == "how far [m]; more or less"
    assert declared(SHARE, "how far").about == "how far [m]"
    assert declared(SHARE, unit="").about == "how far; more or less"
    assert declared(SHARE).allowed == "a number from 0 to 1.5 [m]"
    assert declared(SHARE, unit="").allowed == "a number from 0 to 1.5"


def test_a_setting_includes_the_types_of_its_union():
    mixed = declared(SHARE | Literal["own"] | None)
    assert mixed.includes(float)
    assert mixed.includes(Literal)
    assert mixed.includes(type(None))
    assert not mixed.includes(bool)
    assert declared(tuple[SHARE, ...]).includes(tuple)
    assert options(SHARE) == (SHARE,)
    assert len(options(SHARE | None)) == 2


def test_a_declared_field_is_no_imperfection_unless_that_is_said():
    plain = setting("what", 1.0, "plan").metadata
    assert (plain["imperfection"], plain["unit"], plain["formerly"]) == (False, "", "")
    assert plain["affects"] == {"plan"}
    other = setting("what", 1.0, ("plan", "film"), "m", imperfection=True).metadata
    assert other["imperfection"] is True
    assert other["affects"] == {"plan", "film"}


def test_refusals_have_key_value_place_and_what_is_wanted():
    with pytest.raises(UsageError) as caught:
        accept(7.0, SHARE, "a number", "here", "friction")
    assert str(caught.value) == "friction = 7.0 is not allowed: here; give a number"
    with pytest.raises(UsageError, match="^7.0 is not allowed: here"):
        accept(7.0, SHARE, "a number", "here")
    assert accept(1, SHARE, "a number", "here") == 1.0


def test_booleans_are_no_numbers_and_texts_are_no_lists():
    assert [is_number(v) for v in (1, 1.5, True, "1", None)] == [
        True,
        True,
        False,
        False,
        False,
    ]
    assert [is_list(v) for v in ([1], (1,), "ab", 3)] == [True, True, False, False]


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"kind": "wall"}, ""),
        ({"kind": "wal"}, "unknown kind 'wal': here; did you mean 'wall'"),
        ({}, "a table whose kind is one of wall, pole"),
        ({"kind": 3}, "a table whose kind is one of wall, pole"),
        ([], "a table whose kind is one of wall, pole"),
    ],
)
def test_a_table_has_a_kind_that_is_known(table, said):
    kinds = ("wall", "pole")
    if said:
        with pytest.raises(UsageError, match=said):
            require_kind(table, "here", kinds)
    else:
        assert require_kind(table, "here", kinds) is table


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"kind": "k", "goal": 1}, ""),
        ({"goal": 1, "more": 2}, ""),
        ({"more": 2}, "goal is missing: here; give goal = \\[1, 2\\]"),
        ({"goal": 1, "mroe": 2}, "unknown key 'mroe': here; did you mean 'more'"),
    ],
)
def test_a_table_has_the_keys_that_it_needs_and_no_unknown_ones(table, said):
    if said:
        with pytest.raises(UsageError, match=said):
            require_keys(table, "here", ["goal = [1, 2]"], ["more"])
    else:
        require_keys(table, "here", ["goal = [1, 2]"], ["more"])


@pytest.mark.parametrize("value", [-0.0, np.float64(-0.0), 0])
def test_zero_has_no_sign(value):
    assert repr(read(value, SHARE)) == "0.0"


def test_a_list_of_which_no_robot_needs_as_much_is_refused_unread():
    kind = tuple[Annotated[float, Range(0.0, 1.0)], ...]
    assert len(read([0.5] * (10**5 - 1), kind)) == 10**5 - 1
    with pytest.raises(UsageError, match="numbers from 0 to 1"):
        accept([0.5] * 10**5, kind, words(kind), "here")
