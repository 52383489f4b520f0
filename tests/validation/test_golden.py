"""The same walk has the same bytes, on one kind of machine and engine.

On another kind of processor the linear algebra rounds otherwise, and the end of a walk
differs by some 1e-8 m; so each kind has a sum of its own. Where a change is meant to
alter walks, write the new sums down.
"""

import ctypes
import hashlib
import platform
from pathlib import Path

import mujoco
import numpy as np
import pytest

WIDE = "693391b7d25b1d5332f8d95990293bcee7342ee32098d726fc3fb3176363fdae"
NARROW = "7b909fc9ce5c596c73f6dd03594c62411c76c41fe458b7c9fc6630e8abff3953"
GOLDEN = {
    ("4.0.0", "x86_64 avx512f SkylakeX"): WIDE,
    ("4.0.0", "x86_64 avx512f Cooperlake"): WIDE,
    ("4.0.0", "x86_64 avx512f SapphireRapids"): WIDE,
    ("4.0.0", "x86_64 avx512f Haswell"): NARROW,
    ("4.0.0", "x86_64 avx512f Zen"): NARROW,
}
"""Sums of the states of the session's short walk, by engine and processor."""


def kernels():
    """What numpy's linear algebra takes the processor for, if it is OpenBLAS."""
    libraries = Path(np.__file__).parents[1].glob("numpy.libs/*openblas*")
    for library in map(ctypes.CDLL, map(str, libraries)):
        name = library.scipy_openblas_get_corename64_
        name.restype = ctypes.c_char_p
        return name().decode()
    return "unknown"


def processor():
    """What decides how numpy rounds: architecture, widest registers, kernels."""
    info = Path("/proc/cpuinfo")
    flags = set(info.read_text().split()) if info.exists() else set()
    widest = next((f for f in ("avx512f", "avx2") if f in flags), "plain")
    return f"{platform.machine()} {widest} {kernels()}"


@pytest.mark.physics
def test_a_walk_has_the_bytes_that_it_always_had(walked):
    kind = (mujoco.__version__, processor())
    with np.load(walked / "trajectory.npz") as file:
        found = hashlib.sha256(file["qpos"].tobytes() + file["qvel"].tobytes())
    if kind not in GOLDEN:
        pytest.skip(f"no sum for {kind}; it is {found.hexdigest()}")
    assert found.hexdigest() == GOLDEN[kind]
