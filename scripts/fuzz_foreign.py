"""Inputs for `scripts/fuzz.py` that others may send: robots, tables, finished runs.

Every kind is a function that writes its files into a folder, one of them mutated, and
returns the words of the command to run there; a text is what is found wrong already.
What they begin with is made once.
"""

import io
import json
import random
import shutil
import struct
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache, partial
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import numpy as np

from scripts.adoptees import ADOPTEES
from scripts.endings import ROOT, ending
from scripts.fuzz_inputs import NASTY, TEXTS, mutated, write
from scripts.torture import TEXTS as SMALL

WALKED = ["line", "--segments", "1", "--set", "path.goal=[0.005,0,0]"]
RUN = " ".join(["run", *WALKED, "--no-video"])
SWEPT = "sweep mine.toml --workers 1"
MAKING = 600.0  # [s] that these may take
BODY = ("body.x", "body.y", "body.yaw", "body.x.error", "contact.1")
DRIVEN = "line --segments 2 --set path.goal=[0.005,0,0] --pace 0 --poses mine.csv"
SCRATCH = tempfile.TemporaryDirectory(prefix="fuzz-")
SIZES = (0, 1, 2, 7, 10**5, 2**31, 2**63 - 1)


def flipped(content: bytes, rng: random.Random) -> bytes:
    """Bytes with one to eight of them changed, cut off or repeated."""
    for _ in range(rng.randint(1, 8)):
        at, gone = rng.randrange(len(content) + 1), rng.randrange(9)
        odd = bytes([rng.choice((0, 1, 127, 128, 255))])
        new = rng.choice((b"", odd, odd, content[at : at + 8]))
        content = content[:at] + new + content[at + gone :]
    return content[:at] if rng.random() < 0.1 else content


def adopted(folder: Path, rng: random.Random, urdf: bool) -> list[str]:
    """A robot to adopt, in MJCF or URDF."""
    path = rng.choice([a for a in ADOPTEES if a.urdf == urdf]).write(folder)
    write(path, mutated(path.read_text().replace("><", ">\n<"), rng))
    return ["adopt", path.name]


def mesh(folder: Path, rng: random.Random) -> list[str]:
    """A mesh of a robot to adopt, as text or in binary."""
    kind = rng.choice(("obj", "stl"))
    path = ADOPTEES[0].write(folder)
    shape = TEXTS["shape"].format(kind)
    path.write_text(path.read_text().replace("<worldbody>", shape, 1))
    (folder / f"part.{kind}").write_bytes(
        mutated(TEXTS["obj"], rng).encode(errors="surrogateescape")
        if kind == "obj"
        else flipped(_stl(), rng)
    )
    return ["adopt", path.name]


def sweep(folder: Path, rng: random.Random) -> list[str]:
    """The file of a sweep, which is read as far as its folder, which exists."""
    write(folder / "mine.toml", mutated(TEXTS["sweep"], rng))
    return ["sweep", "mine.toml", "--out", "."]


def ledger(folder: Path, rng: random.Random) -> list[str]:
    """What a sweep has done; lines of its ledger may be sealed again."""
    shutil.copytree(_made(SWEPT), folder / "mine")
    path = folder / "mine" / rng.choice(("ledger.jsonl", "ledger.jsonl", "sweep.json"))
    if path.suffix == ".json":
        write(path, _json(path.read_text(), rng))
    else:
        lines = path.read_bytes().splitlines(keepends=True)
        at = rng.randrange(len(lines))
        lines[at] = (_sealed if rng.random() < 0.7 else flipped)(lines[at], rng)
        path.write_bytes(b"".join(lines))
    return ["merge", "mine", "--out", "joined"]


def table(folder: Path, rng: random.Random) -> list[str]:
    """The table of a sweep."""
    content = (_made(SWEPT) / "table.parquet").read_bytes()
    (folder / "table.parquet").write_bytes(flipped(content, rng))
    return ["study", "table.parquet"]


def servos(folder: Path, rng: random.Random) -> list[str]:
    """A table of servos that a walk is exported for."""
    card = import_module("models").load("hexapod").card
    text = "".join(TEXTS["servo"].format(name, n) for n, name in enumerate(card.joints))
    write(folder / "servos.yaml", mutated(text, rng))
    words = ("--format", "dynamixel", "--no-play", "--out", "walk")
    return ["export", *WALKED, *words, "--servo-table", "servos.yaml"]


