"""The ledger of a sweep: a line a finished point, and nothing is ever taken back.

A line is on the disk before its point counts as done, and begins with a seal, the
digest of the rest. A torn last line is cut off and its point walked again; any other
line that is not as it was written is refused. A point is known by a digest of its
settings and of the files of its robot and motion, beside the software's versions.
"""

import hashlib
import json
import os
import platform
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path

from models import ModelError, load
from planner.support import open_file, read_file
from sim.errors import LAYERS, FilesError, UsageError, is_text, printable, telling
from sim.scenarios.file import to_table
from sim.scenarios.scenario import LEFT, Scenario
from sim.sweeps.file import flat
from sim.versions import PACKAGES, versions

KINDS = (".py", ".toml", ".xml")
ALIKE = (*PACKAGES, "machine", "code")


def digest(scenario: Scenario, without: Sequence[str]) -> str:
    """Digest of all that decides a point's numbers, but for versions and names."""
    named = to_table(scenario).items()
    table = {key: value for key, value in named if key not in ("name", "description")}
    about = table, sorted(LEFT & scenario.given), sorted(without), files_of(scenario)
    content = json.dumps(about, sort_keys=True, default=str)
    return hashlib.sha256(content.encode()).hexdigest()[:32]


def files_of(scenario: Scenario) -> tuple[tuple[str, str], ...]:
    """Files of a user's own robot and motion, each with its digest."""
    own = ((path, path.stat()) for path in _own_files(scenario))
    return tuple((str(p), _digest(p, at.st_mtime_ns, at.st_size)) for p, at in own)


def software() -> dict[str, str]:
    """Versions that numbers depend on, the machine's architecture, our own code."""
    return {**versions(), "machine": platform.machine(), "code": _code()}


def alike(*known: Mapping[str, str]) -> list[dict[str, str]]:
    """The parts of versions that must be the same wherever points are walked."""
    return [{key: one[key] for key in ALIKE if key in one} for one in known]


def differences(first: Mapping[str, object], second: Mapping[str, object]) -> list[str]:
    """What two tables disagree on by dotted names, as `key: value, now value`."""
    one, other = dict(flat(first)), dict(flat(second))
    return [
        f"{key}: {_shown(one, key)}, now {_shown(other, key)}"
        for key in [*one, *(key for key in other if key not in one)]
        if one.get(key) != other.get(key)
    ]


def _shown(table: Mapping[str, object], key: str) -> str:
    text = json.dumps(table[key]) if key in table else "nothing"
    return text if len(text) <= 80 else f"{text[:38]} ... {text[-38:]}"


@cache
def _code() -> str:
    """Digest of this package's own sources; as git's hash, but for what is changed."""
    parts = hashlib.sha256()
    for package in LAYERS:
        for path in sorted(Path(str(files(package))).rglob("*")):
            if path.suffix in KINDS:
                parts.update(path.name.encode() + path.read_bytes())
    return parts.hexdigest()[:16]


def _own_files(scenario: Scenario) -> list[Path]:
    """Motion, card and all that the model of a user's robot opens; none if shipped."""
    own = {Path(scenario.motion)} if scenario.motion else set[Path]()
    path, before = Path(scenario.robot), frozenset[Path]()
    if path.suffix == ".xml" and path.is_file():
        files = frozenset({path})
        with suppress(ModelError):  # whose reason stands in the table, for each point
            while files != before:  # each may name others since it was changed
                there = (at for at in files if at.is_file())
                changed = frozenset((at, at.stat().st_mtime_ns) for at in there)
                before, files = files, _opened(str(path), changed)
        own |= {path.with_suffix(".toml"), *files}
    return sorted(path for path in own if path.is_file())


@cache
def _opened(robot: str, changed: frozenset[tuple[Path, int]]) -> frozenset[Path]:
    return frozenset(load(robot).opened.files)


@cache
def _digest(path: Path, changed: int, size: int) -> str:
    return hashlib.sha256(read_file(path, 10**9)).hexdigest()


