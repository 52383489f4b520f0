"""What walks with common settings have in common, kept from one walk to the next.

Which settings a thing does not depend on is listed here; it is made anew where any
other one differs. A test changes each setting of the lists and compares.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Collection, Hashable
from typing import Any, TypeVar

import mujoco

from models import Robot
from sim.preparation.tuning import is_tunable, tuned, untuned
from sim.scenarios.scenario import Scenario, settings
from sim.world.model import World, build, load as load_world

T = TypeVar("T")

WITHOUT_EFFECT = ("name", "description", "plan_time", "sample_every", "playback")
OF_THE_WAY = (
    *WITHOUT_EFFECT, "stance", "words", "segments", "replan", "steer", "optimise",
    "path_tolerance", "yaw_tolerance", "together", "correct", "path", "min_margin",
    "min_clearance", "allow_unstable", "seed",
)  # fmt: skip
"""Settings that neither the world nor what is measured in it depends on."""
OF_THE_WORLD = (
    "friction", "timestep", "servo", "servo_stiffness", "servo_damping",
    "command_rate", "resolution", "feed_forward", "zero_offset", "play", "payload",
    "slope", "floor_stiffness", "foot_friction", "draw", "swing_speed",
    "swing_acceleration", "lift_height", "hold",
)  # fmt: skip
"""Settings that a robot's equations do not depend on."""
OF_THE_PHYSICS = (*WITHOUT_EFFECT, *OF_THE_WORLD, "allow_unstable", "seed")
"""Settings that a stratified plan on the ideal fields does not depend on."""
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
        key = everything_but(scenario, OF_THE_WAY)
        return self.kept("world", key, lambda: self._world(scenario, robot))

    def _world(self, scenario: Scenario, robot: Robot) -> tuple[World, mujoco.MjModel]:
        if not is_tunable(scenario, robot):
            return made(robot, scenario)
        plain = untuned(scenario)
        key = everything_but(plain, OF_THE_WAY)
        world, model = self.kept("plain world", key, lambda: made(robot, plain))
        if world.servo is None:  # servos that differ are left to the compiler
            return made(robot, scenario)
        return tuned(world, model, robot, scenario)


def everything_but(scenario: Scenario, names: Collection[str]) -> Hashable:
    """All settings of a scenario but some, to be compared with another one's.

    Args:
        scenario: The scenario.
        names: Settings that are left out; `path` and `obstacles` may be among them.
    """
    every = (*(item.name for item in settings()), "path", "obstacles")
    values = {name: getattr(scenario, name) for name in every if name not in names}
    return tuple((name, repr(value)) for name, value in values.items())


def made(robot: Robot, scenario: Scenario) -> tuple[World, mujoco.MjModel]:
    """Robot and world of a scenario, and the model compiled from their text."""
    world = build(robot, scenario)
    return world, load_world(world)