def log(folder: Path, rng: random.Random) -> list[str]:
    """A gait or a robot's log, to play or to fit servos to."""
    text = ROOT.joinpath("examples", "tripods.csv").read_text()
    what = rng.choice(("", "", "measured", "posed"))  # that is fitted; both take longer
    few = 22 if what else rng.randint(9, 30)
    head, *rows = [line.split(",") for line in text.splitlines()[:few]]
    if what == "measured" or not what and rng.random() < 0.7:
        last = 2 if what else len(head)  # a joint is fitted in a second
        head += [f"measured.{name}" for name in head[1:last]]
        rows = [[*row, *row[1:last]] for row in rows]
    if what == "posed" or not what and rng.random() < 0.5:
        head += BODY
        yaw = "0" if what else ""
        rows = [[*r, f"{n / 999}", "0", yaw, "nan", "1"] for n, r in enumerate(rows)]
    text = "".join(",".join(row) + "\n" for row in (head, *rows))
    write(folder / "mine.csv", mutated(text, rng))
    if what:
        return ["fit", "hexapod", "mine.csv", "--out", "found.toml"]
    units = rng.choice(("radians", "radians", "degrees"))
    return ["play", "hexapod", "mine.csv", "--no-video", "--units", units]


def poses(folder: Path, rng: random.Random) -> list[str]:
    """Poses of a path to plan, or those that a driven robot sends."""
    if along := rng.random() < 0.5:
        text = "x,y,yaw\n" + "".join(f"{n / 99},{n / 999},0.0\n" for n in range(9))
        (folder / "mine.toml").write_text(TEXTS["along"])
    else:
        text = "\n".join(TEXTS["pose"].format(n / 9, n / 999) for n in range(20))
    write(folder / "mine.csv", mutated(text, rng))
    return ["plan", "mine.toml"] if along else ["drive", *DRIVEN.split()]


def answers(folder: Path, rng: random.Random) -> list[str]:
    """What is answered while servos are found, whose pictures are drawn already."""
    joints = import_module("models").load("hexapod-classroom").card.joints
    text = "25\n" + "".join(map(TEXTS["answer"].format, joints))
    write(folder / "told", mutated(text, rng))
    (folder / "calibration").mkdir()
    (folder / "calibration" / f"joint-{len(joints)}.png").touch()
    return ["calibrate", "hexapod-classroom", "--answers", "told"]


def run_folder(folder: Path, rng: random.Random) -> list[str]:
    """A finished run, one of whose files is mutated."""
    shutil.copytree(_made(RUN), folder / "mine")
    path = folder / "mine" / rng.choice(TEXTS["files"])
    if path.suffix == ".npz":
        change = _arrays if rng.random() < 0.7 else flipped
        path.write_bytes(change(path.read_bytes(), rng))
    else:
        change = _json if path.suffix == ".json" else mutated
        write(path, change(path.read_text(), rng))
    if rng.random() < 0.8:
        _seal(folder / "mine")
    return [*rng.choice(TEXTS["readers"]), "mine"]


def viewer(folder: Path, rng: random.Random) -> str:
    """What a browser says to the viewer; what is wrong with how its gate takes it.

    Commands pass so that they would pass again, other bytes are a `ValueError`.
    """
    commands = import_module("sim.viewing.access")
    said = b"".join(_said(rng, kind) for kind in (0, *rng.choices((0, 2, 5), k=3)))
    said = flipped(said, rng) if rng.random() < 0.8 else said
    (folder / "said").write_bytes(said)
    heard, again = commands.Commands(), commands.Commands()
    cuts = sorted(rng.randrange(len(said) + 1) for _ in range(3))
    with suppress(ValueError):
        for begin, end in pairwise((0, *cuts, len(said))):
            for command in heard.taken(said[begin:end]):
                if list(again.taken(command)) != [command]:
                    return f"a command of {len(command)} bytes passes and changes"
    return ""


FOREIGN: dict[str, Callable[[Path, random.Random], list[str] | str]] = {
    "adopt-mjcf": partial(adopted, urdf=False),
    "adopt-urdf": partial(adopted, urdf=True),
    "adopt-mesh": mesh,
    "run": run_folder,
    "viewer": viewer,
    **{k.__name__: k for k in (sweep, ledger, table, servos, log, poses, answers)},
}


