"""`stratawalk doctor` and `bench`: what works on this machine, and how fast.

Packages are compared with the versions that `scripts/constraints*.txt` pin, or with our
requirements outside a checkout, and their files with the hashes that pip wrote down.
"""

import argparse
import csv
import hashlib
import os
import subprocess
import sys
import time
from base64 import urlsafe_b64encode
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from shlex import quote
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, NamedTuple

from sim.commands import options as cli
from sim.errors import ROOT, ExitCode, FilesError, RenderError, UsageError, one_line
from sim.progress import bar, stage

if TYPE_CHECKING:
    from packaging.requirements import Requirement

PICTURES = 3  # of a film to try
PROBE_STEPS = 2000  # of the default robot, a tenth of a second or less
SHOWN = 3  # differences of packages
MUJOCO = "mujoco==4.0.0"
REINSTALL = f"{sys.executable} -m pip install --force-reinstall"
PINS = ROOT / "scripts"
IS_CHECKOUT = (ROOT / "pyproject.toml").is_file()
OWN = f"--editable {quote(str(ROOT))}" if IS_CHECKOUT else "CHECKOUT"


@dataclass(frozen=True)
class Finding:
    """What one check found."""

    works: bool
    detail: str  # what it uses and how fast that is, or what is wrong
    repair: str | None = None  # the command that repairs it


class Check(NamedTuple):
    """One part of stratawalk that is tried."""

    look: Callable[[], str]  # tries it, and says what it uses
    code: ExitCode  # if it does not work
    package: str  # to install anew if nothing better is known


def doctor(options: argparse.Namespace) -> ExitCode:
    """Check every part; ends with 0 if all work, else with the code of the first."""
    findings, lines = {}, []
    with bar(quiet=options.json) as progress:
        for name, check in CHECKS.items():
            with stage(progress, f"trying {name}"):
                findings[name] = _examined(check)
    for name, found in findings.items():
        lines.append(f"{name:11}{'works' if found.works else 'fails':8}{found.detail}")
        if found.repair:
            lines.append(f"{'':11}{'repair':8}{found.repair}")
    cli.report(options, {key: asdict(one) for key, one in findings.items()}, *lines)
    codes = (check.code for name, check in CHECKS.items() if not findings[name].works)
    return next(codes, ExitCode.OK)


def _examined(check: Check) -> Finding:
    """A check's finding, whatever it stumbles over."""
    try:
        return Finding(True, check.look())
    except (RenderError, FilesError) as error:
        return Finding(False, f"{error.what}: {error.where}", error.remedy)
    except ImportError as error:
        package = str(error.name or "sim").partition(".")[0]
        package = OWN if package in ("planner", "models", "sim") else package
        return Finding(False, str(error), f"{REINSTALL} {package}")
    except Exception as error:  # whatever it is, the doctor goes on to the next part
        return Finding(False, one_line(error), f"{REINSTALL} {check.package}")


def _physics() -> str:
    import mujoco

    from models import load

    model = mujoco.MjModel.from_xml_path(str(load("hexapod").path))
    data = mujoco.MjData(model)
    began = time.perf_counter()
    mujoco.mj_step(model, data, nstep=PROBE_STEPS)
    speed = PROBE_STEPS / (time.perf_counter() - began)
    return f"MuJoCo {mujoco.__version__}, {speed:,.0f} steps a second"


def _rendering() -> str:
    from sim.pictures.camera import HEIGHT, WIDTH
    from sim.pictures.gl import pictures_per_second, probe

    driver = probe()
    speed = pictures_per_second(driver)
    return f"{driver}, {speed:.0f} pictures a second of {WIDTH} x {HEIGHT}"


def _film() -> str:
    import numpy as np
    from imageio_ffmpeg import get_ffmpeg_version

    from sim.pictures import file

    file.check_encoder()
    with TemporaryDirectory() as scratch:
        film = Path(scratch) / "film.mp4"
        with file.encoding(film) as append:
            for _ in range(PICTURES):
                append(np.zeros((64, 64, 3), np.uint8))
        if (n := file.count_pictures(film)) != PICTURES:
            raise RenderError(f"{n} of {PICTURES} pictures", file.CODEC, file.INSTALL)
    return f"ffmpeg {get_ffmpeg_version()} with {file.CODEC}"


