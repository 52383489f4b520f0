"""The table of a sweep: a row a point, in one Parquet file; equal rows, equal bytes."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from sim.errors import UsageError
from sim.folder import whole

GROUP_ROWS = 10_000  # any other number gives other bytes
ABOUT = "stratawalk"  # key of the metadata
Row = Mapping[str, object]


def write_table(path: Path, rows: Sequence[Row], about: Mapping[str, object]) -> None:
    """Write the rows as they are given, as a whole file or not at all.

    What a row lacks is null. What the rows come from is kept in the file's metadata.
    """
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [_column([row.get(name) for row in rows]) for name in names]
    metadata = {ABOUT: json.dumps(about, sort_keys=True)}
    table = pa.table(columns, names=names).replace_schema_metadata(metadata)
    with whole(path, table.nbytes // 4) as part:
        parquet.write_table(table, part, compression="zstd", row_group_size=GROUP_ROWS)


def read_table(path: Path) -> tuple[dict[str, list[object]], dict[str, Any]]:
    """Values by column, and what the rows come from; other files are refused."""
    if not path.is_file():
        raise UsageError("no such table", str(path), "give the table of a sweep")
    try:
        table = parquet.read_table(path)
        about = json.loads(table.schema.metadata[ABOUT.encode()])
    except (pa.ArrowException, OSError, KeyError, TypeError, ValueError) as error:
        what = "not the table of a sweep"
        remedy = "give the table that `stratawalk sweep` has written"
        raise UsageError(what, str(path), remedy) from error
    return {name: table[name].to_pylist() for name in table.column_names}, about


def _column(values: Sequence[Any]) -> pa.Array:
    """Values in the narrowest type that holds them all, text if they are mixed."""
    kinds = {type(value) for value in values if value is not None}
    if kinds in (set(), {int, float}, {float}):
        numbers = [None if v is None else float(v) for v in values]
        return pa.array(numbers, pa.float64())
    if kinds == {bool}:
        return pa.array(values, pa.bool_())
    if kinds == {int}:
        return pa.array(values, pa.int64())
    texts = [v if v is None or isinstance(v, str) else json.dumps(v) for v in values]
    return pa.array(texts, pa.string())