def _said(rng: random.Random, kind: int) -> bytes:
    """A command of the viewer's interface: its version, an input, or a paste."""
    body = b"MuJoCo Web Viewer".ljust(112, b"\0")
    if kind == 2:
        body = struct.pack("<2H2h2f", 800, 465, 10, 20, 0.0, 0.0) + bytes(512)
        body += struct.pack("<H2x2f", rng.choice((0, 3, 256)), 1.0, 60.0)
        body = body.ljust(608, b"\0")
    elif kind == 5:
        body = struct.pack("<QQ", 8, 9) + b"pasted\0\0" * rng.randint(1, 9)
    return struct.pack("<IB3x", 8 + len(body), kind) + body


@cache
def _made(command: str) -> Path:
    """The folder `made` of what a command has done."""
    folder = Path(tempfile.mkdtemp(dir=SCRATCH.name))
    (folder / "mine.toml").write_text(SMALL["sweep"] + TEXTS["small"])
    words = [*command.split(), "--out", "made"]
    end = ending(lambda: int(import_module("sim.cli").main(words)), folder, MAKING)
    if end.code:
        raise RuntimeError(" ".join(end.warned))
    return folder / "made"


def _sealed(line: bytes, rng: random.Random) -> bytes:
    """A line of a ledger with something changed, sealed as if it had been so."""
    ledgers = import_module("sim.sweeps.ledger")
    text = _json("{" + line[ledgers.LENGTH :].decode(), rng).rstrip("\n")
    return ledgers._sealed(text.encode(errors="surrogateescape") or b"{")


def _seal(folder: Path) -> None:
    """Seal a run's files as they are, as a stranger could who knows how."""
    own = import_module("sim.runs.seals")
    parsed = import_module("models.description").parse_toml
    try:
        tables = [parsed((folder / n).read_text()) for n in ("scenario.toml", own.CARD)]
        told = {**json.loads((folder / "summary.json").read_text())}
    except (ValueError, TypeError, RecursionError):  # what cannot be read
        return
    model = {own.MODEL: own.seal(folder / own.MODEL)}
    told["seals"] = own.seals(folder, *tables, told) | model
    (folder / "summary.json").write_text(json.dumps(told))


def _json(text: str, rng: random.Random) -> str:
    """JSON with a value exchanged for another one, or mutated as text."""
    values = json.loads(text)
    if rng.random() < 0.4:
        return mutated(text, rng)
    at, key = values, rng.choice(list(values))
    while isinstance(at[key], dict | list) and at[key] and rng.random() < 0.8:
        at = at[key]
        key = rng.choice(list(at) if isinstance(at, dict) else range(len(at)))
    if rng.random() < 0.2 and isinstance(at, dict):
        del at[key]
    else:
        odd = (None, True, -1, 2**70, 1e300, float("nan"), "", "x" * 99, [], {}, [[1]])
        at[key] = rng.choice((*odd, *NASTY))
    return json.dumps(values)


def _arrays(content: bytes, rng: random.Random) -> bytes:
    """Arrays of a file, one of which has other values, another shape or type.

    A header may declare another size than there is.
    """
    with np.load(io.BytesIO(content)) as file:
        arrays = dict(file)
    name = rng.choice(list(arrays))
    old = arrays[name]
    place = rng.randrange(old.size + 1)
    with np.errstate(all="ignore"):
        arrays[name] = rng.choice(
            (
                np.full_like(old, rng.choice((np.nan, np.inf, -1, 1e300)), float),
                np.where(np.arange(old.size).reshape(old.shape) == place, np.nan, old),
                old[: rng.randrange(len(old))] if old.ndim and len(old) else old[None],
                old.astype(rng.choice((str, np.float16, np.int8, complex))),
                old.T if old.ndim > 1 else old[..., None],
                np.empty((0, *old.shape[1:]), old.dtype),
            )
        )
    if rng.random() < 0.1:
        del arrays[name]
    out = io.BytesIO()
    np.savez(out, **arrays)  # type: ignore[arg-type]
    content = out.getvalue()
    if rng.random() < 0.2:
        sizes = f"'shape': ({rng.choice(SIZES)},".encode()
        at = content.find(b"'shape': (")
        end = content.find(b",", at) + 1
        content = content[:at] + sizes.ljust(end - at) + content[end:]
    return content


def _stl() -> bytes:
    """A tetrahedron in binary."""
    faces = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
    corners = 0.1 * np.vstack([np.zeros(3), np.eye(3)])[faces]
    parts = [np.r_[np.zeros(3), c.ravel()].astype("<f4").tobytes() for c in corners]
    return bytes(80) + np.uint32(4).tobytes() + b"".join(p + b"\0\0" for p in parts)
