"""Plans that several walks have in common, since they differ in their physics alone."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

from sim.preparation.setup import Setup
from sim.preparation.shared import PLAN, WORLD, Shared

T = TypeVar("T")
CACHED_WALKS = 2  # walks whose arrays are kept, a number for every step or moment


class Cache(Protocol):
    """Gives a thing that was built before, or builds it."""

    def __call__(self, kind: str, make: Callable[[], T]) -> T:
        """The thing of a kind."""
        ...


def is_shareable(setup: Setup) -> bool:
    """Whether a walk's plan follows from the ideal fields and the path alone."""
    scenario = setup.scenario
    plain = scenario.steer == "ideal" and scenario.words == "printed"
    free = not scenario.obstacles and scenario.min_margin is None
    once = scenario.optimise == "none" and scenario.correct == 1
    return plain and free and once and not setup.servo.resolution


def no_cache(kind: str, make: Callable[[], T]) -> T:
    """Build a thing and cache nothing."""
    return make()


def walk_cache(setup: Setup, shared: Shared | None) -> Cache:
    """Caches what follows from a walk's commands alone, in any physics."""
    scenario = setup.scenario
    if shared is None or scenario.replan or not is_shareable(setup):
        return no_cache
    key = (scenario.key(*PLAN), setup.limits, scenario.sample_every)
    return lambda kind, make: shared.cached(kind, key, make, CACHED_WALKS)


def world_cache(setup: Setup, shared: Shared | None) -> Cache:
    """Caches what is measured in a world, whatever is walked in it."""
    scenario = setup.scenario
    if shared is None or scenario.bumps:  # which lie along the way
        return no_cache
    key = scenario.key(*WORLD)
    return lambda kind, make: shared.cached(kind, key, make)
