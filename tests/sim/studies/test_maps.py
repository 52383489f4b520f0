"""Maps of a study: what is written in their squares."""

from matplotlib.figure import Figure

from sim.studies import maps
from sim.studies.results import Results


def test_a_number_in_a_map_is_within_the_class_whose_colour_it_has():
    """0.1503 % is beyond 0.15 %, so it is not written as 0.15."""
    shares = [0.001, 0.0015, 0.001503, 0.004]
    columns = {
        "point": [*range(4)], "status": ["ok"] * 4, "speed": ["a", "b", "a", "b"],
        "friction": ["c", "c", "d", "d"], "path_length": [1.0] * 4,
        "distance_walked": [1.0] * 4, "error.ideal.farthest": shares,
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
