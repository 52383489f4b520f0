"""A scenario: which robot walks which nominal path, with which settings.

Declares every setting once, with its limits and its meaning. Reading and writing files
is done by `scenarios.file`, running one by `sim.simulate`.
"""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from dataclasses import Field, dataclass, fields
from typing import Any, Literal

from sim.errors import UsageError
from sim.scenarios.body_path import NominalPath
from sim.scenarios.obstacles import Obstacle
from sim.scenarios.settings import (
    Choice,
    Either,
    Flag,
    Named,
    Number,
    Numbers,
    Text,
    Texts,
    setting,
)


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """Everything that determines a run, immutable.

    A setting that is None is left to the robot (its servo, its lift) or to the run.

    Raises:
        UsageError: If a value is outside its limits, naming key, value and limits.
    """

    name: str = setting(Text(file_name=True), "names the run folder")
    description: str = setting(
        Text(empty=True), "what the scenario is, in one line", ""
    )
    robot: str = setting(
        Text(), "a shipped robot, or a path to an MJCF file", "hexapod"
    )
    geometry: Mapping[str, float] | None = setting(
        Named(), "changed numbers of a shipped robot's shape, by name", None
    )
    fields: Literal["lifted", "paper"] = setting(
        Choice(("lifted", "paper")), "vector fields to steer with", "lifted"
    )
    stance: Literal["centred", "paper"] | None = setting(
        Choice(("centred", "paper")),
        "order of the flows: strokes centred, or as the paper prints them",
        None,
    )
    words: Literal["printed", "shortest", "symmetric"] = setting(
        Choice(("printed", "shortest", "symmetric")),
        "flows of a segment: the paper's, those of least stroke, or mirrored in turn",
        "printed",
    )
    degree: int | None = setting(
        Number(1, 8, whole=True), "degree of the nilpotent approximation, Sec. 6", None
    )
    gait: tuple[str, ...] | None = setting(
        Texts(),
        "order in which strata are visited, eq. (11); any order if not given",
        None,
    )
    segments: int = setting(
        Number(1, 100_000, whole=True),
        "pieces into which the path is cut; each is planned for itself",
        20,
    )
    replan: bool = setting(
        Flag(), "plan each segment from the pose that was reached", False
    )
    learn: bool | None = setting(
        Flag(),
        "let replanning learn from earlier misses; if not given, imperfect robots do",
        None,
    )
    steer: Literal["ideal", "quasi-static", "identified"] = setting(
        Choice(("ideal", "quasi-static", "identified")),
        "prediction that is to reach the goal",
        "ideal",
    )
    optimise: Literal["none", "time", "strokes", "switches"] = setting(
        Choice(("none", "time", "strokes", "switches")),
        "what is to be least in an optimised plan; none keeps the stratified plan",
        "none",
    )
    path_tolerance: float | None = setting(
        Number(0, 100, above=True),
        "how far an optimised plan may stray from the path [m]",
        None,
    )
    yaw_tolerance: float | None = setting(
        Number(0, 1e3, above=True),
        "how far it may stray from the path's yaw [rad]; pi leaves the yaw free",
        None,
    )
    together: bool = setting(
        Flag(), "let legs in the air recover while others stroke", False
    )
    correct: int = setting(
        Number(1, 20, whole=True),
        "number of walks; each is aimed to cancel what the one before missed",
        1,
    )
    friction: float = setting(
        Number(0, 10), "coefficient of sliding friction of feet and floor", 1.0
    )
    timestep: float = setting(Number(1e-6, 0.02), "time step of the physics [s]", 0.001)
    servo_stiffness: float | None = setting(
        Number(0, 1e6, above=True), "stiffness of every servo [N m/rad]", None
    )
    servo_damping: float | None = setting(
        Number(0, 1e6), "damping of every servo [N m s/rad]", None
    )
    servo: str | None = setting(
        Text(), "kind of the servos: ideal, own (the robot's), or a make by name", None
    )
    command_rate: float | None = setting(
        Number(0, 1e5),
        "commands a second [1/s]; 0 gives one at every physics step",
        None,
    )
    resolution: float | None = setting(
        Number(0, 0.2), "angle of one count of a servo's command [rad]", None
    )
    feed_forward: bool | None = setting(
        Flag(),
        "let commands lead by what loads bend; if not given, for soft servos only",
        None,
    )
    command_delay: float = setting(
        Number(0, 0.5), "delay from a command to the servo's motion [s]", 0.0
    )
    dead_band: float = setting(
        Number(0, 0.2), "range of error in which a servo gives no torque [rad]", 0.0
    )
    zero_offset: float | tuple[float, ...] = setting(
        Either((Number(0, 0.2), Numbers((Number(-0.2, 0.2),), any_length=True))),
        "largest error of the servos' zeros, drawn at random, or that of each [rad]",
        0.0,
    )
    play: float = setting(
        Number(0, 0.2), "play in the gears of every leg joint [rad]", 0.0
    )
    payload: tuple[float, ...] | None = setting(
        Numbers((Number(0, 1e3), *[Number(-10, 10)] * 3)),
        "mass on the body [kg], and its place x, y, z [m]",
        None,
    )
    slope: tuple[float, ...] | None = setting(
        Numbers((Number(0, 1), Number(-7, 7))),
        "angle of the floor, and the direction that goes down [rad]",
        None,
    )
    floor_stiffness: float | None = setting(
        Number(100, 1e7),
        "stiffness of the floor's contact, as MuJoCo's solref has it",
        None,
    )
    foot_friction: tuple[float, ...] | None = setting(
        Numbers((Number(0, 10),), any_length=True),
        "coefficient of friction of each foot, in the order of the legs",
        None,
    )
    bumps: float = setting(
        Number(0, 0.1), "greatest height of bumps in the floor [m]", 0.0
    )
    draw: int = setting(
        Number(0, 2**32 - 1, whole=True),
        "number of the random draw of zeros, feet and floor",
        0,
    )
    swing_speed: float = setting(
        Number(0, 100, above=True), "highest speed of a swing joint [rad/s]", 0.5
    )
    swing_acceleration: float = setting(
        Number(0, 1e4, above=True),
        "highest acceleration of a swing joint [rad/s2]",
        5.0,
    )
    lift_height: float | None = setting(
        Number(0, 1, above=True), "height of a lifted foot above the floor [m]", None
    )
    hold: float = setting(
        Number(0, 60, above=True),
        "time of standing still before and after the walk [s]",
        0.5,
    )
    plan_time: float = setting(
        Number(0, 1e5, above=True), "longest time that planning may take [s]", 300.0
    )
    min_margin: float | None = setting(
        Number(0, 1), "least stability margin that a plan may predict [m]", None
    )
    min_clearance: float = setting(
        Number(-1, 1),
        "least distance from obstacles that a plan may predict [m]; -1 for any",
        0.002,
    )
    allow_unstable: bool = setting(
        Flag(), "walk plans that are predicted to tip over or to collide", False
    )
    sample_every: int = setting(
        Number(1, 1_000_000, whole=True), "physics steps between recorded rows", 10
    )
    playback: float | None = setting(
        Number(0, 1000, above=True),
        "speed of the film, in times real time; if not given, it fits the walk",
        None,
    )
    seed: int = setting(
        Number(0, 2**32 - 1, whole=True),
        "seed of the search for a way around obstacles",
        0,
    )
    obstacles: tuple[Obstacle, ...] = ()
    path: NominalPath

    def __post_init__(self) -> None:
        for item in settings():
            self._accept(item)
        if self.optimise != "none" and self.replan:
            raise UsageError(
                f"optimise = {self.optimise!r} plans the whole path at once, but "
                "replan plans it piece by piece",
                f"scenario {self.name!r}",
                "leave one of them out",
            )

    def _accept(self, item: Field[Any]) -> None:
        value, kind = getattr(self, item.name), item.metadata["kind"]
        if value is None and item.default is None:
            return
        try:
            object.__setattr__(self, item.name, kind.accept(value))
        except ValueError:
            raise UsageError(
                f"{item.name} = {reprlib.repr(value)} is not allowed",
                f"scenario {self.name!r}",
                f"give {kind}",
            ) from None


def settings() -> tuple[Field[Any], ...]:
    """The fields of a scenario that are plain values; not the path, nor obstacles."""
    return tuple(item for item in fields(Scenario) if "kind" in item.metadata)