OK = "ok"
DIED = "its worker died"  # how the status begins of a point to be walked again
SEAL = b'{"seal": "%b", '
LENGTH = len(SEAL % bytes(16))
LONGEST_LINE = 10**6  # bytes of a line
LARGEST_LEDGER = 2 * 10**9  # bytes that it takes, held and as a table; most, less


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a point."""

    digest: str  # of its settings
    status: str  # `ok`, or the reason why it has no numbers
    numbers: Mapping[str, object] = field(default_factory=dict)  # by dotted names
    software: Mapping[str, str] = field(default_factory=dict)  # that they come from

    def __post_init__(self) -> None:
        words = self.digest, self.status, *self.software.values(), *self.numbers
        numbers = self.numbers.values()
        if not (all(map(is_text, words)) and all(map(_is_plain, numbers))):
            raise TypeError("a text of it is no text, or a number no number")
        said = " ".join(self.status[:2000].split())  # letters; errors have 1000
        if self.status != (printable(said) or None):
            raise TypeError("its status is no message of one line")

    @property
    def died(self) -> bool:
        """Whether it is worth another try, as its worker ended and it did not."""
        return self.status.startswith(DIED)

    @property
    def line(self) -> bytes:
        """The line of the ledger that says so."""
        return _sealed(json.dumps(asdict(self)).encode())

    @classmethod
    def read(cls, line: bytes) -> "Outcome":
        """What a line says; a ValueError if it is not as it was written."""
        content = b"{" + line[LENGTH:-1]
        if line != _sealed(content):
            raise ValueError("it was changed since")
        try:
            return cls(**json.loads(content))
        except (TypeError, AttributeError, RecursionError) as error:
            raise ValueError(str(error)) from error


class Ledger:
    """A ledger that is open for writing."""

    def __init__(self, path: Path, handle: int) -> None:
        self._path, self._handle = path, handle

    def add(self, outcomes: Iterable[Outcome]) -> None:
        """Write lines and wait until they are on the disk."""
        content = b"".join(one.line for one in outcomes)
        remedy = "make room, and repeat the command, sweep with --resume; points stay"
        with telling("cannot be written", self._path, remedy):
            while content:
                content = content[os.write(self._handle, content) :]
            os.fsync(self._handle)
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(self._handle), self._path.stat()):
                return
        raise FilesError.of("ledger_gone", self._path)


@contextmanager
def opened(path: Path) -> Iterator[Ledger]:
    """A ledger to add to; a line that was torn is cut off first."""
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW
    with telling("cannot be opened", path, "choose another folder"):
        handle = os.open(path, flags, 0o666)
        os.ftruncate(handle, path.read_bytes().rfind(b"\n") + 1)
    try:
        yield Ledger(path, handle)
    finally:
        os.close(handle)


def read_ledger(
    *paths: Path,
    software: Mapping[str, str] | None = None,
    points: Mapping[str, int] | None = None,
) -> dict[str, Outcome]:
    """Finished points by their digests; none where there is no ledger yet.

    A torn last line counts as not written, and its point is walked again; the result of
    a point takes the place of its worker's death. Refused are lines of other software,
    and two results of a point, which has a number. Other points are left out.
    """
    known: dict[str, Outcome] = {}
    names: set[str] = set()  # of numbers, each a column of the table
    for path in paths:
        size = 0
        for number, line in enumerate(_lines(path), start=1):
            try:
                one = Outcome.read(line)
                size += 5000 + len(line) + 100 * len(one.numbers)
                names |= one.numbers.keys()
                if size + len(names) * (6000 + 20 * len(known)) > LARGEST_LEDGER:
                    raise ValueError("no sweep has so many points or numbers")
                if software and (differ := differences(*alike(software, one.software))):
                    raise ValueError(f"it is of other software, {differ[0]}")
                if points is not None and one.digest not in points:
                    continue
                before = known.setdefault(one.digest, one)
                results = ({**o.numbers, "status": o.status} for o in (before, one))
                if before.died:
                    known[one.digest] = one
                elif one != before and not one.died and (odd := differences(*results)):
                    point = (points or {}).get(one.digest, one.digest)
                    raise ValueError(f"point {point} has two results, {odd[0]}")
            except ValueError as error:
                facts = {"number": number, "why": error}
                raise UsageError.of("ledger_line", path, **facts) from error
    return known


def _lines(path: Path) -> Iterator[bytes]:
    """Lines of a ledger, if there is one; one that is too long comes in parts."""
    with suppress(FileNotFoundError), open_file(path) as file:
        for line in iter(lambda: file.readline(LONGEST_LINE), b""):
            ours = SEAL.startswith(line[: SEAL.index(b"%")].rstrip(b"\0"))
            if line.endswith(b"\n") or len(line) == LONGEST_LINE or not ours:
                yield line


def _sealed(content: bytes) -> bytes:
    """A line that holds a JSON object, with the first digits of its digest in front."""
    digest = hashlib.sha256(content).hexdigest()[:16]
    return SEAL % digest.encode() + content[1:] + b"\n"


def _is_plain(value: object) -> bool:
    """Whether a table has room for a value: a number, a text, yes or no, or nothing."""
    if isinstance(value, int | float):
        return abs(value) < 2**63  # beyond the numbers that a table takes
    return value is None or is_text(value)
