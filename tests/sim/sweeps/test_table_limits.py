"""Tables and ledgers that declare more than there is room for are not read."""

from types import SimpleNamespace

import pytest

from sim.errors import UsageError
from sim.sweeps import table
from sim.sweeps.ledger import _lines


def refused(tmp_path, monkeypatch, rows=1, numbers=0, letters=0, about=0):
    """Whether a file is refused that declares so many rows and bytes of two columns."""
    sizes = (numbers, "DOUBLE"), (letters, "BYTE_ARRAY")
    columns = [
        SimpleNamespace(total_uncompressed_size=size, physical_type=kind)
        for size, kind in sizes
    ]
    declared = SimpleNamespace(
        num_rows=rows, num_columns=2, num_row_groups=1, serialized_size=about,
        row_group=lambda _: SimpleNamespace(column=columns.__getitem__),
    )  # fmt: skip

    def schema(path):
        raise ValueError("read")

    monkeypatch.setattr(table.parquet, "read_metadata", lambda _: declared)
    monkeypatch.setattr(table.parquet, "read_schema", schema)
    (tmp_path / "table.parquet").touch()
    with pytest.raises(UsageError) as error:
        table.read_table(tmp_path / "table.parquet")
    return "are too many" in str(error.value)


@pytest.mark.parametrize(
    ("declared", "too_many"),
    [
        ({"rows": 200_000}, False),
        ({"rows": 200_001}, True),
        ({"numbers": 500_000_000}, False),
        ({"numbers": 500_000_001}, True),
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
