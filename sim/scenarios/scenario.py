"""A scenario: which robot walks which nominal path, with which settings."""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, fields, replace
from math import pi, radians
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from models.description import KNOWN_SERVOS, make_named
from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.body_path import NominalPath
from sim.scenarios.declaration import Effect, Setting, accept
from sim.scenarios.obstacles import Obstacle
from sim.scenarios.predictions import COMPLIANT, imperfect, known_of, prediction_key
from sim.scenarios.settings import IMPERFECTIONS, SETTINGS, Settings

if TYPE_CHECKING:
    from models import Card, Robot

FITTED = ("friction", "payload", "slope", "servo_stiffness", "servo_damping",
          "command_delay", "dead_band", "backlash", "zero_offset")  # fmt: skip
"""What `stratawalk fit` writes under [fitted] of a card; all else is of scenarios."""
OF_SERVOS = {"servo_stiffness", "servo_damping", "command_delay", "dead_band",
             "backlash"}  # fmt: skip
"""What belongs to the make of servo that was fitted, and not to another one."""
LEFT = {*FITTED, "foot_friction", "floor_stiffness"}  # to the card, or to `imperfect`


@dataclass(frozen=True, kw_only=True)
class Scenario(Settings):
    """Everything that determines a run, immutable.

    Raises:
        UsageError: If a value is outside its limits, naming key, value and limits.

    Example:
        >>> from sim import Scenario, load_scenario
        >>> path = load_scenario("line").path
        >>> scenario = Scenario(name="mine", path=path, segments=20)
        >>> scenario.robot, scenario.swing_speed
        ('hexapod', 0.5)
    """

    obstacles: tuple[Obstacle, ...] = field(
        default=(), metadata={"affects": frozenset({"plan", "world"})}
    )
    path: NominalPath = field(metadata={"affects": frozenset({"plan"})})
    given: frozenset[str] = field(  # settings that were named beside its file
        default=frozenset(),
        compare=False,
        repr=False,
        metadata={"affects": frozenset()},
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.servo:
            object.__setattr__(self, "servo", make_named(self.servo))
        for name in self.known if isinstance(self.known, tuple) else ():
            if name not in IMPERFECTIONS:
                facts = {"name": name, "near": did_you_mean(name, IMPERFECTIONS)}
                raise UsageError.of("known", f"scenario {self.name!r}", **facts)

    def leaves(self, name: str) -> bool:
        """Whether a setting is left to the card's [fitted], and to `imperfect`."""
        return name not in self.given and getattr(self, name) == SETTINGS[name].default

    @property
    def steered_on(self) -> str:
        """Key of the prediction whose fields plans follow; of aimed ones, the ideal."""
        return prediction_key("ideal" if self.is_aimed else self.steer)

    @property
    def goal(self) -> tuple[float, float, float] | None:
        """Pose that it is to reach; None of a motion that is played."""
        return None if self.motion else self.path.goal

    @property
    def is_aimed(self) -> bool:
        """Whether plans are aimed beside the goal by the compliant prediction."""
        return self.steer == COMPLIANT.label

    @property
    def is_imperfect(self) -> bool:
        """Whether it has any imperfection that no prediction knows of."""
        return bool(imperfect(self))

    @property
    def as_planned(self) -> Self:
        """The same without imperfections: the robot and its floor as they should be."""
        none: dict[str, Any] = {n: SETTINGS[n].default for n in IMPERFECTIONS}
        return replace(self, **none)

    @property
    def as_assumed(self) -> Self:
        """The robot that commands allow for: its dead bands and backlash as assumed."""
        given, slack = self.assumed_dead_band, self.assumed_backlash
        band = self.dead_band if given is None else given
        return replace(self.as_planned, dead_band=band, backlash=slack)

    @property
    def as_known(self) -> Self:
        """The same with only the imperfections that the compliant prediction knows."""
        if not self.is_imperfect:
            return self
        kept = {name: getattr(self, name) for name in known_of(self)}
        return replace(self.as_planned, **kept)

    @staticmethod
    def declarations() -> Mapping[str, Setting]:
        """What is declared about every setting, by its name."""
        return SETTINGS

    def key(self, *effects: Effect) -> Hashable:
        """All in it that has some effects, such as `world`, to compare scenarios by."""
        every = ((item.name, item.metadata["affects"]) for item in fields(self))
        own = (name for name, affects in every if affects & {*effects})
        return tuple((name, repr(getattr(self, name))) for name in own)


def drawn(scenario: Scenario, robot: "Robot") -> Scenario:
    """The scenario with what its robot's card and `imperfect` say as its settings.

    What was fitted to logs of the robot takes the place of settings that nobody names.

    A hobby robot has servos that are fitted by hand, a battery not quite in the middle,
    a table to walk on: zeros of servos are within half a degree, gears have half a
    degree of backlash, a twentieth of the robot's mass lies up to 10 mm off the middle,
    the table leans by up to a degree, feet rub unequally, and what they stand on is ten
    times as soft. The same robot and `draw` give the same values; what is given stays.
    """
    scenario = replace(_fitted(scenario, robot), geometry=robot.geometry or None)
    if scenario.imperfect is None:
        return scenario
    random = np.random.default_rng(scenario.draw)
    mass = 0.05 * float(robot.model.body_mass.sum())
    draws: dict[str, Any] = {
        "zero_offset": radians(0.5),
        "backlash": radians(0.5),
        "payload": (mass, *random.uniform(-0.01, 0.01, 2).tolist(), 0.02),
        "slope": (radians(random.uniform(0, 1)), random.uniform(-pi, pi)),
        "foot_friction": tuple(random.uniform(0.6, 1.0, len(robot.legs)).tolist()),
        "floor_stiffness": 1e4,
    }
    free = {name: value for name, value in draws.items() if scenario.leaves(name)}
    found = replace(scenario, imperfect=None, **free)
    if scenario.known != "given":
        return found
    kept = (n for n in known_of(scenario) if getattr(found, n) == getattr(scenario, n))
    return replace(found, known=tuple(kept) or "none")


def fitted_to(card: "Card", make: str) -> dict[str, object]:
    """What was fitted to a robot's logs, of its servos only what is of a make."""
    fit, makes = card.fitted.get("servo", card.make), ("ideal", *KNOWN_SERVOS)
    if (of := make_named(str(fit))) not in makes:
        what, near = f"fitted.servo = {fit!r} is unknown", did_you_mean(of, makes)
        raise UsageError(what, "the robot's card", near)
    return {k: v for k, v in card.fitted.items() if of == make or k not in OF_SERVOS}


def _fitted(scenario: Scenario, robot: "Robot") -> Scenario:
    card = f"the card of {robot}"
    known = (*FITTED, "servo", "joints", "source", "errors")
    found: dict[str, Any] = {}
    make = scenario.servo if scenario.servo not in (None, "own") else robot.card.make
    if scenario.servo_data:  # which is of the servos that there are now
        make = ""
    if robot.card.fitted.get("joints", joints := [*robot.card.joints]) != joints:
        raise UsageError.of("fitted_joints", card)
    for key, value in fitted_to(robot.card, make).items():
        if key not in known:
            raise UsageError.of("fitted", card, key=key, near=did_you_mean(key, known))
        if key in FITTED and scenario.leaves(key):
            kind, allowed = SETTINGS[key].kind, SETTINGS[key].allowed
            found[key] = accept(value, kind, allowed, card, key)
    return replace(scenario, **found) if found else scenario
