"""The pages that people read, taken apart into code blocks and command lines."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
README = ROOT / "README.md"
PAGES = [README, ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = r"^```{0}\n(.*?)^```\n(?:\n```text\n(.*?)^```)?"
PROMPT = "$ stratawalk "


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: str  # relative to the project's root
    number: int  # among the page's blocks of its language
    text: str
    shown: str = ""  # what the text block right after it shows

    def __str__(self):
        return f"{self.page}-{self.number}"


@dataclass(frozen=True)
class Command:
    """A command line of a page, and the lines shown under it."""

    page: str
    words: tuple[str, ...]
    shown: tuple[str, ...]

    def __str__(self):
        return f"{self.page}: {' '.join(self.words)}"


def name_of(page):
    return str(page.relative_to(ROOT))


def blocks(language):
    return [
        Block(name_of(page), number, *texts)
        for page in PAGES
        for number, texts in enumerate(
            re.findall(BLOCK.format(language), page.read_text(), re.DOTALL | re.M)
        )
    ]


def commands():
    """Every `$ stratawalk ...` of the pages."""
    return [
        _command(block.page, part)
        for block in blocks("console")
        for part in re.split(r"^(?=\$ )", block.text, flags=re.M)
        if part.startswith(PROMPT)
    ]


def _command(page, part):
    line, *shown = part.rstrip("\n").split("\n")
    words = shlex.split(line.removeprefix(PROMPT), comments=True)
    return Command(page, tuple(words), tuple(shown))
