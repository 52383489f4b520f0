"""Maps of a study: what is written in their squares."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from sim.scenarios.file import parse_override, toml_value
from sim.studies import maps
from sim.studies.results import Results
from sim.sweeps.table import read_table, write_table
from tests.studies import results


def test_a_number_in_a_map_is_within_the_class_whose_colour_it_has():
    """0.1503 % is beyond 0.15 %, so it is not written as 0.15."""
    shares = [0.001, 0.0015, 0.001503, 0.004]
    columns = {
        "point": [*range(4)], "status": ["ok"] * 4, "speed": ["a", "b", "a", "b"],
        "friction": ["c", "c", "d", "d"], "path_length": [1.0] * 4,
        "distance_walked": [1.0] * 4, "error.ideal.farthest": shares,
        "verdict": [None] * 4,
    }  # fmt: skip
    keys = ("speed", "friction")
    results = Results(columns, keys, "ideal", limits=(0.0015, 0.002, 0.003))
    axes = Figure().add_subplot()
    maps._draw_map(axes, results, *keys)
    assert [text.get_text() for text in axes.texts] == [
        "0.10",
        "0.15",
        "0.1503",
        "0.40",
    ]


@pytest.mark.parametrize(("count", "size"), [(30, 260), (100, 90), (1001, 9)])
def test_points_of_a_map_share_one_area_within_limits_and_show_the_worst(count, size):
    """9000 square points, from 9 to 260 for one."""
    across = (np.arange(count) + 0.5).tolist()
    up = [1.0 - value for value in across]
    shares = [0.0, *[0.001] * (count - 1), 0.3]  # of the first place there are two
    some = results(shares, a=[*across, across[0]], b=[*up, up[0]])
    axes = Figure().add_subplot()
    maps._draw_map(axes, some, "a", "b")
    (points,) = axes.collections
    assert points.get_sizes() == pytest.approx([size])
    assert points.get_linewidths() == [0]
    assert points.get_offsets().tolist() == np.transpose([across, up]).tolist()
    first, *others = map(tuple, points.get_facecolors())
    assert first not in others
    assert len(others) == count - 1


def test_a_command_of_the_page_sets_what_a_point_of_the_sweep_was_given(tmp_path):
    """Lists, and what stands beside them or beside words, are texts in a table."""
    given = {
        "path.goal": [[0.1, 0.0, 0.0], [0.0, 0.1, 0.5]],
        "zero_offset": [0.25, [0.1, 0.2]],
        "feed_forward": [True, "predicted"],
        "path": [{"kind": "line", "goal": [0.1, 0.0, 0.0]}, {"kind": "ellipse"}],
        "robot": ["hexapod", "[own].xml"],
    }
    rows = [{key: values[i] for key, values in given.items()} for i in range(2)]
    write_table(tmp_path / "t.parquet", rows, {})
    columns, _ = read_table(tmp_path / "t.parquet")
    for key, values in given.items():
        shown = [toml_value(maps._given(value)) for value in columns[key]]
        assert [parse_override(f"{key}={text}")[1] for text in shown] == values
