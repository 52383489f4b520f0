"""Servos fitted to logs of a robot: one make for all joints, checked on what was kept.

Each joint is fitted for itself. Stiffness, damping, backlash and delay are those of one
make, so that all joints together tell them better than each alone. Of every log three
quarters are fitted, but for their beginning, and the last quarter is predicted.
"""

import json
import re
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import compress, product
from math import isfinite
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models import Robot
from models.description import parse_toml, toml_text, without_tables
from planner import Array
from planner.support import unfinished
from sim.errors import SimulationError, UsageError
from sim.fitting.estimate import Estimates, best_of, estimate, together
from sim.fitting.makes import SERVO, one_make, shared_make
from sim.fitting.servo_law import Commanded, known_servos, on_floor, on_stand
from sim.folder import require_free, require_writable, whole
from sim.logs.log import Log
from sim.preparation.setup import Setup
from sim.preparation.shared import built
from sim.scenarios.declaration import LEAST, is_number, read, refusal
from sim.scenarios.settings import SETTINGS

APART = 0.01  # [s]; delays that are tried
LOOSE = ((0.0, 0.01), (0.0, 0.01))  # [rad]; dead bands and backlash that are tried
NARROWEST = 1e-5  # [rad]; a band that all joints have, so that all are built alike
FITTED = 0.75  # of the rows of a log; the rest checks
BEGINNING = 0.5, 0.1  # [s], or a share of a log that may begin in motion; not fitted
FEWEST_ROWS = 20  # of a log; six parameters are fitted to each joint
MOST_ANGLES = 175 * 10**4  # of all logs; each takes a kilobyte, and 60 microseconds
MOST_WALKED = 650_000  # of a log that walks, of which each takes three kilobytes
A_SECOND = 190  # angles take as much as the law of a joint does in a second
LAST_FIT = re.compile(r"""[ \t]*\[[ \t]*(["']?)fitted\1[ \t]*[.\]]""")
Value = float | list[float]
Fitted = Mapping[str, tuple[Value, Value]]  # settings, with standard errors


@dataclass(frozen=True, eq=False)
class JointFit:
    """Servos of joints, alone and as one make, and how well they predict."""

    joints: tuple[str, ...]
    each: Estimates  # every joint for itself
    make: Estimates  # what they share
    own: Estimates  # what each has of its own, given what they share
    before: Array  # root mean square of what was kept: as described, (J,) [rad]
    after: Array  # and as fitted, (J,) [rad]

    def settings(self, joints: Sequence[str], earlier: Mapping[str, Any]) -> Fitted:
        """Settings that were seen and their standard errors, for a robot's joints.

        Joints of which nothing was seen keep what an earlier fit has found.
        """
        found: dict[str, tuple[Value, Value]] = {}
        before = earlier, earlier.get("errors")
        for k, parameter in enumerate(self.make.parameters):
            number, off = self.make.of(k)
            none = parameter.low == 0 and number < max(2.0 * off, LEAST)  # not shown
            if self.make.seen[0, k]:
                found[parameter.setting] = 0.0 if none else number, off
        for k, parameter in enumerate(self.own.parameters):
            if (seen := self.own.seen[:, k]).any():
                both = np.array([self.own.value[:, k], self.own.error[:, k]])
                both[:, np.abs(both[0]) < LEAST] = 0.0
                known = [_list(table, parameter.setting, joints) for table in before]
                for row, numbers in zip(known, both.tolist(), strict=True):
                    row |= compress(zip(self.joints, numbers, strict=True), seen)
                value, error = ([row[joint] for joint in joints] for row in known)
                found[parameter.setting] = value, error
        return found


def _list(table: object, key: str, joints: Sequence[str]) -> dict[str, float]:
    """What a table's list has of joints, 0 without one."""
    given: Any = table.get(key) if isinstance(table, Mapping) else None
    whole = isinstance(given, list) and len(given) == len(joints)
    numbers = given if whole else [0.0] * len(joints)
    if not all(is_number(number) and isfinite(number) for number in numbers):
        raise refusal(given, "numbers", "[fitted] of the robot's card", key)
    return dict(zip(joints, numbers, strict=True))


