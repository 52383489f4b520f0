"""The cost of a walk, before it is walked: physics steps, and memory for its rows.

Walks that would take too many steps or too much memory are refused.
"""

from __future__ import annotations

import os

from sim.errors import UsageError
from sim.preparation.setup import Setup
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS

MOST_STEPS = 1_000_000_000  # eight hours at 35,000 a second
MOST_TRAVEL = 250_000  # [rad] in so many steps, with the settings of the shipped walks
COPIES = 2  # of each row during evaluation and writing; 1.8 were measured


def check_effort(setup: Setup, steps: int) -> None:
    """Refuse a simulation that takes too many steps or too much memory."""
    scenario = setup.scenario
    rows = steps // scenario.sample_every
    needed, there = rows * _row_size(setup), _memory()
    if steps <= MOST_STEPS and needed <= there:
        return
    remedy = _slowest(scenario)
    if steps <= MOST_STEPS:
        remedy = f"raise sample_every above {steps * _row_size(setup) // there}"
    raise UsageError(
        f"{steps:,} physics steps with a row every {scenario.sample_every} would take "
        f"{needed / 1e9:,.1f} GB of memory, {there / 1e9:,.1f} GB may be used, and at "
        f"most {MOST_STEPS:,} steps are made",
        f"scenario {scenario.name!r}",
        remedy,
    )


def check_distance(setup: Setup) -> None:
    """Refuse a path that no walk could follow to its end, before planning it."""
    scenario, equations = setup.scenario, setup.equations
    farthest = max(map(equations.stride, equations.swings), default=0.0)  # [m/rad]
    travel = scenario.path.length / farthest if farthest else 0.0
    if travel <= MOST_TRAVEL:
        return
    raise UsageError(
        f"a path of {scenario.path.length:g} m takes {travel:.2g} rad of strokes or "
        f"more, and at most {MOST_TRAVEL:,} are planned",
        f"scenario {scenario.name!r}",
        "bring the goal nearer",
    )


def _row_size(setup: Setup) -> int:
    """Bytes that one row of the trajectory takes until it is written."""
    feet, model = len(setup.robot.legs), setup.model
    achieved = model.nq + model.nv + 5 * feet + 8
    predicted = 3 * (2 * feet + 4)
    return int(8 * COPIES * (achieved + predicted))


def _memory() -> int:
    """Half of the machine's memory [bytes]; the rest is left to other programs."""
    return int(os.sysconf("SC_PHYS_PAGES")) * int(os.sysconf("SC_PAGE_SIZE")) // 2


def _slowest(scenario: Scenario) -> str:
    """The setting that lengthens the walk most, compared with its default."""
    powers = {"timestep": 1, "swing_speed": 1, "swing_acceleration": 0.5, "hold": -1}
    longer = {
        name: (SETTINGS[name].default / getattr(scenario, name)) ** power
        for name, power in powers.items()
    }
    name = max(longer, key=longer.__getitem__)
    verb = "lower" if powers[name] < 0 else "raise"
    return f"{verb} {name}, now {getattr(scenario, name):g}"
