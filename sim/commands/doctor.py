"""`stratawalk doctor`: what works on this machine, and how to repair what does not."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.commands.options import report
from sim.errors import ExitCode, FilesError, RenderError, one_line

OPTIONS = ()
HELP = "say what works here: physics, pictures, films, reports, installed packages"
PICTURES = 3  # of a film to try
PROBE_STEPS = 2000  # of the default robot, a tenth of a second or less
SHOWN = 3  # differences of packages
MUJOCO = "mujoco==4.0.0"
REINSTALL = f"{sys.executable} -m pip install --force-reinstall"


@dataclass(frozen=True)
class Finding:
    """What one check found."""

    works: bool
    detail: str  # what it uses and how fast that is, or what is wrong
    repair: str | None = None  # the command that repairs it


@dataclass(frozen=True)
class Check:
    """One part of stratawalk that is tried."""

    look: Callable[[], str]  # tries it, and says what it uses
    code: ExitCode  # if it does not work
    package: str  # to install anew if nothing better is known


def execute(options: argparse.Namespace) -> int:
    """Check every part; ends with 0 if all work, else with the code of the first."""
    from sim.progress import bar, stage

    findings = {}
    with bar(quiet=options.json) as progress:
        for name, check in CHECKS.items():
            with stage(progress, f"trying {name}"):
                findings[name] = _examined(check)
    lines = []
    for name, found in findings.items():
        lines.append(f"{name:11}{'works' if found.works else 'fails':8}{found.detail}")
        if found.repair:
            lines.append(f"{'':11}{'repair':8}{found.repair}")
    report(options, {key: asdict(one) for key, one in findings.items()}, *lines)
    codes = (check.code for name, check in CHECKS.items() if not findings[name].works)
    return next(codes, ExitCode.OK)


def _examined(check: Check) -> Finding:
    """A check's finding, whatever it stumbles over."""
    try:
        return Finding(True, check.look())
    except (RenderError, FilesError) as error:
        return Finding(False, f"{error.what}: {error.where}", error.remedy)
    except ImportError as error:
        package = str(error.name or "").partition(".")[0] or "stratawalk"
        return Finding(False, str(error), f"{REINSTALL} {package}")
    except Exception as error:  # whatever it is, the doctor goes on to the next part
        return Finding(False, one_line(error), f"{REINSTALL} {check.package}")


def _physics() -> str:
    import time

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
        if (found := file.count_pictures(film)) != PICTURES:
            what = f"{found} of {PICTURES} pictures"
            raise RenderError(what, file.CODEC, file.INSTALL)
    return f"ffmpeg {get_ffmpeg_version()} with {file.CODEC}"


def _figures() -> str:
    from io import BytesIO

    import matplotlib as mpl
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots().plot([0, 1])
    figure.savefig(BytesIO(), format="svg")
    return f"Matplotlib {mpl.__version__}"


def _report() -> str:
    import jinja2

    from sim.reports.page import NAME
    from sim.reports.templates import template

    template(NAME)
    return f"Jinja2 {jinja2.__version__}, {NAME} of every run"


def _packages() -> str:
    from sim.packages import differences

    if differ := list(differences()):
        said = ", ".join(what for _, what in differ[:SHOWN])
        more = f", and {len(differ) - SHOWN} more" if differ[SHOWN:] else ""
        anew = " ".join(f"'{wanted}'" for wanted in dict(differ))
        remedy = f"{REINSTALL} --no-deps {anew}"
        raise FilesError(said + more, "packages", remedy)
    return "of the wanted versions, every file as it was installed"


CHECKS = {
    "physics": Check(_physics, ExitCode.SIMULATION, MUJOCO),
    "rendering": Check(_rendering, ExitCode.RENDER, "pyopengl"),
    "film": Check(_film, ExitCode.RENDER, "imageio-ffmpeg"),
    "figures": Check(_figures, ExitCode.RENDER, "matplotlib"),
    "report": Check(_report, ExitCode.RENDER, "jinja2"),
    "packages": Check(_packages, ExitCode.FILES, "stratawalk"),
}
