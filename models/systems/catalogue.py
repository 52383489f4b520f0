"""Systems shipped by name, and those of users: a file of formulas, or of Python.

A TOML file is data, as are shipped ones beside this module; its formulas are parsed and
never executed. A field is a table of the rates of coordinates; those that it does not
name stand still. A Python file is executed like any program of the user. It must define
a `Problem` under the name `problem`; the fields of its system may be functions.
"""

import inspect
import runpy
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, cast, get_type_hints

import sympy as sp

from models.description.table import Table, parse_toml
from models.errors import ProblemError, message
from models.systems import legged, smooth
from models.systems.problem import Problem, Words
from planner import PlannerError, StratifiedSystem
from planner.execution import StanceRule
from planner.planning import FlatOutputs
from planner.support import read_file, read_text, require_known, unknown
from planner.systems import MOST_NAMES, RESERVED, read_formula

FOLDER = Path(__file__).parent  # with the shipped systems that are files


def _content(name: str) -> dict[str, Any]:
    return parse_toml((FOLDER / f"{name}.toml").read_text("utf-8"))


def _of_file(name: str, **values: object) -> Problem:
    return _decode(name, _content(name), values)


SYSTEMS: Mapping[str, Callable[..., Problem]] = {
    "paper-hexapod": legged.paper_hexapod,
    "biped": legged.biped,
    "quadruped-crawl": legged.quadruped,
    "octopod-pairs": legged.octopod,
    "hexapod-trailer": legged.hexapod_with_trailer,
    "finger-gaiting": legged.finger_gaiting,
    "unicycle": partial(_of_file, "unicycle"),
    "car": partial(_of_file, "car"),
    "car-trailers": smooth.car_with_trailers,
    "heisenberg": partial(_of_file, "heisenberg"),
    "brockett": partial(_of_file, "brockett"),
    "engel": partial(_of_file, "engel"),
    "chained": smooth.chained,
}
"""Function that makes each problem; its arguments are the system's parameters.

Example:
    >>> from models import SYSTEMS
    >>> SYSTEMS["unicycle"]().goal
    {'y': 1.0}
"""

KINDS: Mapping[object, str] = {bool: "true or false", int: "a whole number"}


def parameters(name: str) -> dict[str, object]:
    """The parameters of a shipped system and their defaults."""
    maker = _maker(name)
    if isinstance(maker, partial):
        return dict(_content(name).get("parameters", {}))
    return {k: v.default for k, v in inspect.signature(maker).parameters.items()}


def shipped_system(name: str, values: Mapping[str, object] | None = None) -> Problem:
    """A shipped system and its problem.

    Args:
        name: Name of the system.
        values: Parameters that replace their defaults.

    Raises:
        ProblemError: There is no such system, or a parameter is unknown or impossible.

    Example:
        >>> from models import shipped_system
        >>> shipped_system("finger-gaiting", {"fingers": 4}).gait[0]
        '1234'
    """
    values, maker, defaults = values or {}, _maker(name), parameters(name)
    kinds = {} if isinstance(maker, partial) else get_type_hints(maker)
    try:
        for key, value in values.items():
            if key not in defaults:
                what = unknown(key, defaults) if defaults else "is unknown; it has none"
                raise ValueError(f"{key} {what}")
            if not _fits(value, kinds.get(key)):
                kind = KINDS.get(kinds.get(key), "a number")
                raise ValueError(f"{key} is {value!r}; give {kind}")
        return maker(**values)
    except ValueError as error:
        raise ProblemError(f"bad parameters of {name}: {error}") from error


def _maker(name: str) -> Callable[..., Problem]:
    require_known(f"system {name!r}", name, SYSTEMS, ProblemError)
    return SYSTEMS[name]


def _fits(value: object, kind: object) -> bool:
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    return isinstance(value, int if kind is int else int | float)


KEYS = (
    *("state", "goal", "strata"),  # without which there is no system
    *("description", "bottom", "gait", "elements", "start", "segments", "stance"),
    *("degree", "words", "flat", "hitches"),
    *("parameters", "limits", "level_sets", "metric", "lifts"),
)
FLAT = ("along", "across", "rate", "slope")
Reader = Callable[[str, object], sp.Expr]


