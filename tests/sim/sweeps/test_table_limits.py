"""Tables and ledgers that declare more than there is room for are not read."""

import resource
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pytest

from sim.errors import UsageError
from sim.sweeps import table
from sim.sweeps.ledger import _lines


def refused(tmp_path, monkeypatch, rows=0, letters=0, about=0):
    """Whether a file is refused that declares so many rows and bytes of two columns."""
    schema = pa.schema({"x": pa.float64(), "word": pa.string()})
    declared = SimpleNamespace(
        num_rows=rows, num_columns=2, num_row_groups=1, serialized_size=about,
        row_group=lambda _: SimpleNamespace(total_byte_size=8 * rows + letters),
    )  # fmt: skip

    def opened(source, read_dictionary=None):
        if read_dictionary is not None:
            raise ValueError("read")
        return SimpleNamespace(metadata=declared, schema_arrow=schema)

    monkeypatch.setattr(table.parquet, "ParquetFile", opened)
    (tmp_path / "table.parquet").touch()
    with pytest.raises(UsageError) as error:
        table.read_table(tmp_path / "table.parquet")
    return "are too many" in str(error.value)


@pytest.mark.parametrize(
    ("declared", "too_many"),
    [
        ({"rows": 200_000}, False),
        ({"rows": 200_001}, True),
        ({"letters": 100_000_000}, False),  # which take five times as much memory
        ({"letters": 100_000_001}, True),
        ({"about": 100_000_001}, True),
    ],
    ids=str,
)
def test_tables_have_200_000_rows_and_half_a_gigabyte_at_most(
    tmp_path, monkeypatch, declared, too_many
):
    assert refused(tmp_path, monkeypatch, **declared) == too_many


def test_lines_of_a_ledger_come_in_parts_of_a_million_bytes(tmp_path):
    path = tmp_path / "ledger.jsonl"
    path.write_bytes(b"x" * 999_999 + b"\n" + b"y" * 1_000_001 + b'\n{"seal": "cut')
    sizes = [len(line) for line in _lines(path)]
    assert sizes == [1_000_000, 1_000_000, 2]


def test_reading_takes_no_more_memory_than_a_table_may(tmp_path):
    """A footer may lie about the sizes of pages, as of three texts of a gigabyte."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    with table._bounded(), pytest.raises(MemoryError):
        np.ones(4 * 10**8)  # 3.2 GB
    assert resource.getrlimit(resource.RLIMIT_AS) == before


@pytest.mark.parametrize(
    "write", [pa.large_string(), pa.dictionary(pa.int32(), pa.string())]
)
def test_tables_that_other_programs_have_written_are_read(tmp_path, write):
    """As polars has texts, and pandas categories."""
    path = tmp_path / "table.parquet"
    words = pa.array(["ok", None, "ok"]).cast(write)
    few = pa.array([0.5, 1.0, 2.0], pa.float32())
    table.parquet.write_table(pa.table({"status": words, "x": few}), path)
    columns, _ = table.read_table(path)
    assert columns == {"status": ["ok", None, "ok"], "x": [0.5, 1.0, 2.0]}


@pytest.mark.parametrize("rows", [slice(0, 3), slice(0, 2)])
def test_a_table_that_a_program_has_written_anew_is_read(tmp_path, rows):
    """With the old seal in its metadata, which are kept."""
    path = tmp_path / "t.parquet"
    table.write_table(path, [{"status": "ok", "x": 0.5}] * 3, {"asked": 1})
    part = table.parquet.read_table(path).slice(rows.start, rows.stop)
    table.parquet.write_table(part, path, compression="zstd", row_group_size=10_000)
    columns, about = table.read_table(path)
    assert (columns["x"], about) == ([0.5] * rows.stop, {"asked": 1})


@pytest.mark.parametrize(("sealed", "step"), [(True, 1), (False, 7)])
def test_a_flipped_bit_of_a_table_ends_no_process(tmp_path, sealed, step):
    """With its seal the table is refused; without, pyarrow may find nothing wrong."""
    path, passed = tmp_path / "t.parquet", set()
    table.write_table(path, [{"status": "ok", "x": 0.5}] * 3, {})
    content = path.read_bytes()
    mark = range(at := content.index(table.SEAL), at + len(table.SEAL))
    size = range(mark.stop, mark.stop + 12)  # which says that it was written anew
    if not sealed:
        content = content.replace(table.SEAL, b"?" * len(mark))
    for bit in range(0, 8 * len(content), step):
        spoilt = bytearray(content)
        spoilt[bit // 8] ^= 1 << bit % 8
        path.write_bytes(spoilt)
        try:
            table.read_table(path)
            passed.add(bit // 8)
        except UsageError:
            pass
    assert not sealed or passed == {*mark, *size}
