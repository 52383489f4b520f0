"""The versions of the software that produced a run's numbers."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("stratawalk", "mujoco", "numpy", "scipy", "sympy", "shapely")


def versions() -> dict[str, str]:
    """Versions of this package, of those that it computes with, and of Python."""
    return dict(_found())


@cache
def _found() -> dict[str, str]:
    found = {name: _version(name) for name in PACKAGES}
    return found | {"python": platform.python_version(), "system": platform.platform()}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from a checkout that is not installed
        return "not installed"
