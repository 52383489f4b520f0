#!/usr/bin/env python3
"""Run the command on inputs and faults that break programs, and write docs/faults.md.

`python -m scripts.torture` runs the real command for every table of
`scripts/faults.toml`, in a folder of its own; numbers behind it choose rows, whose
results are printed alone. A row that does not end as it must is marked, and the script
ends with 1.
"""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from scripts.endings import ROOT, Ending, ending

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
ROBOTS = ROOT / "models" / "robots"
TOOLS = {  # found before all others
    "stratawalk": '#!/bin/sh\nexec {python} -m sim.cli "$@"\n',
    "python": '#!/bin/sh\nexec {python} "$@"\n',
}
LONGEST = 260  # characters of what is said
ROW_LIMIT = 400  # [s] for a row
AT_ONCE = 2  # rows

_FILE = tomllib.loads((ROOT / "scripts" / "faults.toml").read_text())
TEXTS: Mapping[str, str] = _FILE["texts"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One fault: the command, how it must end, and what makes it.

    The tables of `scripts/faults.toml` have these keys and explain them.
    """

    number: int
    fault: str
    command: str
    code: int
    test: str
    says: str = ""
    lines: int | None = None
    files: Mapping[str, str | Sequence[str]] = field(default_factory=dict)
    robot: tuple[str, str] | None = None
    prepare: str = ""

    def make(self, folder: Path, env: Mapping[str, str]) -> None:
        """Write the files that the command needs into the folder it is run in."""
        if self.robot:
            for suffix in ("xml", "toml"):
                text = (ROBOTS / f"hexapod.{suffix}").read_text()
                (folder / f"mine.{suffix}").write_text(text.replace(*self.robot))
            (folder / "scene.xml").write_bytes((ROBOTS / "scene.xml").read_bytes())
        for name, content in self.files.items():
            _write(folder / name, text_of(content))
        given = dict(env) | {"ROBOTS": str(ROBOTS)}
        prepare = ["sh", "-euc", self.prepare]
        subprocess.run(prepare, cwd=folder, env=given, check=True)

    def wrong(self, end: Ending) -> str:
        """What is not as it must be, in words; empty if all is."""
        faults = []
        if end.code != self.code:
            faults.append(f"must be {self.code}")
        lines = len(_said(end.warned))
        if lines != (self.code != 0 if self.lines is None else self.lines):
            faults.append(f"{lines} lines")
        if self.says not in _answer(self, end):
            faults.append(f"must say {self.says!r}")
        return ", ".join(faults)


ROWS = tuple(Row(**table) for table in _FILE["fault"])


def text_of(content: str | Sequence[str]) -> str:
    """The text of a file, in which `@name` stands for one of the common texts."""
    if isinstance(content, str):
        return content
    return "".join(TEXTS[part[1:]] if part[:1] == "@" else part for part in content)


def ended(row: Row) -> tuple[Ending, float]:
    """How a row's command ends where its files are, and how long it takes [s]."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, tools = Path(scratch, "here"), Path(scratch, "bin")
        folder.mkdir()
        tools.mkdir()
        for name, text in TOOLS.items():
            _write(tools / name, text.format(python=shlex.quote(sys.executable)))
        env = _environment(tools)
        row.make(folder, env)
        began = time.monotonic()
        end = ending(["sh", "-c", row.command], folder, ROW_LIMIT, env)
        seconds = time.monotonic() - began
        places = (f"{folder}/", f"{scratch}/", f"{ROOT}/")
        return _without(end, places), seconds


def _without(end: Ending, places: Sequence[str]) -> Ending:
    """The same, said without the places of folders."""
    texts = [end.printed, *end.warned]
    for place in places:
        texts = [text.replace(place, "") for text in texts]
    return Ending(end.code, texts[0], texts[1:])


def _said(warned: Sequence[str]) -> list[str]:
    return [line for line in warned if line]


def _answer(row: Row, end: Ending) -> str:
    """What the command says: its error, or else the line of its output to look for."""
    said = _said(end.warned)
    if said:
        return said[0].removeprefix("stratawalk: error: ")
    lines = end.printed.splitlines() or [""]
    return next((line for line in lines if row.says and row.says in line), lines[-1])


def _write(path: Path, text: str) -> None:
    path.write_text(text)
    if text.startswith("#!"):
        path.chmod(0o755)


def _environment(tools: Path) -> dict[str, str]:
    """As little as there can be, besides this code."""
    kept = {key: os.environ[key] for key in ("LD_LIBRARY_PATH",) if key in os.environ}
    path = f"{tools}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
    return {"PATH": path, "PYTHONPATH": str(ROOT), "HOME": str(tools), **kept}


def line(row: Row, end: Ending) -> str:
    """A row of the table."""
    wrong, said = row.wrong(end), _answer(row, end)
    code = f"{end.code} ({wrong})" if wrong else str(end.code)
    said = said if len(said) < LONGEST else f"{said[:LONGEST]} ..."
    cells = (
        str(row.number),
        row.fault,
        f"`{row.command}`",
        code,
        said,
        f"`{row.test}`",
    )
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def main(numbers: Sequence[str]) -> int:
    """Run all rows, or those of some numbers; 1 if one does not end as it must."""
    rows = [row for row in ROWS if not numbers or str(row.number) in numbers]
    wrong, lines = 0, []
    with ThreadPoolExecutor(AT_ONCE) as pool:
        for row, (end, seconds) in zip(rows, pool.map(ended, rows), strict=True):
            lines.append(line(row, end))
            wrong += bool(row.wrong(end))
            print(f"{seconds:5.1f} s {lines[-1]}", flush=True)
    if not numbers:
        (ROOT / "docs" / "faults.md").write_text(HEAD + "\n".join(lines) + "\n")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
