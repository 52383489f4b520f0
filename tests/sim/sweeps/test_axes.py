"""Values that a sweep goes through, and what is refused of them."""

import numpy as np
import pytest

from sim.errors import UsageError
from sim.sweeps import file
from sim.sweeps.file import grid_blocks, list_block, sobol_block


def values(table):
    ((_, choices),) = grid_blocks(table)
    return [value for (value,) in choices]


def test_a_range_has_both_its_ends_and_even_steps():
    spread = {"from": 0.2, "to": 1.0, "count": 5}
    assert values({"friction": spread}) == [0.2, 0.4, 0.6, 0.8, 1.0]


def test_a_logarithmic_range_has_even_ratios():
    spread = {"from": 1, "to": 1000, "count": 4, "scale": "log"}
    assert values({"servo_stiffness": spread}) == [1, 10, 100, 1000]


def test_whole_settings_get_whole_numbers():
    given = values({"segments": {"from": 2, "to": 9, "count": 3}})
    assert given == [2, 6, 9]
    assert all(type(value) is int for value in given)


def test_keys_of_inner_tables_have_dotted_names():
    ((keys, choices),) = grid_blocks({"path": {"goal": [[0.1, 0, 0], [0.2, 0, 0]]}})
    assert keys == ("path.goal",)
    assert len(choices) == 2


def test_lists_go_side_by_side():
    keys, choices = list_block({"friction": [0.5, 1.0], "play": [0.0, 0.1]})
    assert keys == ("friction", "play")
    assert list(choices) == [(0.5, 0.0), (1.0, 0.1)]


def test_lists_of_different_lengths_are_refused_with_their_lengths():
    with pytest.raises(UsageError, match="friction has 2, play has 1"):
        list_block({"friction": [0.5, 1.0], "play": [0.0]})


def test_sobol_samples_fill_their_box_evenly_and_come_again():
    table = {"points": 64, "seed": 3, "friction": [0.2, 1.0], "segments": [2, 9]}
    keys, choices = sobol_block(table)
    assert keys == ("friction", "segments")
    assert sobol_block(table) == (keys, choices)
    friction = np.array([choice[0] for choice in choices])
    counts, _ = np.histogram(friction, bins=np.linspace(0.2, 1.0, 17))
    assert (counts == 4).all()  # a net: equal numbers in equal parts
    assert all(type(choice[1]) is int for choice in choices)
    assert sobol_block(table | {"seed": 4}) != (keys, choices)


def test_fewer_sobol_samples_are_the_first_of_more():
    few = sobol_block({"points": 5, "friction": [0, 1]})[1]
    assert list(few) == list(sobol_block({"points": 8, "friction": [0, 1]})[1][:5])


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (0.5, "neither a list nor a range"),
        ([], "neither a list nor a range"),
        ({"from": 0, "to": 1, "cuont": 2}, "neither a list nor a range"),
        ({"from": 0, "to": "x", "count": 2}, "no two ends"),
        ({"from": 0, "to": float("nan"), "count": 2}, "no two ends"),
        ({"from": 0, "to": 1, "count": 0}, "count = 0 is not allowed"),
        ({"from": 0, "to": 1, "count": 2, "scale": "log"}, "scale = 'log' from 0"),
        ({"from": 1, "to": -1, "count": 2, "scale": "log"}, "scale = 'log' from 1"),
        ({"from": 1e-300, "to": 1, "count": 2, "scale": "log"}, "above 1e-100"),
        ({"from": -1e308, "to": 1e308, "count": 2}, "numbers nearer to 0 than 1e.100"),
        ({"from": 10**400, "to": 1, "count": 2}, "no two ends"),
    ],
)
def test_impossible_values_are_refused(given, said):
    with pytest.raises(UsageError, match=said):
        values({"friction": given})


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ({"friction": [0, 1]}, "points = None is not allowed"),
        ({"points": 4}, "no keys are given"),
        ({"points": 4, "friction": [0, 0.5, 1]}, "no two ends"),
        ({"points": 4, "seed": -1, "friction": [0, 1]}, "seed = -1 is not allowed"),
    ],
)
def test_impossible_samples_are_refused(table, said):
    with pytest.raises(UsageError, match=said):
        sobol_block(table)


def test_a_table_without_keys_varies_nothing(tmp_path):
    sweep = tmp_path / "none.toml"
    sweep.write_text('scenario = "line"\n[list.path]\n[grid.path]\n')
    assert len(file.read_sweep(str(sweep))) == 1


@pytest.mark.parametrize(
    ("table", "value"),
    [
        ("grid", "{ from = 0, to = 1, count = 50000 }"),
        ("list", "{ from = 0, to = 1, count = 50000 }"),
        ("sobol", "[0, 1]"),
    ],
)
def test_more_keys_than_there_are_settings_are_refused_before_their_values_are_made(
    tmp_path, table, value, monkeypatch
):
    """Each would be 50,000 values; there are 70 settings."""
    monkeypatch.setattr(file, "_stretch", lambda *_: pytest.fail("values are made"))
    rows = "\n".join(f"k{n} = {value}" for n in range(101))
    sweep = tmp_path / "keys.toml"
    points = "points = 50000\n" * (table == "sobol")
    sweep.write_text(f'scenario = "line"\n[{table}]\n{points}{rows}\n')
    with pytest.raises(
        UsageError, match="^101 keys are given: .*; give from 1 to 100 of"
    ):
        file.read_sweep(str(sweep))


def test_a_sweep_whose_key_has_no_values_is_refused():
    """As a sweep.json may have it that somebody has changed."""
    with pytest.raises(UsageError, match="0 points"):
        file.Sweep("s", {}, {}, ((("friction",), []),), ())
