"""What walks with common settings have in common, cached from one walk to the next.

A thing is built anew where a setting that affects it, as declared, differs.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import partial
from typing import Any, Protocol, TypeVar

import mujoco

from models import ModelError, Robot, load
from sim.errors import UsageError
from sim.scenarios.declaration import Effect
from sim.scenarios.scenario import Scenario
from sim.world.model import World, build, load as load_world

T = TypeVar("T")

WORLD: tuple[Effect, ...] = ("equations", "motion", "world", "drive")
"""What a setting affects that matters to measurements in a world: all but the way."""
PLAN: tuple[Effect, ...] = ("equations", "plan")  # to a plan on ideal fields
CACHED = 32  # things of a kind


class Cache(Protocol):
    """Caches things by their kind."""

    def __call__(self, kind: str, make: Callable[[], T]) -> T:
        """A thing that was built before, or that is built now."""


def no_cache(kind: str, make: Callable[[], T]) -> T:
    """Build a thing and cache nothing."""
    return make()


class Shared:
    """Things that have been built, by kind and by what they depend on."""

    def __init__(self) -> None:
        self._cached: dict[str, OrderedDict[Hashable, Any]] = {}

    def cached(
        self, kind: str, key: Hashable, build: Callable[[], T], most: int = CACHED
    ) -> T:
        """A thing that was built before, or that is built now."""
        of_kind = self._cached.setdefault(kind, OrderedDict())
        if key not in of_kind:
            of_kind[key] = build()
        of_kind.move_to_end(key)
        if len(of_kind) > most:
            of_kind.popitem(last=False)
        return of_kind[key]

    def robot(self, scenario: Scenario) -> Robot:
        """The robot of a scenario; a UsageError where its geometry makes none."""
        name, geometry = scenario.robot, scenario.geometry
        read = partial(load, name, geometry=geometry)
        try:
            return self.cached("robot", (name, str(geometry)), read)
        except ModelError as error:
            if not geometry:
                raise
            raise UsageError.at("geometry", error, "give what a robot has") from error


def world_cache(scenario: Scenario, robot: Robot, shared: Shared | None) -> Cache:
    """Caches a world and what is measured in it, whatever is walked there."""
    if shared is None or scenario.bumps:  # which lie along the way
        return no_cache
    return lambda kind, make: shared.cached(kind, (robot, scenario.key(*WORLD)), make)


def built(robot: Robot, scenario: Scenario) -> tuple[World, mujoco.MjModel]:
    """Robot and world of a scenario, and the model compiled from their text."""
    world = build(robot, scenario)
    return world, load_world(world)
