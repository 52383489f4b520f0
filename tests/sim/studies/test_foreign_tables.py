"""Tables that no sweep of ours has written are refused in one line."""

import json

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from sim.cli import main
from sim.studies import results
from sim.sweeps import table


def foreign(columns, vary=("friction",), text=None, **more):
    """A table of a stranger; what it varies is as said, or as a text has it."""
    asked = {"asked": {"vary": {key: [] for key in vary}}} | more

    def write(path):
        about = {"stratawalk": text or json.dumps(asked)}
        made = pa.table(columns).replace_schema_metadata(about)
        parquet.write_table(made, path, compression="zstd")

    return write


def column(name, value=0.5, rows=3, kind=None):
    words = ["ok"] * rows
    plain = {"point": [*range(rows)], "status": words, "path_length": [0.1] * rows}
    known = {"distance_walked": [0.1] * rows, FARTHEST_OFF: [0.1] * rows}
    return plain | known | {name: pa.array([value] * rows, kind)}


def of(name, values):
    """A table that is as it should be but for one of its columns."""
    return foreign({**column("friction"), name: values})


KEYS = [f"k{number}" for number in range(101)]
FARTHEST_OFF = "error.quasi_static.farthest"
FOREIGN = {
    "a file outside": (foreign(column("x/../../evil"), ["x/../../evil"]), "x/.."),
    "nothing that varies": (foreign(column("friction"), asked={}), "does not say"),
    "a number that varies": (
        foreign(column("friction"), asked={"vary": 3}),
        "does not say what varies: ",
    ),
    "what pandas has written": (
        lambda path: parquet.write_table(pa.table(column("friction")), path),
        "does not say what varies: ",
    ),
    "a judge in a list": (of("weighed.prediction", [["a"]] * 3), "list<element: str"),
    "numbers for settings": (
        foreign(column("friction"), asked={"vary": {"friction": []}, "set": 3}),
        "",
    ),
    "a setting as long as a book": (
        of("friction", ["x" * 50_000, "y", "z"]),
        "",
    ),
    "a verdict of no walk": (of("verdict", ["fell", "a\x1b[31m", None]), "a verdict"),
    "a status out of print": (of("status", ["ok", "a\x1b[31m", "ok"]), "in print"),
    "a point twice": (of("point", [0, 1, 1]), "point 1 stands in 2 rows: "),
    "a huge distance": (of(FARTHEST_OFF, [0.1, 1e300, 0.1]), "numbers from 0 to 1e+12"),
    "a way of nearly nothing": (of("path_length", [1e-320] * 3), ""),
    "numbers for a plan": (foreign(column("friction"), asked=5), "does not say"),
    "no such column": (foreign(column("friction"), ["hold"]), "varies, hold"),
    "words for numbers": (
        of("path_length", ["long"] * 3),
        "row 0 of column 'path_length' = 'long' is not allowed: the table; give num",
    ),
    "lists for numbers": (
        of("path_length", [[1.0]] * 3),
        "columns of list<element: double> are none of a sweep",
    ),
    "a length below 0": (of("path_length", [0.1, -1.0, 0.1]), "row 1 of column 'path_"),
    "truths for numbers": (of("path_length", [True] * 3), "'path_length' = True is no"),
    "a distance that is none": (of(FARTHEST_OFF, [0.1, 0.1, np.nan]), "row 2 of colum"),
    "an endless distance": (of(FARTHEST_OFF, [0.1, np.inf, 0.1]), "give numbers from"),
    "statuses that are numbers": (of("status", [np.nan] * 3), "'status' = nan is not"),
    "statuses that are truths": (of("status", [True] * 3), "'status' = True is not"),
    "statuses in lists": (of("status", [["ok"]] * 3), "columns of list<element: str"),
    "a point below 0": (of("point", [0, -1, 2]), "row 1 of column 'point' = -1 is not"),
    "a point that is none": (of("point", [0, None, 2]), "'point' = None is not all"),
    "half a point": (of("point", [0.0, 0.5, 1.0]), "'point' = 0.0 is not allowed"),
    "a verdict in a list": (of("verdict", [None, ["fell"], None]), "list<element: st"),
    "a setting without end": (of("friction", [0.1, 0.2, np.inf]), "'friction' = inf"),
    "no settings": (foreign({"x": [1]}), "varies, friction, point, status"),
    "a list of millions in one row": (
        foreign({"x": pa.array([[0] * 10**6])}),
        "int64> are none of a sweep",
    ),
    "too many values": (
        foreign({str(i): pa.nulls(10**5) for i in range(181)}),
        "100000 x 181 values with ",
    ),
    "a thousand times its size": (
        foreign({"x": ["x" * 3 * 10**5]}),
        "1 x 1 values with 0.0015 GB are too",
    ),
    "much that it comes from": (foreign({"x": [1]}, more="x" * 3 * 10**5), "too many"),
    "depths that it comes from": (
        foreign({"x": [1]}, text="[" * 10**4),
        "not the table of a sweep, maximum recursion",
    ),
    "no point that walked": (
        of("status", ["no plan; none", "ok?", "ok?"]),
        "no point has numbers, no plan; none: {file}; correct what the points",
    ),
    "keys without end": (
        foreign(column("k0") | {k: [0.5] * 3 for k in KEYS}, KEYS),
        "101 keys are given: {file}; give from 1 to 100 of them",
    ),
    "a word a row": (
        foreign(column("friction") | {"friction": [str(i) for i in range(3)]}),
        "",
    ),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_the_table_of_a_stranger_is_refused_in_one_line(
    tmp_path, capsys, monkeypatch, name
):
    monkeypatch.setattr(table, "UNPACKED", 10**6)
    write, said = FOREIGN[name]
    (tmp_path / "in").mkdir()
    write(tmp_path / "in" / "table.parquet")
    out = ["--out", str(tmp_path / "in" / "maps")]
    code = main(["study", str(tmp_path / "in" / "table.parquet"), *out])
    (line,) = capsys.readouterr().err.splitlines() or [""]
    assert code == (2 if said else 0)
    assert said.replace("{file}", str(tmp_path / "in" / "table.parquet")) in line
    assert {path.name for path in tmp_path.iterdir()} == {"in"}


def test_settings_of_a_table_are_as_many_as_are_studied_in_half_a_minute(
    tmp_path, capsys, monkeypatch
):
    path = tmp_path / "table.parquet"
    foreign(column("friction"))(path)
    for most, code in ((3, 0), (2, 2)):
        monkeypatch.setattr(results, "MOST_GIVEN", most)
        assert main(["study", str(path), "--out", str(tmp_path / "maps")]) == code
    assert "3 values of settings that vary, where 2 are read" in capsys.readouterr().err


def test_a_table_that_takes_more_memory_than_there_is_says_so(
    tmp_path, capsys, monkeypatch
):
    def full(column):
        raise MemoryError

    path = tmp_path / "table.parquet"
    foreign(column("friction"))(path)
    monkeypatch.setattr(table, "_values", full)
    assert main(["study", str(path), "--out", str(tmp_path / "maps")]) == 2
    assert "it takes more memory than there is" in capsys.readouterr().err
