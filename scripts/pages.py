"""What studies for the documentation share: parser, tables, pictures."""

import argparse
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from planner.support import shipped_tables

LOOKS = shipped_tables("sim", "styles.toml")  # of figures
STUDIES = shipped_tables("scripts", "studies.toml")
TABLE = re.compile(r"(?:^\|.*\n)+", re.MULTILINE)


def parser_of(documentation: str | None) -> argparse.ArgumentParser:
    """A parser that is described by the first line of a module's documentation."""
    return argparse.ArgumentParser(description=(documentation or "").splitlines()[0])


def tabulate(
    header: str, rows: Iterable[Sequence[object]], page: Path | None = None
) -> None:
    """Print a table row by row; then it takes the place of the page's first table."""
    lines = [f"| {header} |", "|" + "---|" * len(header.split(" | "))]
    print(*lines, sep="\n", flush=True)
    for row in rows:
        lines.append(f"| {' | '.join(map(str, row))} |")
        print(lines[-1], flush=True)
    if page is not None:
        table = "".join(f"{line}\n" for line in lines)
        page.write_text(TABLE.sub(lambda _: table, page.read_text(), count=1))


@contextmanager
def picture(path: Path, size: tuple[float, float], **saved: Any) -> Iterator[Any]:
    """A figure of a size [in], which is written to the path when the block ends."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context({"grid.color": "0.86", **LOOKS["base"], **LOOKS["figures"]}):
        figure = Figure(figsize=size, layout="constrained")
        yield figure
        figure.savefig(path, **saved)
    print(f"drawn: {path}")
