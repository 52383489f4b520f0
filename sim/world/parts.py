"""Settings of a specification's parts: copied, and free of the defaults of a file."""

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

OWN = {"classname", "info", "name"}  # what each part has of its own


def copy_settings(part: Any, other: Any) -> None:
    """Set a part as another of its kind."""
    members = vars(type(part)).items()
    settings = {name for name, member in members if getattr(member, "fset", None)}
    for name in settings - OWN:
        setattr(part, name, getattr(other, name))


def fixed_geoms(model: mujoco.MjModel) -> Iterator[str]:
    """Names of geoms that do not move."""
    for geom in np.flatnonzero(model.body_weldid[model.geom_bodyid] == 0):
        yield model.geom(geom).name


def forget_defaults(spec: mujoco.MjSpec) -> None:
    """Make parts that are added hereafter as the engine has them.

    Parts that are there keep what the file's defaults have given them.
    """
    plain = mujoco.MjSpec().default
    for kind in ("actuator", "geom", "joint", "light", "material", "mesh"):
        copy_settings(getattr(spec.default, kind), getattr(plain, kind))
