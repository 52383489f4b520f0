"""Every setting of a scenario, declared once: type, limits, unit, meaning, effects.

The keys of scenario files, `--set`, the options of commands, scenario.toml, the table
in docs/scenarios.md and what the walks of a sweep have in common follow from these
declarations. To add one, add a field to `Settings`, and read it where it takes effect.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import partial
from typing import Annotated, Literal, get_type_hints

from sim.errors import UsageError
from sim.scenarios.declaration import LEAST, Range, Setting, Text, accept, setting

imperfection = partial(setting, imperfection=True)
Mass = Annotated[float, Range(0, 1e3)]
Off = Annotated[float, Range(0, 0)]
Width = Off | Annotated[float, Range(LEAST, 0.2)]  # of slack
Zero = Annotated[float, Range(-0.2, 0.2)]
Coordinate = Annotated[float, Range(-10, 10)]
Slope = Annotated[float, Range(0, 1)]
Direction = Annotated[float, Range(-7, 7)]
Predicted = Literal["ideal", "quasi_static", "identified", "compliant"]


@dataclass(frozen=True, kw_only=True)
class Settings:
    """All settings of a scenario; its path and obstacles stand in `Scenario`.

    A setting that is None is left to the robot (its servo, its lift) or to the run. A
    value outside its limits is refused, with key, value and limits.
    """

    name: Annotated[str, Text(file_name=True)] = setting(
        "names the run folder", MISSING, "label"
    )
    description: Annotated[str, Text(empty=True)] = setting(
        "what the scenario is, in one line", "", "label"
    )
    robot: str = setting(
        "a shipped robot, or a path to an MJCF file", "hexapod", "equations"
    )
    geometry: Mapping[str, float] | None = setting(
        "changed numbers of a shipped robot's shape, by name", None, "equations"
    )
    fields: Literal["lifted", "paper"] = setting(
        "vector fields to steer with", "lifted", "equations"
    )
    stance: Literal["centred", "paper"] | None = setting(
        "order of the flows: with centred strokes, or as in the paper", None, "plan"
    )
    words: Literal["printed", "shortest", "symmetric"] = setting(
        "words of flows: the paper's, shortest, or mirrored by turns", "printed", "plan"
    )
    degree: Annotated[int, Range(1, 8)] | None = setting(
        "degree of the nilpotent approximation, Sec. 6", None, "equations"
    )
    gait: tuple[str, ...] | None = setting(
        "order in which strata are visited, eq. (11); free if not given", None, "plan"
    )
    motion: str | None = setting(
        "log of joint angles to play in place of a plan", None, ("plan", "world")
    )
    segments: Annotated[int, Range(1, 100_000)] = setting(
        "pieces into which the path is cut; each is planned on its own", 20, "plan"
    )
    replan: bool = setting(
        "plan each segment from the pose that was reached", False, "plan"
    )
    learn: bool | None = setting(
        "learn from errors of segments; if not given, imperfect robots do", None, "plan"
    )
    sense: Literal["exact", "mocap", "tag", "gyro"] = setting(
        "poses for replanning: exact, or by mocap, a camera, or a gyro", "exact", "plan"
    )
    sense_position: Annotated[float, Range(0, 1)] | None = setting(
        "standard deviation of a reading of x and of y", None, "plan", "m"
    )
    sense_yaw: Annotated[float, Range(0, 4)] | None = setting(
        "standard deviation of a reading of the yaw", None, "plan", "rad"
    )
    sense_readings: Annotated[int, Range(1, 10_000)] | None = setting(
        "readings that are averaged at a stop", None, "plan"
    )
    sense_delay: Annotated[float, Range(0, 10)] | None = setting(
        "time that a reading takes, for which the robot stands still", None, "plan", "s"
    )
    sense_every: Annotated[int, Range(1, 100_000)] = setting(
        "segments from one stop with readings to the next", 1, "plan"
    )
    sense_until: Annotated[int, Range(0, 100_000)] | None = setting(
        "number of segments after which readings end", None, "plan"
    )
    sense_lost: Annotated[float, Range(0, 1)] = setting(
        "share of stops whose reading is lost", 0.0, "plan"
    )
    sense_wild: Annotated[float, Range(0, 1)] = setting(
        "share of stops whose reading is wrong by up to 0.1 m and 0.5 rad", 0.0, "plan"
    )
    gyro_noise: Annotated[float, Range(0, 1)] | None = setting(
        "growth of a gyro's error, else the sensor's", None, "plan", "rad/sqrt(s)"
    )
    gyro_drift: Annotated[float, Range(0, 1)] | None = setting(
        "standard deviation of its constant, unknown error", None, "plan", "rad/s"
    )
    sense_draw: Annotated[int, Range(0, 2**32 - 1)] = setting(
        "number of the random draw of the errors of sensors", 0, "plan"
    )
    learnt: tuple[Annotated[float, Range(-1e6, 1e6)], ...] | None = setting(
        "what an earlier walk has learnt: its learnt.toml, or numbers", None, "plan"
    )
    steer: Literal["ideal", "quasi-static", "identified", "compliant"] = setting(
        "prediction that is to reach the goal; ideal: not steered", "ideal", "plan"
    )
    optimise: Literal["none", "time", "strokes", "switches"] = setting(
        "what an optimised plan minimises; none: nothing is optimised", "none", "plan"
    )
    path_tolerance: Annotated[float, Range(LEAST, 100)] | None = setting(
        "how far an optimised plan may depart from the path", None, "plan", "m"
    )
    yaw_tolerance: Annotated[float, Range(LEAST, 1e3)] | None = setting(
        "how far such a plan may depart in yaw; pi leaves it free", None, "plan", "rad"
    )
    hops: Annotated[int, Range(0, 10_000)] = setting(
        "times that the search for an optimised plan starts again", 130, "plan"
    )
    overlap_recovery: bool = setting(
        "recover lifted legs while others stroke", False, "plan", formerly="together"
    )
    correct: Annotated[int, Range(1, 20)] = setting(
        "number of walks; each aims to cancel the error of the one before", 1, "plan"
    )
    friction: Annotated[float, Range(0, 10)] = setting(
        "coefficient of sliding friction of feet and floor", 1.0, "world"
    )
    timestep: Annotated[float, Range(1e-6, 0.02)] = setting(
        "time step of the physics", 0.001, ("world", "motion"), "s"
    )
    servo_stiffness: Annotated[float, Range(LEAST, 1e6)] | None = setting(
        "stiffness of every servo", None, ("world", "drive"), "N m/rad"
    )
    servo_damping: Annotated[float, Range(0, 1e6)] | None = setting(
        "damping of every servo", None, ("world", "drive"), "N m s/rad"
    )
    servo: str | None = setting(
        "kind of the servos: ideal, own (the robot's), a make by name, pulse or bus",
        None,
        ("plan", "world", "drive"),  # strokes may end on whole counts
    )
    servo_data: Mapping[str, float] | None = setting(
        "numbers of the servo's data sheet, by name", None, ("plan", "world", "drive")
    )
    command_rate: Off | Annotated[float, Range(LEAST, 1e5)] | None = setting(
        "commands a second; 0 for one every step", None, ("world", "drive"), "1/s"
    )
    resolution: Off | Annotated[float, Range(LEAST, 0.2)] | None = setting(
        "angle of one count of a servo's command", None, ("plan", "drive"), "rad"
    )
    feed_forward: bool | Literal["predicted"] | None = setting(
        "add the deflection by loads; if not given, on soft servos only", None, "drive"
    )
    command_delay: Annotated[float, Range(0, 0.5)] = imperfection(
        "delay from a command to the servo's motion", 0.0, "drive", "s"
    )
    dead_band: Literal["own"] | Width | tuple[Width, ...] = imperfection(
        "width of the range without torque; own: that of the make", 0.0, "world", "rad"
    )
    dead_band_spread: Annotated[float, Range(0, 1)] = imperfection(
        "share by which dead bands differ at random", 0.0, "world"
    )
    assumed_dead_band: Width | tuple[Width, ...] | None = setting(
        "dead band to allow for; dead_band if not given", None, "drive", "rad"
    )
    dead_band_law: Literal["offset", "step"] = setting(
        "torque beyond the band: of the excess or of the whole error", "offset", "world"
    )
    zero_offset: Annotated[float, Range(0, 0.2)] | tuple[Zero, ...] = imperfection(
        "largest random error of servos' zeros, or each error", 0.0, "drive", "rad"
    )
    backlash: Width = imperfection(
        "backlash in the gears of every leg joint", 0.0, "world", "rad", formerly="play"
    )
    assumed_backlash: Width = setting("backlash to allow for", 0.0, "drive", "rad")
    payload: tuple[Mass, Coordinate, Coordinate, Coordinate] | None = imperfection(
        "mass on the body, and its place x, y, z", None, "world", "kg, m"
    )
    slope: tuple[Slope, Direction] | None = imperfection(
        "angle of the floor, and the direction that goes down", None, "world", "rad"
    )
    floor_stiffness: Annotated[float, Range(100, 1e7)] | None = imperfection(
        "stiffness of the floor, as in solref; 1e5 if not given", None, "world", "1/s^2"
    )
    foot_friction: tuple[Annotated[float, Range(0, 10)], ...] | None = imperfection(
        "coefficient of friction of each foot, in the order of the legs", None, "world"
    )
    bumps: Off | Annotated[float, Range(LEAST, 0.1)] = imperfection(
        "greatest height of bumps in the floor", 0.0, "world", "m"
    )
    imperfect: Literal["hobby"] | None = imperfection(
        "set of random imperfections, where none are given", None, ("world", "drive")
    )
    predictions: tuple[Predicted, ...] | None = setting(
        "predictions to make beside the ideal one; all if not given", None, "rows"
    )
    known: Literal["given", "all", "none"] | tuple[str, ...] = setting(
        "imperfections that the compliant prediction knows", "given", "known"
    )
    draw: Annotated[int, Range(0, 2**32 - 1)] = setting(
        "number of the draw of random imperfections", 0, ("world", "drive")
    )
    swing_speed: Annotated[float, Range(LEAST, 100)] = setting(
        "highest speed of a swing joint", 0.5, "motion", "rad/s"
    )
    swing_acceleration: Annotated[float, Range(LEAST, 1e4)] = setting(
        "highest acceleration of a swing joint", 5.0, "motion", "rad/s^2"
    )
    lift_height: Annotated[float, Range(LEAST, 1)] | None = setting(
        "height of a lifted foot above the floor", None, "motion", "m"
    )
    hold: Annotated[float, Range(LEAST, 60)] = setting(
        "time of standing still before and after the walk", 0.5, "motion", "s"
    )
    plan_time: Annotated[float, Range(LEAST, 1e5)] = setting(
        "longest time that planning may take", 300.0, "refusal", "s"
    )
    min_margin: Annotated[float, Range(0, 1)] | None = setting(
        "least stability margin that a plan may predict", None, ("plan", "refusal"), "m"
    )
    min_clearance: Annotated[float, Range(-1, 1)] = setting(
        "least distance of plans to obstacles; -1: any", 0.002, ("plan", "refusal"), "m"
    )
    allow_unstable: bool = setting(
        "walk plans that are predicted to tip over or to collide", False, "refusal"
    )
    sample_every: Annotated[int, Range(1, 1_000_000)] = setting(
        "physics steps between recorded rows", 10, "rows"
    )
    playback: Annotated[float, Range(LEAST, 1000)] | None = setting(
        "film speed (1: real time); fits the walk if not given", None, "film"
    )
    seed: Annotated[int, Range(0, 2**32 - 1)] = setting(
        "seed of the search for a way around obstacles", 0, "plan"
    )

    def __post_init__(self) -> None:
        where = f"scenario {self.name!r}"
        for key, declared in SETTINGS.items():
            if (value := getattr(self, key)) is declared.default:
                continue  # and allowed; a sweep makes many scenarios
            value = accept(value, declared.kind, declared.allowed, where, key)
            object.__setattr__(self, key, value)
        once = "steer" if self.steer == "compliant" else "optimise"
        if self.replan and (once == "steer" or self.optimise != "none"):
            whole = f"{once} = {getattr(self, once)!r} plans the whole path at once"
            raise UsageError.of("but_replan", where, whole=whole)


_KINDS = get_type_hints(Settings, include_extras=True)
SETTINGS: Mapping[str, Setting] = {
    item.name: Setting(item.name, _KINDS[item.name], item.default, **item.metadata)
    for item in fields(Settings)
}  # what is declared about every setting, by its name
FORMER = {item.formerly: name for name, item in SETTINGS.items() if item.formerly}
"""The names of settings by those that they had before."""
IMPERFECTIONS = tuple(name for name, item in SETTINGS.items() if item.imperfection)
"""Settings that plans and predictions know nothing of; by default there are none."""
