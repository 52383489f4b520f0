"""Ways to build a robot with fewer joints: legs in groups, swings coupled or locked.

A design divides the legs into two groups that lift in turn. In a group, legs swing by
one angle, each one way or the other, or are locked where they stand.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

from models.description.card import GroupCard
from models.description.robot import Robot

STANDING = 3  # feet that a body can stand on
LOCKED = 1e-6  # of the group's angle; a card knows no gain of 0
Signs = Mapping[int, int]  # leg -> way that it swings, 0 where it is locked
NAMES = ("1", "2")


@dataclass(frozen=True)
class Design:
    """Two groups of legs."""

    groups: tuple[Signs, Signs]  # for each group the ways that its legs swing

    @property
    def joints(self) -> int:
        """Number of swing joints that move."""
        return sum(sign != 0 for signs in self.groups for sign in signs.values())

    def __str__(self) -> str:
        """Legs with + or - for the way that they swing, and 0 for a locked one."""
        words = {1: "+", -1: "-", 0: "0"}
        return " | ".join(
            " ".join(f"{leg}{words[sign]}" for leg, sign in signs.items())
            for signs in self.groups
        )

    def built(self, robot: Robot) -> Robot:
        """The robot with these groups."""
        groups = {
            name: GroupCard({leg: sign or LOCKED for leg, sign in signs.items()})
            for name, signs in zip(NAMES, self.groups, strict=True)
        }
        first, second = NAMES
        both = first + second
        gait = (both, first, both, second, both)
        card = replace(robot.card, groups=groups, gait=gait, patterns={})
        return replace(robot, card=card)


def designs(legs: Sequence[int]) -> Iterator[Design]:
    """All designs, the fewest joints first; mirrored signs of a group count once."""
    found = [
        Design((first, second))
        for group in _groups(legs)
        for first in _ways(group)
        for second in _ways([leg for leg in legs if leg not in group])
    ]
    yield from sorted(found, key=lambda design: design.joints)


def _groups(legs: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """The group of the first leg in every division into two that can stand."""
    head, *rest = legs
    for size in range(STANDING, len(legs) - STANDING + 1):
        for others in combinations(rest, size - 1):
            yield (head, *others)


def _ways(group: Sequence[int]) -> Iterator[Signs]:
    """Ways that the legs of a group can swing together, the first of them forward."""
    for signs in product((1, -1, 0), repeat=len(group)):
        if next((sign for sign in signs if sign), 0) == 1:
            yield dict(zip(group, signs, strict=True))
