"""What brings a plan nearer to its goal: changes that were tried before they are told.

A change counts if it at least halves what the plan misses. Trying takes no longer than
planning may take, and ends early where enough was found.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from planner import BudgetError, PlannerError
from planner.support import limited
from sim.errors import StratawalkError

FAR = 0.05  # of the way; plans that end farther off are told what would help
HELPS = 0.5  # of what the plan misses, that a change may leave
ENOUGH = 3  # changes that end near the goal
PATIENCE = 30.0  # [s]

Offer = tuple[str, Callable[[], float]]  # in words, and what is missed then


@dataclass(frozen=True, slots=True)
class Remedy:
    """A change that was tried.

    Attributes:
        change: What was changed, as on the command line where there is an option.
        miss: How far the plan ends off its goal then, as a share of the way.
    """

    change: str
    miss: float

    def __str__(self) -> str:
        return f"{self.change} ends {100 * self.miss:.2g} % off"


@dataclass(frozen=True, slots=True)
class Trials:
    """Changes that were tried in turn.

    Attributes:
        helpful: Those that help, the best first.
        useless: Those that do not, or give no plan.
    """

    helpful: tuple[Remedy, ...]
    useless: tuple[str, ...]

    def __str__(self) -> str:
        if self.helpful:
            return "; ".join(map(str, self.helpful[:ENOUGH]))
        if self.useless:
            return f"nothing that was tried: {', '.join(self.useless)}"
        return "nothing could be tried in time"


def tried(offers: Iterable[Offer], miss: float, seconds: float) -> Trials:
    """Try changes in turn.

    Args:
        offers: Changes, each with the plan that it makes.
        miss: What the plan misses without any, as a share of the way; infinite if
            there is none.
        seconds: How long trying may take [s].
    """
    found: list[Remedy] = []
    useless: list[str] = []
    end = time.monotonic() + min(seconds, PATIENCE)
    for change, attempt in offers:
        left = end - time.monotonic()
        if left <= 0 or sum(remedy.miss <= FAR for remedy in found) >= ENOUGH:
            break
        try:
            with limited(left):
                reached = attempt()
        except BudgetError:
            break
        except (PlannerError, StratawalkError, ValueError):
            reached = math.inf  # no plan at all
        if reached <= HELPS * miss and reached < math.inf:
            found.append(Remedy(change, reached))
        else:
            useless.append(change)
    found.sort(key=lambda remedy: remedy.miss)
    return Trials(tuple(found), tuple(useless))
