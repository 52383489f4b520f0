"""Inspection of a user's model before it is read: size, numbers, and files it opens.

A line of MJCF that copies or refines parts often enough keeps MuJoCo busy for minutes
and fills gigabytes, and the compilation cannot be interrupted. A separate process
therefore compiles the model first; it is ended if it exceeds its limits.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

from models.description.files import Opened, outside
from models.errors import ModelError

SECONDS = 30
MEMORY = 4 * 10**9  # bytes
ROOT = Path(__file__).resolve().parents[2]
TRIAL = "models.description.trial"
SHOWN = 3  # files that a message names


def inspect_model(
    path: Path, others: tuple[Path, ...] = (), allow_external: bool = False
) -> Opened:
    """Make sure that a model may be read; costs the start of a process.

    Args:
        path: Its MJCF.
        others: Further files that belong to it.
        allow_external: Whether it may open files that are not in its own folder.

    Returns:
        The files that it opens.

    Raises:
        ModelError: If it is too large, cannot be compiled, has numbers that are not
            finite, or opens files that it may not.
    """
    files = {Path(file) for file in _tried(path)}
    taken = outside((files | set(others)) - {path}, path.parent)
    if taken and not allow_external:
        named = ", ".join(map(str, taken[:SHOWN]))
        more = f" and {len(taken) - SHOWN} more" if len(taken) > SHOWN else ""
        raise ModelError(
            f"it opens files outside its own folder: {path}; {named}{more}; move them "
            "there, or give --allow-external if you trust it"
        )
    return Opened(tuple(sorted(files | {path})), tuple(taken))


def _tried(path: Path) -> list[str]:
    """The files that a model opens, as the process that compiled it says."""
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-m", TRIAL, str(path), str(SECONDS), str(MEMORY)],
            env=_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=SECONDS,
        )
    except subprocess.TimeoutExpired:
        raise _too_large(path) from None
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        raise _too_large(path)
    lines = done.stdout.decode(errors="replace").splitlines()
    if done.returncode or not lines:
        raise ModelError(
            f"MuJoCo's compiler crashes on it: {path}; leave parts out until it "
            "compiles"
        )
    said = json.loads(lines[-1])
    if "large" in said:
        raise _too_large(path)
    if "wrong" in said:
        raise ModelError(said["wrong"])
    return list(said["files"])


def _environment() -> dict[str, str]:
    """No pictures, one thread, and this code whatever else is installed."""
    paths = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    quick = {"MUJOCO_GL": "disabled", "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **quick, "PYTHONPATH": paths}


def _too_large(path: Path) -> ModelError:
    return ModelError(
        f"too large: {path}; it takes more than {SECONDS} s or {MEMORY // 10**9} GB to "
        "compile, leave parts out"
    )
