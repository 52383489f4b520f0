"""`stratawalk doctor`: what works on this machine, and how to repair what does not."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass

from sim.errors import ExitCode, RenderError, one_line

HELP = "say what works here: physics, pictures, films and figures"
STEPS = 2000  # of the default robot, a tenth of a second or less
MUJOCO = "mujoco==4.0.0"
REINSTALL = f"{sys.executable} -m pip install --force-reinstall"


@dataclass(frozen=True)
class Finding:
    """What one check found.

    Attributes:
        works: Whether this part of stratawalk works here.
        detail: What it uses and how fast that is, or what is wrong.
        repair: The command that repairs it; None where nothing is to be done.
    """

    works: bool
    detail: str
    repair: str | None = None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command; there are none of its own."""


def execute(options: argparse.Namespace) -> int:
    """Check every part; ends with 0 if all work, else with the code of the first."""
    findings = {name: _examined(check) for name, (check, _) in CHECKS.items()}
    if options.json:
        print(json.dumps({name: asdict(found) for name, found in findings.items()}))
    else:
        for name, found in findings.items():
            print(_line(name, "works" if found.works else "fails", found.detail))
            if found.repair:
                print(_line("", "repair", found.repair))
    codes = (code for name, (_, code) in CHECKS.items() if not findings[name].works)
    return next(codes, ExitCode.OK)


def _line(name: str, verdict: str, detail: str) -> str:
    return f"{name:11}{verdict:8}{detail}"


def _examined(check: Callable[[], str]) -> Finding:
    """A check's finding, whatever it stumbles over."""
    try:
        return Finding(True, check())
    except RenderError as error:
        return Finding(False, f"{error.what}: {error.where}", error.remedy)
    except ImportError as error:
        package = str(error.name or "").partition(".")[0] or "stratawalk"
        return Finding(False, str(error), f"{REINSTALL} {package}")
    except Exception as error:  # whatever it is, the doctor goes on to the next part
        return Finding(False, one_line(error), f"{REINSTALL} {MUJOCO}")


def _physics() -> str:
    import time

    import mujoco

    from models import load

    model = mujoco.MjModel.from_xml_path(str(load("hexapod").path))
    data = mujoco.MjData(model)
    began = time.perf_counter()
    mujoco.mj_step(model, data, nstep=STEPS)
    speed = STEPS / (time.perf_counter() - began)
    return f"MuJoCo {mujoco.__version__}, {speed:,.0f} steps a second"


def _rendering() -> str:
    from sim.pictures.gl import probe
    from sim.pictures.style import HEIGHT, WIDTH
    from sim.pictures.trial import pictures_per_second

    driver = probe()
    speed = pictures_per_second(driver)
    return f"{driver}, {speed:.0f} pictures a second of {WIDTH} x {HEIGHT}"


def _film() -> str:
    from imageio_ffmpeg import get_ffmpeg_version

    from sim.pictures.file import CODEC, check_encoder

    check_encoder()
    return f"ffmpeg {get_ffmpeg_version()} with {CODEC}"


def _figures() -> str:
    from io import BytesIO

    import matplotlib as mpl
    from matplotlib.figure import Figure

    figure = Figure()
    figure.subplots().plot([0, 1])
    figure.savefig(BytesIO(), format="svg")
    return f"Matplotlib {mpl.__version__}"


CHECKS = {
    "physics": (_physics, ExitCode.SIMULATION),
    "rendering": (_rendering, ExitCode.RENDER),
    "film": (_film, ExitCode.RENDER),
    "figures": (_figures, ExitCode.RENDER),
}
