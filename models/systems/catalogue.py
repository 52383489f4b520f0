"""The shipped systems by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import get_type_hints

from models.errors import ProblemError
from models.systems import legged, smooth
from models.systems.problem import Problem
from planner.support import unknown

SYSTEMS: Mapping[str, Callable[..., Problem]] = {
    "paper-hexapod": legged.paper_hexapod,
    "biped": legged.biped,
    "quadruped-crawl": legged.quadruped,
    "octopod-pairs": legged.octopod,
    "hexapod-trailer": legged.hexapod_with_trailer,
    "finger-gaiting": legged.finger_gaiting,
    "unicycle": smooth.unicycle,
    "car": smooth.car,
    "car-trailers": smooth.car_with_trailers,
    "heisenberg": smooth.heisenberg,
    "brockett": smooth.brockett,
    "engel": smooth.engel,
    "chained": smooth.chained,
}
"""Function that makes each problem; its arguments are the system's parameters.

Example:
    >>> from models import SYSTEMS
    >>> SYSTEMS["unicycle"]().goal
    {'y': 1}
"""

KINDS: Mapping[object, str] = {bool: "true or false", int: "a whole number"}


def parameters(name: str) -> dict[str, object]:
    """The parameters of a shipped system and their defaults."""
    signature = inspect.signature(_maker(name))
    return {key: value.default for key, value in signature.parameters.items()}


def shipped_system(name: str, values: Mapping[str, object] | None = None) -> Problem:
    """A shipped system and its problem.

    Args:
        name: Name of the system.
        values: Parameters that are not to have their defaults.

    Raises:
        ProblemError: There is no such system, or a parameter is unknown or impossible.

    Example:
        >>> from models import shipped_system
        >>> shipped_system("finger-gaiting", {"fingers": 4}).gait[0]
        '1234'
    """
    values = values or {}
    maker, defaults = _maker(name), parameters(name)
    kinds = get_type_hints(maker)
    try:
        for key, value in values.items():
            if key not in defaults:
                none = "is unknown; it has none"
                raise ValueError(
                    f"{key} {unknown(key, defaults) if defaults else none}"
                )
            if not _fits(value, kinds[key]):
                kind = KINDS.get(kinds[key], "a number")
                raise ValueError(f"{key} is {value!r}; give {kind}")
        return maker(**values)
    except ValueError as error:
        raise ProblemError(f"bad parameters of {name}: {error}") from error


def _maker(name: str) -> Callable[..., Problem]:
    if name not in SYSTEMS:
        raise ProblemError(f"system {name!r} {unknown(name, SYSTEMS)}")
    return SYSTEMS[name]


def _fits(value: object, kind: object) -> bool:
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    return isinstance(value, int if kind is int else int | float)