def fit_joints(setup: Setup, logs: Sequence[Log], walking: bool) -> JointFit:
    """Fit the servos of a robot to logs of the same joints, with measured angles.

    Raises SimulationError where the robot cannot walk what the log says.
    """
    start = servos(*known_servos(setup, logs[0]))
    model, whole = setup.as_planned.model, start
    for _ in range(3 if walking else 1):  # all but the first with servos as found
        loaded = [
            on_floor(setup, model, log, whole) if walking else on_stand(setup, log)
            for log in logs
        ]
        pairs = [*zip(loaded, logs, strict=True)]
        told = [(c, *_rows(log, False)) for c, log in pairs]
        tries = 2 - walking  # loads on the floor are too uncertain for a choice
        each = together([fit_servos(*one, start, tries) for one in told])
        if walking:
            make, own, whole = one_make(each)
            model = _fitted_model(setup, logs[0], whole)
        else:
            each, make, own, whole = shared_make(told, start, each)
    ends = ([_missed(*pair, servo) for pair in pairs] for servo in (start, whole))
    before, after = (np.sqrt(np.mean(end, axis=0)) for end in ends)
    if (lost := np.isfinite(before) & ~np.isfinite(after)).any():
        raise SimulationError.of("unsimulated", logs[0].joints[int(lost.argmax())])
    return JointFit(logs[0].joints, each, make, own, before, after)


def _fitted_model(setup: Setup, log: Log, whole: Array) -> mujoco.MjModel:
    """The world of a robot whose servos are like those that were found, (J, 6)."""
    own = dict(zip(log.joints, whole[:, 2].tolist(), strict=True))
    stiffness, damping = np.exp(whole[0, :2]).tolist()
    backlash, planned = float(whole[0, 3]), setup.scenario.as_planned
    bands = (max(own.get(j, 0.0), NARROWEST) for j in setup.robot.card.joints)
    own_laws = {"servo_stiffness": stiffness, "servo_damping": damping}
    loose = {"backlash": backlash * (backlash >= LEAST), "dead_band": tuple(bands)}
    found = replace(planned, **own_laws, **loose)  # type: ignore[arg-type]
    return built(setup.robot, found)[1]


def check_measured(path: Path, log: Log) -> None:
    """Refuse a log that measured too little to fit servos, or only its commands."""
    if log.measured is None:
        return
    if len(log.time) < FEWEST_ROWS or np.isnan(_rows(log, True)[1]).all():
        raise UsageError.of("few_rows", path, FEWEST_ROWS=FEWEST_ROWS)
    if not np.nan_to_num(log.measured - log.commanded).any():
        raise UsageError.of("as_commanded", path)


def check_told(path: Path, logs: Sequence[Log]) -> None:
    """Refuse logs that together tell too few angles of a joint, but some."""
    few = int((FITTED - BEGINNING[1]) * FEWEST_ROWS)
    told = [(g.measured, _rows(g, False)[1]) for g in logs if g.measured is not None]
    for j, joint in enumerate(logs[0].joints):
        count = sum(np.isfinite(rows[:, j]).sum() for _, rows in told)
        if count < few and any(np.isfinite(whole[:, j]).any() for whole, _ in told):
            raise UsageError.of("few_angles", path, joint=joint, count=count, least=few)


def check_steps(path: Path, logs: Sequence[Log], timestep: float) -> None:
    """Refuse logs that walk more steps of physics [s] than there is room for."""
    if (steps := max(log.duration for log in logs) / timestep) > MOST_WALKED:
        raise UsageError.of("steps_of_fit", path, steps=steps, most=MOST_WALKED)


def _rows(log: Log, kept: bool) -> tuple[Array, Array]:
    """Times and measured angles of the rows that are fitted, or of those kept."""
    if log.measured is None:
        raise ValueError("no measured angles; give columns measured.JOINT")
    count, (seconds, share) = len(log.time), BEGINNING
    cut, settled = int(FITTED * count), min(seconds, share * log.time[-1])
    begins = min(int(log.time.searchsorted(settled)), int(share * count))
    rows = slice(cut, None) if kept else slice(begins, cut)
    return log.time[rows], log.measured[rows]


def _missed(commanded: Commanded, log: Log, tried: Array) -> Array:
    """Mean square of what the kept rows were not predicted by, (J,) [rad^2]."""
    times, measured = _rows(log, True)
    off = measured - commanded.answers(tried[None], times)[0]
    return np.asarray(np.nanmean(off**2, axis=0))


