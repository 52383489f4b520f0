#!/usr/bin/env python3
"""Run the command on inputs and faults that break programs, and write docs/faults.md.

`python -m scripts.torture` runs the real command for every row of
`scripts/torture_rows.py`, in a folder of its own; numbers behind it choose rows, whose
results are printed alone. A row that does not end as it must is marked, and the script
ends with 1.
"""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from scripts.fuzz_worker import PROGRESS
from scripts.torture_rows import ROOT, ROWS, Row

HEAD = """# Inputs and faults

What the command does about inputs and surroundings that break programs: each row was
run as shown, in a folder that holds the files it names, and each has a test that
guards it. An error is one line on standard error; 0 stands for a command that did what
it was asked. `python -m scripts.torture` runs all rows and writes
this page.

Rows with the same number in the first column are cases of one kind of fault;
`python -m scripts.torture 12` runs those of kind 12.

| # | input or fault | command | code | what it says | test |
|---|---|---|---|---|---|
"""
WRAPPER = '#!/bin/sh\nexec {python} -m sim.cli "$@"\n'
PYTHON = "#!/bin/sh\nexec {python} {arguments}\n"
LONGEST = 260  # characters of what is said
ROW_LIMIT = 400  # [s] for a row
AT_ONCE = 2  # rows


@dataclass(frozen=True)
class Ending:
    """How a row's command ended."""

    code: int
    said: str
    lines: int
    seconds: float

    def wrong(self, row: Row) -> str:
        """What is not as it must be, in words; empty if all is."""
        faults = []
        if self.code != row.code:
            faults.append(f"must be {row.code}")
        if self.lines != (row.code != 0 if row.lines is None else row.lines):
            faults.append(f"{self.lines} lines")
        if row.says not in self.said:
            faults.append(f"must say {row.says!r}")
        return ", ".join(faults)


def ending(row: Row) -> Ending:
    """Run a row's command where its files are, and look how it ends."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, tools = Path(scratch, "here"), Path(scratch, "bin")
        folder.mkdir()
        tools.mkdir()
        python = shlex.quote(sys.executable)
        _tool(tools / "stratawalk", WRAPPER.format(python=python))
        _tool(tools / "python", PYTHON.format(python=python, arguments='"$@"'))
        row.make(folder)
        began = time.monotonic()
        printed, warned = Path(scratch, "printed"), Path(scratch, "warned")
        with printed.open("w") as out, warned.open("w") as err:
            process = subprocess.Popen(
                ["sh", "-c", row.command],
                cwd=folder,
                env=_environment(tools),
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
                start_new_session=True,
            )
        try:
            process.wait(ROW_LIMIT)
        except subprocess.TimeoutExpired:
            return Ending(-1, "", 0, ROW_LIMIT)
        finally:
            with suppress(ProcessLookupError):  # what it left in the background
                os.killpg(process.pid, signal.SIGKILL)
        seconds = time.monotonic() - began
        told = _text(warned).splitlines()
        lines = [line for line in told if line and not PROGRESS.match(line)]
        said = lines[0] if lines else _line_with(row.says, _text(printed))
        said = said.removeprefix("stratawalk: error: ")
        for place in (f"{folder}/", f"{scratch}/", f"{ROOT}/"):
            said = said.replace(place, "")
        return Ending(process.returncode, said, len(lines), seconds)


def _text(path: Path) -> str:
    return path.read_text(errors="replace")


def _line_with(part: str, text: str) -> str:
    """The first line that holds a part; the last one if none does, or none is asked."""
    lines = text.splitlines() or [""]
    return next((line for line in lines if part and part in line), lines[-1])


def _tool(path: Path, text: str) -> None:
    path.write_text(text)
    path.chmod(0o755)


def _environment(tools: Path) -> dict[str, str]:
    """As little as there can be, besides this code."""
    kept = {key: os.environ[key] for key in ("LD_LIBRARY_PATH",) if key in os.environ}
    path = f"{tools}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
    return {"PATH": path, "PYTHONPATH": str(ROOT), "HOME": str(tools), **kept}


def line(row: Row, end: Ending) -> str:
    """A row of the table."""
    wrong = end.wrong(row)
    code = f"{end.code} ({wrong})" if wrong else str(end.code)
    said = end.said if len(end.said) < LONGEST else f"{end.said[:LONGEST]} ..."
    tests = ", ".join(f"`{test}`" for test in row.tests)
    cells = (str(row.number), row.fault, f"`{row.command}`", code, said, tests)
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def main(numbers: Sequence[str]) -> int:
    """Run all rows, or those of some numbers; 1 if one does not end as it must."""
    rows = [row for row in ROWS if not numbers or str(row.number) in numbers]
    wrong, lines = 0, []
    with ThreadPoolExecutor(AT_ONCE) as pool:
        for row, end in zip(rows, pool.map(ending, rows), strict=True):
            lines.append(line(row, end))
            wrong += bool(end.wrong(row))
            print(f"{end.seconds:5.1f} s {lines[-1]}", flush=True)
    if not numbers:
        (ROOT / "docs" / "faults.md").write_text(HEAD + "\n".join(lines) + "\n")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
