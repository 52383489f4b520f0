"""The table of a sweep: a row a point, in one Parquet file; equal rows, equal bytes."""

import json
import resource
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from planner.support import read_file
from sim.endings import command
from sim.errors import UsageError
from sim.folder import whole
from sim.sweeps.file import shipped_studies
from sim.sweeps.folder import UNREADABLE

GROUP_ROWS = 10_000  # any other number gives other bytes
UNPACKED = 5 * 10**8  # bytes of a table that is read, with all that it repeats once
TEXT = 4  # times as much memory is taken by a byte of text besides
HEAD = 365  # bytes of a column without values
MOST_VALUES = 18 * 10**6  # 1.3 gigabytes once read: 50,000 points, 360 columns
MOST_ROWS = 200_000  # of 8 legs there are 144,088 designs
MEMORY = 10**9  # bytes of addresses that reading one may take, beside those reserved
ABOUT = "stratawalk"  # key of the metadata
SEAL = b"seal of this table: "
SIZE, DIGITS = 12, 76  # digits of its bytes' number, and with those of their digest
Row = Mapping[str, object]


def write_table(
    path: Path, rows: Sequence[Row], about: Mapping[str, object], new: bool = False
) -> None:
    """Write the rows as they are given, as a whole file or not at all.

    What a row lacks is null. What the rows come from is kept in the file's metadata.
    """
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = [_column([row.get(name) for row in rows]) for name in names]
    empty = SEAL + DIGITS * b"0"
    metadata = {ABOUT: json.dumps(about, sort_keys=True), "seal": empty}
    table = pa.table(columns, names=names).replace_schema_metadata(metadata)
    with whole(path, table.nbytes // 4 + HEAD * table.num_columns, new=new) as part:
        parquet.write_table(table, part, compression="zstd", row_group_size=GROUP_ROWS)
        place, seal = _seal(part.read_bytes())
        with part.open("r+b") as file:
            file.seek(place)
            file.write(seal)


def _seal(content: bytes) -> tuple[int, bytes]:
    """Where the seal of a table stands: how many bytes it has, and a digest of them."""
    at, parts = content.rindex(SEAL) + len(SEAL), memoryview(content)
    digest = sha256(parts[:at])
    digest.update(parts[at + DIGITS :])
    return at, f"{len(content):0{SIZE}}{digest.hexdigest()}".encode()


def read_table(path: Path) -> tuple[dict[str, list[object]], dict[str, Any]]:
    """Values by column, and what the rows come from; other files are refused.

    A few bytes may stand for any number of rows: what a file declares comes first.
    """
    if not path.is_file():
        remedy = "make one: stratawalk sweep friction-speed --out sweeps/friction-speed"
        if str(path) in shipped_studies():
            remedy = f"sweep it first: stratawalk sweep {path} --out sweeps/{path}"
        elif any(path.parent.glob("ledger*.jsonl")):
            shards = command("merge", path.parent)
            remedy = f"end its sweep with --resume, or merge its shards: {shards}"
        elif len(runs := sorted(path.parent.glob("*/summary.json"))) > 1:
            two = command("compare", *(run.parent for run in runs[-2:]))
            remedy = f"runs are compared: {two}"
        raise UsageError("no such table", str(path), remedy)
    content = read_file(path, UNPACKED)
    try:
        if SEAL in content:
            place, seal = _seal(content)
            told = content[place : place + DIGITS]
            if told != seal and told[:SIZE] == seal[:SIZE]:  # else it is written anew
                raise ValueError("it was changed after it was written")
        texts = _texts(parquet.ParquetFile(pa.BufferReader(content)))
        source = pa.BufferReader(content)
        with _bounded(), parquet.ParquetFile(source, read_dictionary=texts) as file:
            table = file.read(use_threads=False)  # others would go on after an error
        table.validate(full=True)
        about = json.loads((table.schema.metadata or {}).get(ABOUT.encode(), "null"))
        columns = {name: _values(table[name]) for name in table.column_names}
    except (pa.ArrowException, OSError, MemoryError, *UNREADABLE) as error:
        why = str(error).partition(". ")[0] or "it takes more memory than there is"
        if isinstance(error, pa.ArrowException | OSError):
            damaged = "it is damaged, or no Parquet file"
            why = getattr(error, "strerror", None) or damaged
        raise UsageError.of("no_table", path, why=why) from error
    return columns, about if isinstance(about, dict) else {}


def _texts(file: parquet.ParquetFile) -> list[str]:
    """Names of columns of text; ValueError where a file declares more than is read."""
    declared, schema = file.metadata, file.schema_arrow
    groups = map(declared.row_group, range(declared.num_row_groups))
    size = declared.serialized_size + sum(g.total_byte_size for g in groups)
    numbers = sum(pa.types.is_primitive(field.type) for field in schema)
    text = size - 8 * declared.num_rows * numbers  # at least
    size += TEXT * max(text, 0)
    most = MOST_VALUES // max(declared.num_columns, 1)
    if size > UNPACKED or declared.num_rows > min(most, MOST_ROWS):
        count = f"{declared.num_rows} x {declared.num_columns} values"
        raise ValueError(f"{count} with {size / 1e9:.2g} GB are too many")
    if lists := {str(f.type) for f in schema if pa.types.is_nested(f.type)}:
        raise ValueError(f"columns of {min(lists)[:40]} are none of a sweep")
    return [f.name for f in schema if f.type in (pa.string(), pa.large_string())]


@contextmanager
def _bounded() -> Iterator[None]:
    """Let this process take so much more memory, for a file may lie about its size."""
    kind, (soft, hard) = resource.RLIMIT_AS, resource.getrlimit(resource.RLIMIT_AS)
    now = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    most = now + MEMORY if hard == resource.RLIM_INFINITY else min(now + MEMORY, hard)
    resource.setrlimit(kind, (most, hard))
    try:
        yield
    finally:
        resource.setrlimit(kind, (soft, hard))


def _values(column: pa.ChunkedArray) -> list[object]:
    """Values of a column; each of its texts is there once, however often it is used."""
    if not pa.types.is_dictionary(column.type):
        return list(column.to_pylist())
    found: list[object] = []
    for chunk in column.chunks:
        texts = [*chunk.dictionary.to_pylist(), None]
        found += [texts[-1 if i is None else i] for i in chunk.indices.to_pylist()]
    return found


def _column(values: Sequence[Any]) -> pa.Array:
    """Values in the narrowest type that holds them all, text if they are mixed."""
    kinds = {type(value) for value in values if value is not None}
    if kinds in ({bool}, {int}):
        return pa.array(values)
    if kinds <= {int, float}:
        return pa.array([None if v is None else float(v) for v in values], pa.float64())
    texts = [v if v is None or isinstance(v, str) else json.dumps(v) for v in values]
    return pa.array(texts, pa.string())
