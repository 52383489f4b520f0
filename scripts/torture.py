#!/usr/bin/env python3
"""Run the command on inputs and faults that break programs, and write docs/faults.md.

`python -m scripts.torture` runs the real command for every table of
`scripts/faults.toml`, in a folder of its own; numbers behind it choose rows, whose
results are printed alone. A row that does not end as it must is marked, and the script
ends with 1.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from planner.support import shipped_tables
from scripts.endings import ROOT, Ending, ending, other
from scripts.pages import tabulate

HEADER = "# | input or fault | command | code | what it says | test"
ROBOTS = ROOT / "models" / "robots"
TOOLS = {  # found before all others
    "stratawalk": '#!/bin/sh\nexec {python} -m sim.cli "$@"\n',
    "python": '#!/bin/sh\nexec {python} "$@"\n',
}
MOST_CHARACTERS = 260  # characters of what is said

_FILE = shipped_tables("scripts", "faults.toml")
TEXTS: Mapping[str, str] = _FILE["texts"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One fault of `faults.toml`: the command, how it must end, and what makes it."""

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
            if not isinstance(content, str):  # `@name` stands for a common text
                texts = (TEXTS[p[1:]] if p[:1] == "@" else p for p in content)
                content = "".join(texts)
            _write(folder / name, content)
        given = dict(env) | {"ROBOTS": str(ROBOTS)}
        subprocess.run(["sh", "-euc", self.prepare], cwd=folder, env=given, check=True)

    def wrong(self, end: Ending) -> str:
        """What is not as it must be, in words; empty if all is."""
        faults = []
        if end.code != self.code:
            faults.append(f"must be {self.code}")
        lines = sum(map(bool, end.warned))
        if lines != (self.code != 0 if self.lines is None else self.lines):
            faults.append(f"{lines} lines")
        if self.says not in self.answer(end):
            faults.append(f"must say {self.says!r}")
        return ", ".join(faults)

    def answer(self, end: Ending) -> str:
        """What is said: an error, or else the line of the output to look for."""
        if said := next(filter(None, end.warned), ""):
            return said.removeprefix("stratawalk: error: ")
        lines = end.printed.splitlines() or [""]
        found = (line for line in lines if self.says and self.says in line)
        return next(found, lines[-1])

    def cells(self, end: Ending) -> list[str]:
        """The row of the page."""
        wrong, said = self.wrong(end), self.answer(end)
        code = f"{end.code} ({wrong})" if wrong else str(end.code)
        said = said if len(said) < MOST_CHARACTERS else f"{said[:MOST_CHARACTERS]} ..."
        made = str(self.number), self.fault, f"`{self.command}`"
        return [c.replace("|", r"\|") for c in (*made, code, said, f"`{self.test}`")]


ROWS = tuple(Row(**table) for table in _FILE["fault"])


def ended(row: Row) -> Ending:
    """How a row's command ends where its files are, without the places of folders."""
    with tempfile.TemporaryDirectory() as scratch:
        folder, tools = Path(scratch, "here"), Path(scratch, "bin")
        folder.mkdir()
        tools.mkdir()
        for name, text in TOOLS.items():
            _write(tools / name, text.format(python=shlex.quote(sys.executable)))
        # As little as there can be, besides this code.
        env = {k: os.environ[k] for k in ("LD_LIBRARY_PATH",) if k in os.environ}
        env["PATH"] = f"{tools}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin"
        env |= {"PYTHONPATH": str(ROOT), "HOME": str(tools)}
        row.make(folder, env)
        end = ending(lambda: other(["sh", "-c", row.command], env), folder, 400)  # [s]
        folders = map(re.escape, (str(folder), scratch, str(ROOT)))
        places = re.compile(f"(?:{'|'.join(folders)})/")
        warned = [places.sub("", text) for text in end.warned]
        return Ending(end.code, places.sub("", end.printed), warned)


def _write(path: Path, text: str) -> None:
    path.write_text(text)
    if text.startswith("#!"):
        path.chmod(0o755)


def main(numbers: Sequence[str]) -> int:
    """Run all rows, or those of some numbers; 1 if one does not end as it must."""
    rows = [row for row in ROWS if not numbers or str(row.number) in numbers]
    wrong = 0

    def cells() -> Iterator[list[str]]:
        nonlocal wrong
        with ThreadPoolExecutor(2) as pool:  # rows at once
            for row, end in zip(rows, pool.map(ended, rows), strict=True):
                wrong += bool(row.wrong(end))
                yield row.cells(end)

    tabulate(HEADER, cells(), None if numbers else ROOT / "docs" / "faults.md")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
