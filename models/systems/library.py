"""The shipped systems by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import get_type_hints

from models.errors import UnknownSystemError
from models.systems import fingers, legged, smooth
from models.systems.problem import Problem
from planner.errors import unknown

SYSTEMS: Mapping[str, Callable[..., Problem]] = {
    "paper-hexapod": legged.hexapod,
    "biped": legged.biped,
    "quadruped-crawl": legged.quadruped,
    "octopod-pairs": legged.octopod,
    "hexapod-trailer": legged.hexapod_with_trailer,
    "finger-gaiting": fingers.finger_gaiting,
    "unicycle": smooth.unicycle,
    "car": smooth.car,
    "car-trailers": smooth.car_with_trailers,
    "heisenberg": smooth.heisenberg,
    "brockett": smooth.brockett,
    "engel": smooth.engel,
    "chained": smooth.chained,
}
"""What makes each problem; its keyword arguments are the system's parameters."""


def parameters(name: str) -> dict[str, object]:
    """The parameters of a shipped system and their defaults.

    Raises:
        UnknownSystemError: There is no such system.
    """
    signature = inspect.signature(_maker(name))
    return {key: value.default for key, value in signature.parameters.items()}


def shipped(name: str, values: Mapping[str, object] | None = None) -> Problem:
    """A shipped system and its problem.

    Args:
        name: Name of the system.
        values: Parameters that are not to have their defaults.

    Raises:
        UnknownSystemError: There is no such system.
        ValueError: A parameter is unknown or impossible.
    """
    known = get_type_hints(_maker(name))
    for key, value in (values or {}).items():
        if key not in parameters(name):
            raise ValueError(f"parameter {key!r} {_known(parameters(name), key)}")
        if not _fits(value, known[key]):
            kind = "true or false" if known[key] is bool else "a number"
            kind = "a whole number" if known[key] is int else kind
            raise ValueError(f"parameter {key} is {value!r}; give {kind}")
    return _maker(name)(**(values or {}))


def _maker(name: str) -> Callable[..., Problem]:
    if name not in SYSTEMS:
        raise UnknownSystemError(f"system {name!r} {unknown(name, SYSTEMS)}")
    return SYSTEMS[name]


def _known(names: Mapping[str, object], key: str) -> str:
    return unknown(key, names) if names else "is unknown; the system has none"


def _fits(value: object, kind: object) -> bool:
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    return isinstance(value, int if kind is int else int | float)