def _figures() -> str:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots().plot([0, 1])
    figure.savefig(BytesIO(), format="svg")
    return f"Matplotlib {mpl.__version__}"


def _report() -> str:
    import jinja2

    from sim.reports.page import NAME
    from sim.templates import template

    template(NAME)
    return f"Jinja2 {jinja2.__version__}, {NAME} of every run"


def _packages() -> str:
    if differ := list(differences()):
        wrong = ", ".join(what for _, what in differ[:SHOWN])
        more = f", and {len(differ) - SHOWN} more" if differ[SHOWN:] else ""
        anew = " ".join(f"'{wanted}'" for wanted in dict(differ))
        anew = anew.replace("'stratawalk'", OWN)  # which no index has
        raise FilesError(wrong + more, "packages", f"{REINSTALL} --no-deps {anew}")
    return "versions as wanted, every file as its package lists it"


def differences() -> Iterator[tuple[str, str]]:
    """What is wanted, and what is there instead, of packages that are installed."""
    for wanted in _wanted():
        if wanted.name == "setuptools":  # never loaded
            continue
        try:
            found = distribution(wanted.name)
        except PackageNotFoundError:  # of an extra, or somebody finds out at once
            continue
        name = f"{wanted.name}{wanted.specifier}"
        if not wanted.specifier.contains(found.version, prereleases=True):
            yield name, f"{wanted.name} {found.version}, wanted {wanted.specifier}"
        for path in _changed(found):
            yield name, f"{path} is not as it was installed"


def _wanted() -> "list[Requirement]":
    """What the constraints pin, or the package requires where there are none."""
    from packaging.requirements import Requirement

    texts = [path.read_text("utf-8") for path in PINS.glob("constraints*.txt")]
    lines = [line for text in texts for line in text.splitlines() if "==" in line[:99]]
    if not texts:
        lines = distribution("stratawalk").requires or []
    wanted = (Requirement(line.removesuffix("\\")) for line in [*lines, "stratawalk"])
    return [w for w in wanted if w.marker is None or w.marker.evaluate({"extra": ""})]


def _changed(found: Distribution) -> Iterator[Path]:
    """Files of a package that are gone, or are not what their hashes say."""
    try:
        text = found.read_text("RECORD") or ""  # `files` leaves out what is gone
        rows = [*csv.reader(text.splitlines(), strict=True)]
    except (ValueError, csv.Error):  # of other text
        rows = []
    if {*map(len, rows)} != {3}:
        yield Path(f"the list of files of {found.name}")
    for name, sealed, *_ in (row for row in rows if len(row) > 1):
        kind, _, wanted = sealed.partition("=")
        if not wanted or name.startswith(".."):  # programs name their Python
            continue
        path = Path(str(found.locate_file(name)))
        try:
            digest = hashlib.new(kind, path.read_bytes()).digest()
        except (OSError, ValueError, TypeError):  # or no hash that is known
            digest = b""
        if urlsafe_b64encode(digest).rstrip(b"=") != wanted.encode():
            yield path


CHECKS = {
    "physics": Check(_physics, ExitCode.SIMULATION, MUJOCO),
    "rendering": Check(_rendering, ExitCode.RENDER, "pyopengl"),
    "film": Check(_film, ExitCode.RENDER, "imageio-ffmpeg"),
    "figures": Check(_figures, ExitCode.RENDER, "matplotlib"),
    "report": Check(_report, ExitCode.RENDER, "jinja2"),
    "packages": Check(_packages, ExitCode.FILES, "packaging"),  # with which it reads
}


def bench(options: argparse.Namespace) -> None:
    """Print every measurement when it is done."""
    if options.peers:
        if not (ROOT / "scripts" / "planner_table.py").is_file():  # in a checkout only
            raise UsageError.of("peers", "bench --peers")
        for package in ("casadi", "ompl"):
            if find_spec(package) is None:
                raise ModuleNotFoundError(name=package)
        words = ["-m", "scripts.planner_table", *["--json"] * options.json]
        env = os.environ | {"PYTHONPATH": str(ROOT)}
        subprocess.run([sys.executable, *words], cwd=ROOT, env=env, check=True)
        return
    if options.sweeps:
        from sim.bench.sweep_speed import measure
    else:
        from sim.bench.speed import measure
    rows = measure()
    if options.json:
        cli.report(options, [asdict(row) for row in rows])
        return
    for row in rows:
        print(row, flush=True)
