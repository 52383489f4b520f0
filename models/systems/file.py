"""A user's own system: one TOML file of formulas, or one Python file.

A TOML file is data; its formulas are read and never run.
A field is a table of the rates of coordinates, those not named stand still:

    state = ["x", "y", "theta"]
    goal = { y = 1 }

    [parameters]
    radius = 0.1

    [strata.0]
    roll = { x = "radius*cos(theta)", y = "radius*sin(theta)" }
    turn = { theta = 1 }

A Python file is run, like any program of the user's. It leaves a `Problem` under the
name `problem`, whose fields may be functions.
"""

from __future__ import annotations

import runpy
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import sympy as sp

from models.errors import ProblemError
from models.systems.problem import Problem
from planner import RESERVED, PlannerError, StratifiedSystem, read_formula, unknown

REQUIRED = ("state", "goal", "strata")
OPTIONAL = (
    *("description", "bottom", "gait", "elements", "start", "segments", "stance"),
    *("parameters", "limits", "level_sets"),
)
Reader = Callable[[str, object], sp.Expr]


def load_system(path: Path, values: Mapping[str, object] | None = None) -> Problem:
    """Read a system and its problem from a file.

    Args:
        path: A `.toml` or `.py` file.
        values: Parameters that replace the file's.

    Raises:
        ProblemError: It cannot be read, or what it says is impossible.
        OSError: The file cannot be opened.
    """
    source = path.read_bytes()
    try:
        if path.suffix == ".py":
            return _run(path, values or {})
        return _decode(path.stem, tomllib.loads(source.decode()), values or {})
    except (ValueError, PlannerError) as error:
        raise ProblemError(f"bad system: {path}; {error}") from error


def _run(path: Path, values: Mapping[str, object]) -> Problem:
    if values:
        raise ValueError("a Python file has no parameters to set; change them in it")
    try:
        problem = runpy.run_path(str(path)).get("problem")
    except Exception as error:
        raise ValueError(f"it ends with {type(error).__name__}: {error}") from error
    if not isinstance(problem, Problem):
        raise ValueError(
            "it leaves no models.systems.problem.Problem named `problem`; make one"
        )
    return problem


def _decode(
    name: str, table: Mapping[str, Any], values: Mapping[str, object]
) -> Problem:
    _require_keys(table)
    system = _system(table, _table(table, "parameters"), values)
    return Problem(
        name=name,
        description=_text(table.get("description", ""), "description"),
        system=system,
        gait=_names(table, "gait") or _gait(system),
        elements=_names(table, "elements"),
        start=_numbers(_table(table, "start"), "start"),
        goal=_numbers(_table(table, "goal"), "goal"),
        segments=_whole(table.get("segments", 1)),
        limits={key: _span(key, v) for key, v in _table(table, "limits").items()},
        stance=_text(table.get("stance", "paper"), "stance"),
    )


def _require_keys(table: Mapping[str, Any]) -> None:
    for key in REQUIRED:
        if key not in table:
            raise ValueError(f"{key} is missing; give {', '.join(REQUIRED)}")
    for key in table:
        if key not in REQUIRED + OPTIONAL:
            raise ValueError(f"key {key!r} {unknown(key, REQUIRED + OPTIONAL)}")


def _system(
    table: Mapping[str, Any],
    parameters: Mapping[str, Any],
    values: Mapping[str, object],
) -> StratifiedSystem:
    for key in values:
        if key not in parameters:
            raise ValueError(f"parameter {key!r} {unknown(key, parameters)}")
    state = tuple(sp.Symbol(name, real=True) for name in _names(table, "state"))
    formula = _reader(state, _numbers({**parameters, **values}, "parameters"))
    strata = {
        stratum: {
            name: _field(f"field {name}", rates, state, formula)
            for name, rates in _table(table["strata"], stratum, "stratum ").items()
        }
        for stratum in _table(table, "strata")
    }
    level_sets = {
        stratum: tuple(formula(f"level set of S{stratum}", f) for f in functions)
        for stratum in _table(table, "level_sets")
        for functions in [_list(table["level_sets"], stratum)]
    }
    bottom = str(table.get("bottom", next(iter(strata), "")))
    return StratifiedSystem(state, strata, bottom, level_sets)


def _reader(state: tuple[sp.Symbol, ...], parameters: Mapping[str, float]) -> Reader:
    """Reads formulas over the state, with numbers for the parameters."""
    for name in parameters:
        if name in map(str, state):
            raise ValueError(f"{name} is a parameter and a coordinate; rename one")
        if name in RESERVED:
            raise ValueError(f"{name} is a parameter, but formulas use it; rename it")

    def formula(what: str, text: object) -> sp.Expr:
        if isinstance(text, bool) or not isinstance(text, str | int | float):
            raise ValueError(f"{what} has {text!r}; write a number or a formula")
        try:
            return read_formula(text, state, parameters)
        except ValueError as error:
            raise ValueError(f"{what}: {error}") from error

    return formula


def _field(
    what: str, rates: object, state: tuple[sp.Symbol, ...], formula: Reader
) -> list[sp.Expr]:
    names = tuple(map(str, state))
    if not isinstance(rates, dict):
        raise ValueError(f"{what} is {rates!r}; give rates, as in {{ {names[0]} = 1 }}")
    for name in rates:
        if name not in names:
            raise ValueError(f"{what} moves {name}, which {unknown(name, names)}")
    return [formula(what, rates.get(name, 0)) for name in names]


def _gait(system: StratifiedSystem) -> tuple[str, ...]:
    """From the bottom stratum to each of its neighbours in turn, and back."""
    bottom = system.bottom
    return (bottom, *(s for near in system.neighbours[bottom] for s in (near, bottom)))


def _table(table: Mapping[str, Any], key: str, kind: str = "") -> Mapping[str, Any]:
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise ValueError(f"{kind}{key} is {value!r}; make it a table")
    return value


def _list(table: Mapping[str, Any], key: str) -> list[Any]:
    value = table.get(key, [])
    if not isinstance(value, list):
        raise ValueError(f"{key} is {value!r}; make it a list")
    return value


def _names(table: Mapping[str, Any], key: str) -> tuple[str, ...]:
    names = _list(table, key)
    if not all(isinstance(name, str) for name in names):
        raise ValueError(f"{key} is {names}; make it a list of texts")
    return tuple(names)


def _text(value: object, key: str) -> Any:
    if not isinstance(value, str):
        raise ValueError(f"{key} is {value!r}; give a text")
    return value


def _numbers(table: Mapping[str, Any], what: str) -> dict[str, float]:
    for key, value in table.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{what}: {key} is {value!r}; give a number")
    return dict(table)


def _span(name: str, value: object) -> tuple[float, float]:
    match value:
        case [int() | float() as low, int() | float() as high]:
            return (low, high)
    raise ValueError(f"limits: {name} is {value!r}; give [lowest, highest]")


def _whole(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"segments is {value!r}; give a whole number")
    return value
