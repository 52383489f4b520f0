"""Systems and plans as tables of strings and numbers, and plans as JSON files.

The tables hold strings, numbers, lists and tables only, so that a system can also be
kept in a TOML file.
"""

import json
from collections.abc import Mapping, Sequence
from operator import index
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from planner.errors import StratumError, message
from planner.planning.algorithm import Plan
from planner.support.files import read_file, whole_file
from planner.systems.fields import NumericField
from planner.systems.flows import Flow, Gait
from planner.systems.formulas import MOST_NAMES, read_formula, write_formula
from planner.systems.strata import StratifiedSystem

Table = Mapping[str, Any]

MOST_BYTES = 5 * 10**7  # of a plan
FORMAT = "stratified plan, version 2"
MOST_FLOWS = 250_000  # of a plan, which take ten seconds and 1.5 GB where it is shown
WRONG = KeyError, TypeError, AttributeError, ValueError, OverflowError, StratumError


def system_table(system: StratifiedSystem) -> Table:
    """A system as a table of formulas; fields known as functions only are refused."""
    for name, field in system.fields.items():
        if isinstance(field, NumericField):
            raise ValueError(f"field {name} is a function, which cannot be written")
    written = {n: list(map(write_formula, f)) for n, f in system.fields.items()}
    sets = {s: list(map(write_formula, f)) for s, f in system.level_sets.items()}
    return {
        "state": list(map(str, system.state)),
        "bottom": system.bottom,
        "strata": {
            stratum: {name: written[name] for name in fields}
            for stratum, fields in system.strata.items()
        },
        "level_sets": sets,
        "metric": system.metric,
        "lifts": system.lifts,
    }


def system_from(table: Table) -> StratifiedSystem:
    """The system that a table describes, as `system_table` gives it."""
    needed = {"state", "bottom", "strata"}
    for key in sorted(needed - table.keys()):
        raise ValueError(f"system lacks {key!r}; it has {', '.join(table) or 'none'}")
    for key in sorted(table.keys() - needed - {"level_sets", "metric", "lifts"}):
        raise ValueError(f"system has the unknown key {key!r}")
    if (count := len(table["state"])) > MOST_NAMES:
        raise ValueError(f"a system of {count} coordinates; {MOST_NAMES} are the most")
    state = tuple(sp.Symbol(str(name), real=True) for name in table["state"])

    def read(formulas: Sequence[str]) -> tuple[sp.Expr, ...]:
        return tuple(read_formula(formula, state) for formula in formulas)

    return StratifiedSystem(
        state=state,
        bottom=table["bottom"],
        strata={
            stratum: {name: read(column) for name, column in fields.items()}
            for stratum, fields in table["strata"].items()
        },
        level_sets={s: read(f) for s, f in table.get("level_sets", {}).items()},
        metric=table.get("metric", {}),
        lifts=table.get("lifts", {}),
    )


def save_plan(plan: Plan, path: Path | str) -> None:
    """Write a plan to a file, as a whole or not at all.

    Raises:
        ValueError: It has fields known as functions only, or is too large to be read.
        OSError: The file cannot be written.

    Example:
        >>> from planner import EXAMPLES, line, load_plan, plan, save_plan
        >>> found = plan(EXAMPLES["heisenberg"], line((0, 0, 0), (0, 0, 1)), 1)
        >>> save_plan(found, "plan.json")
        >>> len(load_plan("plan.json").flows)
        4
    """
    table = {"format": FORMAT} | vars(plan) | {"system": system_table(plan.system)}
    system_from(table["system"])  # what could not be read again is refused
    if not plan.gait:
        del table["gait"]
    _require_few(plan.flows)
    text = json.dumps(table, default=np.ndarray.tolist)
    if len(text) > MOST_BYTES:
        facts = {"size": len(text) / 1e6, "most": MOST_BYTES / 1e6}
        raise ValueError(message("too_long", **facts))
    with whole_file(path) as part:
        part.write_text(text, "utf-8")


def load_plan(path: Path | str) -> Plan:
    """Read a plan that `save_plan` wrote.

    Raises:
        ValueError: The file does not hold a plan.
        OSError: The file cannot be read.

    Example:
        >>> from planner import EXAMPLES, line, load_plan, plan, save_plan
        >>> found = plan(EXAMPLES["heisenberg"], line((0, 0, 0), (1, 0, 0)), 2)
        >>> save_plan(found, "plan.json")
        >>> load_plan("plan.json").hall_coordinates.shape
        (2, 3)
    """
    try:
        table = json.loads(read_file(path, MOST_BYTES))
    except (ValueError, RecursionError):
        raise ValueError(message("not_json", path=path)) from None
    if not isinstance(table, dict) or table.get("format") != FORMAT:
        raise ValueError(f"{path} is not a plan of the format {FORMAT!r}; save it anew")
    try:
        system, gait = system_from(table["system"]), tuple(table.get("gait", ()))
        _require_few(table["flows"])
        if odd := {type(time) for *_, time in table["flows"]} - {int, float}:
            raise ValueError(f"a flow lasts for a {odd.pop().__name__}")
        return Plan(
            system=system,
            elements=tuple(table["elements"]),
            basis=tuple(table["basis"]),
            flows=tuple(Flow(s, f, float(t)) for s, f, t in table["flows"]),
            segment_ends=tuple(map(index, table["segment_ends"])),
            inputs=np.array(table["inputs"]),
            hall_coordinates=np.array(table["hall_coordinates"]),
            nominal=np.array(table["nominal"]),
            depart=table["depart"],
            arrive=table["arrive"],
            gait=Gait(system, gait).strata if gait else (),
        )
    except WRONG as error:
        raise ValueError(f"{path} is damaged: {error}; save the plan again") from None


def _require_few(flows: Sequence[object]) -> None:
    if (count := len(flows)) > MOST_FLOWS:
        raise ValueError(f"a plan of {count} flows; {MOST_FLOWS} are the most")
