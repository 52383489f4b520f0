"""The versions of the software that produced a run's numbers."""

import platform
from collections.abc import Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version

PACKAGES = (
    *("stratawalk", "mujoco", "numpy", "scipy", "sympy", "shapely"),
    *("casadi", "ompl"),  # whose solvers optimise plans and find ways around obstacles
)


@cache
def versions() -> Mapping[str, str]:
    """Versions of this package, of those that it computes with, and of Python."""
    found = dict.fromkeys(PACKAGES, "not installed")  # as in a checkout
    for name in PACKAGES:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found | {"python": platform.python_version(), "system": platform.platform()}
