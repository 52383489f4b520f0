"""Designs with fewer joints, checked and walked: how few joints suffice.

A design divides the legs into two groups that lift in turn. In a group, legs swing by
one angle, each one way or the other, or are locked where they stand.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from math import comb
from typing import Any

import numpy as np

from models import Kinematics, ModelError, Robot, equations, mobility_of
from models.motion import group_twist
from planner import PlannerError
from sim.errors import StratawalkError, one_line
from sim.evaluation.quantities import POSITION
from sim.scenarios.file import load_scenario
from sim.scenarios.predictions import COSTLY
from sim.simulation import simulate

# How designs are tried: a step aside as long as one ahead.
WALK = {"path.goal": [0.01, 0.01, 0.0], "segments": 4, "swing_speed": 1.0}
DIRECTIONS = ("ahead", "aside", "round")
SAME_MOTION = 1e-3  # of the larger motion; what two strokes differ by is rounding
STANDING = 3  # feet that a body can stand on
STILL = 1e-4  # [m], [rad] a radian; gains of locked legs alone make less
LOCKED = 1e-6  # of the group's angle; a card knows no gain of 0
Signs = Mapping[int, int]  # leg -> way that it swings, 0 where it is locked


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
        return " | ".join(
            " ".join(f"{leg}{'0+-'[sign]}" for leg, sign in signs.items())
            for signs in self.groups
        )

    def built(self, robot: Robot) -> Robot:
        """The robot with these groups."""
        gains = [{leg: sign or LOCKED for leg, sign in g.items()} for g in self.groups]
        return robot.alternating(dict(zip("12", gains, strict=True)))


def designs(legs: Sequence[int]) -> Iterator[Design]:
    """All designs, the fewest joints first; mirrored signs of a group count once."""
    head, *rest = legs
    for joints in range(2, len(legs) + 1):
        for size in range(STANDING, len(legs) - STANDING + 1):
            for others in combinations(rest, size - 1):
                second = [leg for leg in rest if leg not in others]
                fewest = max(joints - len(second), 1)
                for signs in _ways((head, *others), fewest, joints - 1):
                    left = joints - sum(map(abs, signs.values()))
                    for more in _ways(second, left, left):
                        yield Design((signs, more))


def count_designs(legs: int) -> int:
    """Number of designs of so many legs, without making them."""
    sizes = range(STANDING, legs - STANDING + 1)
    ways = {size: (3**size - 1) // 2 for size in sizes}  # of a group to swing
    return sum(comb(legs - 1, n - 1) * ways[n] * ways[legs - n] for n in sizes)


def _ways(
    group: Sequence[int], fewest: int, most: int, signs: Sequence[int] = (1, 0)
) -> Iterator[Signs]:
    """Ways that some legs of a group can swing together, the first of them forward."""
    if not group:
        yield {}
        return
    leg, *rest = group
    for sign in signs:
        less = abs(sign)
        if less <= most and fewest - less <= len(rest):
            then = (1, -1, 0) if sign else signs
            for others in _ways(rest, fewest - less, most - less, then):
                yield {leg: sign, **others}


def directions(
    robot: Robot, design: Design, known: dict[object, np.ndarray | None]
) -> tuple[str, ...]:
    """Which of `DIRECTIONS` both strokes and their bracket make together.

    These three are all that there is: further brackets of two motions of the plane are
    combinations of them. Twists of groups, which many designs share, become `known`.
    """
    built, twists = design.built(robot), []
    for name, signs in zip(built.groups, design.groups, strict=True):
        if (key := tuple(signs.items())) not in known:
            with suppress(ModelError):  # these legs do not stand
                known[key] = np.array(group_twist(Kinematics(built), name))
        twists.append(known.setdefault(key, None))
    first, second = twists
    if first is None or second is None:
        return ()
    first, second = (t * (np.abs(t).max() > STILL) for t in (first, second))
    (x, y, turn), (u, v, spin) = first, second  # forward, left and yaw
    bracket = np.array([turn * -v + spin * y, turn * u - spin * x, 0.0])
    _, size, ways = np.linalg.svd(np.array([first, second, bracket]))
    lost = np.abs(ways[size <= SAME_MOTION * size[0] ** 2]).max(axis=0, initial=0.0)
    pairs = zip(DIRECTIONS, lost, strict=True)
    return tuple(name for name, part in pairs if part < SAME_MOTION)


def tried(
    robot: Robot, found: Iterable[Design], walks: int
) -> Iterator[Mapping[str, Any]]:
    """A row of the table for every design; the first that go everywhere are walked."""
    known: dict[object, np.ndarray | None] = {}
    for number, design in enumerate(found):
        ways = directions(robot, design, known)
        row: dict[str, Any] = {
            "design": number,
            "groups": str(design),
            "swing_joints": design.joints,
            "joints": design.joints + len(robot.legs),
            **{f"goes.{name}": name in ways for name in DIRECTIONS},
            "status": "lacks a direction, or does not stand",
        }
        if ways == DIRECTIONS:
            row |= _checked(design.built(robot))
            if row["status"] == "ok":
                row["status"] = "goes everywhere, not walked"
                row |= _walked(design.built(robot)) if walks > 0 else {}
                walks -= 1
        yield row


def _checked(robot: Robot) -> dict[str, Any]:
    """What each direction costs, by the test that `stratawalk check` makes."""
    try:
        found = mobility_of(robot, equations(robot))
    except (ModelError, PlannerError, ValueError) as error:
        return {"status": one_line(error)}
    status = f"cannot {' or '.join(found.lacking)}" if found.lacking else "ok"
    strokes = {f"strokes.{cost.direction}": cost.strokes for cost in found.costs}
    return {"status": status, **strokes}


def _walked(robot: Robot) -> dict[str, Any]:
    scenario = load_scenario("line", {**WALK, "robot": robot.name})
    try:
        summary = simulate(scenario, robot=robot, without=COSTLY).summary
    except (StratawalkError, PlannerError, ModelError) as error:
        return {"status": one_line(error)}
    return {
        "status": "ok",
        "verdict": summary.verdict,
        "strokes_per_metre": summary.per_metre.strokes,
        "min_margin": summary.achieved.min_margin,
        "goal": POSITION.value(summary, "goal"),
        "farthest_per_path": summary.weighed and summary.weighed.farthest,
    }
