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
    description: str = setting(Text(empty=True), "one line for people", "")
    robot: str = setting(
        Text(), "a shipped robot, or a path to an MJCF file", "hexapod"
    )
    geometry: Mapping[str, float] | None = setting(
        Named(), "numbers of a shipped robot's shape that are to be others", None
    )
    fields: Literal["lifted", "paper"] = setting(
        Choice(("lifted", "paper")), "fields to steer with", "lifted"
    )
    stance: Literal["centred", "paper"] | None = setting(
        Choice(("centred", "paper")),
        "order of the flows: sweeps centred, or as printed",
        None,
    )
    words: Literal["printed", "shortest", "symmetric"] = setting(
        Choice(("printed", "shortest", "symmetric")),
        "flows of a segment: the paper's, those that sweep least, or mirrored in turn",
        "printed",
    )
    degree: int | None = setting(
        Number(1, 8, whole=True), "of the nilpotent approximation, Sec. 6", None
    )
    gait: tuple[str, ...] | None = setting(
        Texts(), "order in which strata are visited, eq. (11); any order if open", None
    )
    segments: int = setting(
        Number(1, 100_000, whole=True), "pieces that the nominal path is planned in", 20
    )
    replan: bool = setting(Flag(), "plan each segment from the pose reached", False)
    learn: bool | None = setting(
        Flag(),
        "replanning allows for what it missed before; of itself on imperfect robots",
        None,
    )
    steer: Literal["ideal", "quasi-static", "identified"] = setting(
        Choice(("ideal", "quasi-static", "identified")),
        "prediction to steer on",
        "ideal",
    )
    optimise: Literal["none", "time", "strokes", "switches"] = setting(
        Choice(("none", "time", "strokes", "switches")),
        "what an optimised plan has least of; none walks the stratified plan",
        "none",
    )
    path_tolerance: float | None = setting(
        Number(0, 100, above=True),
        "farthest that an optimised plan strays from the path [m]",
        None,
    )
    yaw_tolerance: float | None = setting(
        Number(0, 1e3, above=True),
        "farthest that it strays from the path's yaw [rad]; pi leaves the yaw free",
        None,
    )
    together: bool = setting(Flag(), "legs in the air recover during strokes", False)
    correct: int = setting(
        Number(1, 20, whole=True),
        "walks, each aimed beside the goal by what the one before missed",
        1,
    )
    friction: float = setting(Number(0, 10), "sliding friction, feet and floor", 1.0)
    timestep: float = setting(Number(1e-6, 0.02), "of the physics [s]", 0.0005)
    servo_stiffness: float | None = setting(
        Number(0, 1e6, above=True), "of every joint's servo [N m/rad]", None
    )
    servo_damping: float | None = setting(
        Number(0, 1e6), "of every joint's servo [N m s/rad]", None
    )
    servo: str | None = setting(
        Text(), "ideal, own (the robot's), or a make by name", None
    )
    command_rate: float | None = setting(
        Number(0, 1e5), "commands a second; 0 for one a physics step [1/s]", None
    )
    resolution: float | None = setting(
        Number(0, 0.2), "angle of one count of a servo's command [rad]", None
    )
    feed_forward: bool | None = setting(
        Flag(), "commands lead by what the load bends; of itself for soft servos", None
    )
    command_delay: float = setting(
        Number(0, 0.5), "from a command to the servo's motion [s]", 0.0
    )
    dead_band: float = setting(
        Number(0, 0.2), "range of error in which a servo gives no torque [rad]", 0.0
    )
    zero_offset: float = setting(
        Number(0, 0.2), "by which zeros of servos are off, drawn up to this [rad]", 0.0
    )
    play: float = setting(Number(0, 0.2), "of every leg joint's gears [rad]", 0.0)
    payload: tuple[float, ...] | None = setting(
        Numbers((Number(0, 1e3), *[Number(-10, 10)] * 3)),
        "on the body: mass [kg], and its place x, y, z [m]",
        None,
    )
    slope: tuple[float, ...] | None = setting(
        Numbers((Number(0, 1), Number(-7, 7))),
        "of the floor: its angle, and the direction that goes down [rad]",
        None,
    )
    floor_stiffness: float | None = setting(
        Number(100, 1e7), "of the floor's contact, as MuJoCo's solref has it", None
    )
    foot_friction: tuple[float, ...] | None = setting(
        Numbers((Number(0, 10),), any_length=True), "of each foot, in leg order", None
    )
    bumps: float = setting(Number(0, 0.1), "of the floor, so high at most [m]", 0.0)
    draw: int = setting(
        Number(0, 2**32 - 1, whole=True), "of everything that is drawn but the way", 0
    )
    swing_speed: float = setting(
        Number(0, 100, above=True), "highest speed of a swing joint [rad/s]", 0.5
    )
    swing_acceleration: float = setting(
        Number(0, 1e4, above=True), "highest acceleration of a swing [rad/s2]", 5.0
    )
    lift_height: float | None = setting(
        Number(0, 1, above=True), "of a lifted foot above the floor [m]", None
    )
    hold: float = setting(
        Number(0, 60, above=True), "standing still before and after the walk [s]", 0.5
    )
    plan_time: float = setting(
        Number(0, 1e5, above=True), "that planning may take at most [s]", 300.0
    )
    min_margin: float | None = setting(
        Number(0, 1), "least stability margin a plan may predict [m]", None
    )
    min_clearance: float = setting(
        Number(-1, 1),
        "least distance from obstacles a plan may predict [m]; -1 asks for none",
        0.002,
    )
    allow_unstable: bool = setting(
        Flag(), "walk plans that are predicted to tip over or to collide", False
    )
    sample_every: int = setting(
        Number(1, 1_000_000, whole=True), "physics steps between recorded rows", 20
    )
    playback: float | None = setting(
        Number(0, 1000, above=True), "speed of the film against real time", None
    )
    seed: int = setting(
        Number(0, 2**32 - 1, whole=True),
        "of the search for a way, where only a goal is given",
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