def load_system(
    path: Path | str, values: Mapping[str, object] | None = None
) -> Problem:
    """Read a system and its problem from a file.

    Args:
        path: A `.toml` or `.py` file.
        values: Parameters that replace the file's.

    Raises:
        ProblemError: It cannot be read, or what it says is impossible.

    Example:
        >>> from importlib.resources import files
        >>> from models import load_system
        >>> load_system(files("models") / "systems" / "unicycle.toml").elements
        ('drive', 'turn', '[drive,turn]')
    """
    path = Path(path)
    try:
        if path.suffix == ".py":
            return _run(path, values or {})
        return _decode(path.stem, parse_toml(read_text(path)), values or {})
    except (ValueError, PlannerError) as error:
        raise ProblemError(f"bad system: {path}; {error}") from error
    except OSError as error:
        gone = isinstance(error, FileNotFoundError)
        what = "no such system file" if gone else f"cannot be read, {error.strerror}"
        raise ProblemError(f"{what}: {path}; give a file that exists") from error


def _run(path: Path, values: Mapping[str, object]) -> Problem:
    if values:
        raise ValueError("a Python file has no parameters to set; change them in it")
    read_file(path)  # which refuses what has no end
    try:
        problem = runpy.run_path(str(path)).get("problem")
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # sys.exit, too
        raise ValueError(f"it ends with {type(error).__name__}: {error}") from error
    if not isinstance(problem, Problem):
        raise ValueError("it defines no models.Problem named `problem`; define one")
    return problem


def _decode(
    name: str, content: Mapping[str, object], values: Mapping[str, object]
) -> Problem:
    table = Table(content, known=KEYS)
    state, formula = _language(table, values)
    system, limits = _system(table, state, formula), table.table("limits")
    table.get("goal")
    return Problem(
        name=name,
        description=table.text("description", ""),
        system=system,
        gait=table.texts("gait", ()) or _gait(system),
        elements=table.texts("elements", ()),
        start=table.gains("start"),
        goal=table.gains("goal"),
        segments=table.whole("segments", 1),
        limits={k: limits.numbers(k, 2, "[lowest, highest]") for k in limits.values},
        # stances and words that do not exist are refused by `Problem`
        stance=cast(StanceRule, table.text("stance", "paper")),
        degree=table.whole("degree") if "degree" in table else None,
        words=cast(Words, table.text("words", "printed")),
        in_gait="gait" in table,
        flat=_flat(table, formula) if "flat" in table else None,
        hitches=tuple(formula("hitches", each) for each in table.texts("hitches", ())),
    )


def _flat(table: Table, formula: Reader) -> FlatOutputs:
    """Flat outputs, with their rates where the file gives these."""
    given = table.table("flat", FLAT)
    for key in FLAT[:2]:
        given.get(key)  # refuses a table that lacks it
    values = {key: formula(f"flat.{key}", v) for key, v in given.values.items()}
    return FlatOutputs(**values)


def _language(
    table: Table, values: Mapping[str, object]
) -> tuple[tuple[sp.Symbol, ...], Reader]:
    """The state, and what reads formulas over it, with numbers for the parameters."""
    known = table.table("parameters").values
    for key in values:
        require_known(f"parameter {key!r}", key, known)
    given = Table({**known, **values}, "parameters")
    state = tuple(sp.Symbol(name, real=True) for name in table.texts("state"))
    if (most := max(len(state), len(known))) > MOST_NAMES:
        raise ValueError(f"{most} coordinates or parameters; give {MOST_NAMES} at most")
    parameters = {name: given.exact(name) for name in given.values}
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

    return state, formula


def _system(
    table: Table, state: tuple[sp.Symbol, ...], formula: Reader
) -> StratifiedSystem:
    names = tuple(map(str, state)) or ("x",)  # in words, where there is none

    def column(field: str, rates: object) -> list[sp.Expr]:
        what = f"field {field}"
        if not isinstance(rates, dict):
            raise ValueError(message("no_rates", what=what, rates=rates, name=names[0]))
        for name in rates:
            require_known(f"{what} moves {name}, which", name, names)
        return [formula(what, rates.get(name, 0)) for name in names]

    strata = {
        stratum: {name: column(name, rates) for name, rates in fields.values.items()}
        for stratum, fields in table.tables("strata").items()
    }
    sets, level_sets = table.table("level_sets"), {}
    for stratum in sets.values:
        what = f"level set of S{stratum}"
        level_sets[stratum] = tuple(formula(what, f) for f in sets.list(stratum))
    bottom = str(table.values.get("bottom", next(iter(strata), "")))
    metric, raising = table.gains("metric"), table.table("lifts")
    lifts = {stratum: raising.texts(stratum) for stratum in raising.values}
    return StratifiedSystem(state, strata, bottom, level_sets, metric, lifts)


def _gait(system: StratifiedSystem) -> tuple[str, ...]:
    """From the bottom stratum to each of its neighbours in turn, and back."""
    bottom = system.bottom
    return (bottom, *(s for near in system.neighbours[bottom] for s in (near, bottom)))