def servos(stiffness: Array, damping: Array) -> Array:
    """Servos (P, 6) of known stiffness and damping, (P,), and else without fault."""
    return np.pad(np.log([stiffness, damping]).T, ((0, 0), (0, len(SERVO) - 2)))


def fit_servos(
    commanded: Commanded, rows: Array, measured: Array, start: Array, tries: int = 2
) -> Estimates:
    """Servos of P joints, expected at (P, 6), from angles (N, P) at times (N,) [s]."""
    guesses = _scanned(commanded, rows, measured, start)[:tries]
    model = partial(commanded.answers, rows=rows)
    return best_of([estimate(model, measured, SERVO, start, one) for one in guesses])


def _scanned(commanded: Commanded, rows: Array, measured: Array, start: Array) -> Array:
    """Best servos of a grid, with backlash and without, the better first, (2, P, 6)."""
    grid = [*product((-0.7, 0.0, 0.7), *LOOSE)]  # logarithms of factors
    tried = np.tile(start, (len(grid), 1, 1))
    tried[..., 1:4] += np.array(grid)[:, None]
    both, all_least = np.stack([start, start]), np.full((2, len(start)), np.inf)
    answers = commanded.answers(tried, rows)
    for servo, found, (*_, slack) in zip(tried, answers, grid, strict=True):
        best, least = both[int(slack > 0)], all_least[int(slack > 0)]
        for delay in np.arange(0.0, 0.3, APART):  # [s]
            late = [np.interp(rows - delay, rows, angle) for angle in found.T]
            off = measured - np.stack(late, axis=1)
            left, zero = np.nanvar(off, axis=0), np.nanmean(off, axis=0)
            better = left < least
            best[better] = servo[better]
            best[better, 4], best[better, 5] = zero[better], delay
            least[better] = left[better]
    return np.take_along_axis(both, all_least.argsort(axis=0)[..., None], axis=0)


def card_text(
    robot: Robot, fitted: Fitted, sources: Sequence[str], servo: str = "ideal"
) -> str:
    """The robot's card with what was fitted; a UsageError if no walk takes that.

    The make of servo that was fitted stands there, since others have other numbers.
    """
    for key, (value, _) in fitted.items():
        try:
            read(value, SETTINGS[key].kind)
        except ValueError:
            facts = {"key": key, "value": reprlib.repr(value)}
            raise UsageError.of("untaken", ", ".join(sources), **facts) from None
    lines = [f"{key} = {json.dumps(value)}" for key, (value, _) in fitted.items()]
    errors = [f"{key} = {json.dumps(error)}" for key, (_, error) in fitted.items()]
    lines.append(f"servo = {toml_text(servo)}")
    lines.append(f"joints = [{', '.join(map(toml_text, robot.card.joints))}]")
    lines.append(f"source = [{', '.join(map(toml_text, sources))}]")
    table = ["[fitted]", *lines, "", "[fitted.errors]", *errors]
    text = "\n".join([without_tables(robot.card_text, LAST_FIT), "", *table, ""])
    try:
        parse_toml(text)
    except ValueError as error:
        card, why = robot.path.with_suffix(".toml"), str(error).partition(" (at")[0]
        raise UsageError.of("unfit", card, why=why) from error
    return text


def check_free(card: Path) -> None:
    """Refuse a name that is no card's, or that is taken."""
    if card.suffix != ".toml" or not card.parent.is_dir():
        raise UsageError.of("no_place", card)
    for path in (card, card.with_suffix(".xml")):
        require_free(path, "--out")
    require_writable(card.parent)


def write_card(robot: Robot, card: Path, text: str) -> str:
    """Write a card, and the robot's file if it is one alone; return how to use it."""
    with whole(card, new=True) as part:
        part.write_text(text, "utf-8")
    model = card.with_suffix(".xml")
    alone = robot.is_shipped or robot.opened.files in ((), (robot.path,))
    if not alone or robot.has_card_inside:
        return f"{card}; put it in the place of the robot's own card"
    with unfinished(card), whole(model, new=True) as part:
        part.write_text(robot.read().to_xml(), "utf-8")
    return f"{card}; use it as --robot {model}"
