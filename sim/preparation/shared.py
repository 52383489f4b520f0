"""What walks with common settings have in common, kept from one walk to the next.

What a setting affects is declared with it; a thing is made anew where a setting that
affects it differs. A test changes each setting and compares.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, TypeVar

import mujoco

from models import Robot
from sim.preparation.tuning import is_tunable, tuned, untuned
from sim.scenarios.declaration import Effect
from sim.scenarios.scenario import Scenario
from sim.world.model import World, build, load as load_world

T = TypeVar("T")

WORLD: tuple[Effect, ...] = ("equations", "motion", "world", "drive")
"""What a setting affects that matters to measurements in a world: all but the way."""
PLAN: tuple[Effect, ...] = ("equations", "plan")
"""What it affects that matters to a stratified plan on the ideal fields."""
MOST = 32  # things kept of a kind


class Shared:
    """Things that have been made, by kind and by what they depend on."""

    def __init__(self) -> None:
        self._kept: dict[str, OrderedDict[Hashable, Any]] = {}

    def kept(
        self, kind: str, key: Hashable, make: Callable[[], T], most: int = MOST
    ) -> T:
        """A thing that was made before, or that is made now.

        Args:
            kind: What kind of thing.
            key: Everything that it depends on.
            make: Makes it.
            most: How many of its kind are kept.
        """
        of_kind = self._kept.setdefault(kind, OrderedDict())
        if key not in of_kind:
            of_kind[key] = make()
        of_kind.move_to_end(key)
        if len(of_kind) > most:
            of_kind.popitem(last=False)
        found: T = of_kind[key]
        return found

    def world(self, scenario: Scenario, robot: Robot) -> tuple[World, mujoco.MjModel]:
        """Robot and world of a scenario, and the model compiled from them.

        Scenarios that differ in nothing but the way share a model. Those that differ in
        frictions, gains and the payload as well have copies of one, with these numbers
        replaced.
        """
        if scenario.bumps:  # which lie along the way
            return made(robot, scenario)
        return self.kept(
            "world", scenario.key(*WORLD), lambda: self._world(scenario, robot)
        )

    def _world(self, scenario: Scenario, robot: Robot) -> tuple[World, mujoco.MjModel]:
        if not is_tunable(scenario, robot):
            return made(robot, scenario)
        plain = untuned(scenario)
        key = plain.key(*WORLD)
        world, model = self.kept("plain world", key, lambda: made(robot, plain))
        if world.servo is None:  # servos that differ are left to the compiler
            return made(robot, scenario)
        return tuned(world, model, robot, scenario)


def made(robot: Robot, scenario: Scenario) -> tuple[World, mujoco.MjModel]:
    """Robot and world of a scenario, and the model compiled from their text."""
    world = build(robot, scenario)
    return world, load_world(world)
