"""The page of inputs and faults: its rows are the script's, and their tests exist."""

import re
from pathlib import Path

from scripts.torture import HEADER, ROWS

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "faults.md"


def test_every_kind_of_fault_has_a_row():
    assert {row.number for row in ROWS} == set(range(1, 56))


def test_the_page_shows_rows_of_the_script_that_end_as_they_must():
    _, header, text = PAGE.read_text().partition(f"| {HEADER} |\n")
    assert header
    must = {(str(row.number), row.fault): str(row.code) for row in ROWS}
    for line in text.splitlines()[1:]:
        number, fault, _, code = line.removeprefix("| ").split(" | ")[:4]
        assert must[number, fault] == code


def test_every_row_names_tests_that_exist():
    for row in ROWS:
        file, _, test = row.test.partition("::")
        texts = [path.read_text() for path in (ROOT / "tests").rglob(file)]
        named = re.compile(rf"^def {test}\(", re.MULTILINE)
        assert any(named.search(text) for text in texts), row.test
