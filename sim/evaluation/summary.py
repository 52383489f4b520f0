"""The numbers of summary.json as values of named types; docs/numbers.md defines them.

Fields can also be read by the keys of the file, as `summary["error"]["goal"]`.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, asdict, dataclass, field, fields
from typing import Any, Self

from sim.scenarios.predictions import PREDICTIONS, who_ignores

DEGREE = math.radians(1)  # of yaw, from which on it is put into words
NEAR = 0.02  # of the path: with yaw within a degree, as good as there


class Numbers(Mapping[str, Any]):
    """Fields of a dataclass that are also read by their names, as from a file."""

    def __getitem__(self, key: str) -> Any:
        return vars(self)[key]

    def __iter__(self) -> Iterator[str]:
        return iter(vars(self))

    def __len__(self) -> int:
        return len(vars(self))

    def to_json(self) -> dict[str, object]:
        """The fields as plain values, in the order of the file."""
        return asdict(self)  # type: ignore[call-overload]

    @classmethod
    def read(cls, table: Mapping[str, Any]) -> Self:
        """The values of a table, which may lack what has a default; else a KeyError."""
        items = fields(cls)  # type: ignore[arg-type]
        texts = (i.name for i in items if i.type is str and i.name in table)
        for name in (name for name in texts if not isinstance(table[name], str)):
            raise ValueError(f"{name} is {table[name]!r}, which is no text")
        required = {i.name for i in items if i.default is i.default_factory is MISSING}
        names = (i.name for i in items if i.name in table or i.name in required)
        return cls(**{name: table[name] for name in names})


@dataclass(frozen=True, kw_only=True, eq=False)
class Departure(Numbers):
    """How far a pose is from another one, or from a path."""

    position: float  # [m]
    yaw: float  # [rad]

    def __str__(self) -> str:
        """The position, and the yaw where it is more than a degree."""
        words = f"{1e3 * self.position:.2f} mm"
        if self.yaw > DEGREE:
            words += f" and {math.degrees(self.yaw):.1f} degrees"
        return words


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictionError(Departure):
    """How far the physics is from a prediction, at the end and on the way."""

    position_per_path: float | None = None
    position_per_walked: float | None = None
    farthest: float | None = None  # on the way [m]


@dataclass(frozen=True, kw_only=True, eq=False)
class Predicted(Numbers):
    """Where a prediction ends, and what it foresees on the way."""

    pose: list[float]
    min_margin: float  # [m]
    slip: float  # of all feet [m]
    min_clearance: float | None = None  # [m]; None where there are no obstacles
    ignores: str = ""  # settings of the scenario that it knows nothing of
    slip_swing: float | None = None  # [m], as of the physics
    slip_transition: float | None = None
    lets_go: Mapping[str, float] | None = None  # standing feet without load: when [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Weighed(Numbers):
    """What verdict and tolerance weigh: distances from goal and prediction."""

    prediction: str  # key of the one that the walk is judged by
    radius: float  # mean distance of the feet from the middle [m]
    length: float  # of the path; where it only turns, of the feet's way [m]
    goal: float | None  # from the goal at the end, as a share of that length
    ended: float  # from the prediction at the end
    farthest: float  # from the prediction at most

    @property
    def ended_well(self) -> bool:
        """Whether it is by goal and prediction; otherwise all shares contain yaw."""
        return max(self.goal or 0.0, self.ended) <= NEAR

    def beyond(self, tolerance: float) -> str:
        """What is farther off than a share of the path, in words; empty if nothing."""
        name = PREDICTIONS[self.prediction].label
        found = {"its goal": self.goal, f"the {name} prediction": self.farthest}
        words = " and ".join(
            f"{100 * share:.3g} % of its path off {what}"
            for what, share in found.items()
            if share is not None and share > tolerance
        )
        return words if self.ended_well or not words else f"{words}, yaw included"


@dataclass(frozen=True, kw_only=True, eq=False)
class Accomplished(Numbers):
    """Where the physics ends, and what happened on the way."""

    pose: list[float]
    min_margin: float  # [m]
    min_clearance: float | None = None  # [m]
    slip: float  # of all feet [m]
    slip_swing: float | None  # [m], where swings, lift-offs, touchdowns are told apart
    slip_transition: float | None  # [m], while legs lift and land
    slip_per_foot: Mapping[str, float]
    creep_floor: float | None  # slip while standing as long [m], if measured


@dataclass(frozen=True, kw_only=True, eq=False)
class Played(Numbers):
    """What came of an export that was played in the physics."""

    pose: list[float]
    min_margin: float  # [m]
    slip: float  # of all feet [m]
    bounces: int
    error: Mapping[str, Departure | None]  # from `goal` and what judges the walk
    weighed: Weighed
    changed: float  # from the walk itself at the end, as a share of the path


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensed(Numbers):
    """What feedback made of a walk, at its last stop before the reading there."""

    thought: list[float]  # pose
    wrong: float  # of the position that was thought [m]
    wrong_yaw: float  # [rad]
    claimed: float  # root mean square error that it claims for its position [m]
    claimed_yaw: float  # [rad]
    bound: float  # least that any estimator could claim [m]
    bound_yaw: float  # [rad]
    sees_position: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Departed(Numbers):
    """An angle of a real robot since the start, and how far off it the physics is."""

    end: float  # [rad]
    off: float  # at the end [rad]
    farthest: float  # on the way [rad]


@dataclass(frozen=True, kw_only=True, eq=False)
class Real(Numbers):
    """What was measured on a real robot that moved its joints alike."""

    pose: list[float] | None = None  # at the end
    spread: list[float] | None = None  # standard error of that, of several trials
    roll: Departed | None = None
    pitch: Departed | None = None
    joints: float | None = None  # of its angles off the simulated ones, rms [rad]
    contact: float | None = None  # share in which contacts are those of the physics
    done: list[str] = field(default_factory=list)  # to bring it onto this frame


@dataclass(frozen=True, kw_only=True, eq=False)
class PerMetre(Numbers):
    """What a metre of the nominal path takes; None where it has no length."""

    seconds: float | None = None
    strokes: float | None = None  # of the loaded groups [rad]


@dataclass(frozen=True, kw_only=True, eq=False)
class Summary(Numbers):
    """The numbers of a run; keys and order are those of summary.json.

    Predictions that could not be made are None, and `unpredicted` says why.
    """

    verdict: str = "not judged"
    verdict_text: str = "not judged"
    scenario: str
    robot: str
    fields: str
    stance: str
    segments: int
    replan: bool
    steer: str
    optimise: str = "none"
    together: bool = False  # overlapped recovery; columns of sweeps have this name
    correct: int = 1
    goal: list[float] | None = None  # of a motion that is played there is none
    path_length: float  # [m]
    distance_walked: float  # [m]
    contact_switches: int
    contact_switches_achieved: int
    swing_travel: float  # [rad]
    air_travel: float  # [rad]
    bounces: int
    wall_contacts: int = 0
    self_contacts: int = 0
    saturated_segments: int
    let_down: float = 0.0  # [m]
    fastest_swing: float = 0.0  # [rad/s]
    swing_speed: float = 0.0  # [rad/s]
    walk_starts: float  # [s]
    predicted: Mapping[str, Predicted | None]
    unpredicted: Mapping[str, str] = field(default_factory=dict)
    achieved: Accomplished
    error: Mapping[str, PredictionError | Departure | None]
    error_sources: Mapping[str, Mapping[str, list[float]] | None] | None = None
    servo: Mapping[str, object] = field(default_factory=dict)
    weighed: Weighed | None = None
    deviation: Mapping[str, Departure | None] = field(default_factory=dict)
    feedback: Sensed | None = None  # of a walk that is told its pose with noise
    measured: Real | None = None  # on a real robot
    per_metre: PerMetre = field(default_factory=PerMetre)
    simulated_time: float  # [s]
    timestep: float  # [s]
    versions: Mapping[str, str] = field(default_factory=dict)
    seals: Mapping[str, str | None] | None = None  # of the files of a run folder
    fallback: str | None = None
    least_time: float | None = None  # [s] of an optimised plan, holds left out
    hurried: bool = False  # whether the search for the plan was ended early
    missed: list[float] = field(default_factory=list)  # off the goal, by walk [m]
    timing: Mapping[str, float] = field(default_factory=dict)  # [s]

    @classmethod
    def read(cls, table: Mapping[str, Any]) -> Self:
        """The summary in a file's table, also in one of an older version."""
        given = table.get("weighed")
        inner: dict[str, object] = {
            "predicted": _each(Predicted, table["predicted"]),
            "achieved": Accomplished.read(table["achieved"]),
            "error": {
                key: error
                and (Departure if key == "goal" else PredictionError).read(error)
                for key, error in table["error"].items()
            },
            "weighed": given and Weighed.read(given),
            "deviation": _each(Departure, table.get("deviation", {})),
            "per_metre": PerMetre.read(table.get("per_metre", {})),
        }
        if (sensed := table.get("feedback")) is not None:
            inner["feedback"] = Sensed.read(sensed)
        if isinstance(real := table.get("measured"), Mapping):
            lean = _each(Departed, {k: real.get(k) for k in ("roll", "pitch")})
            inner["measured"] = Real.read({**real, **lean})
        return super().read({**table, **inner})

    def to_json(self) -> dict[str, object]:
        """The fields as plain values; what needs a goal or a folder may be absent."""
        table = super().to_json()
        if self.seals is None:
            del table["seals"]
        if self.goal is None:
            del table["goal"], table["missed"]
        if self.measured is None:
            del table["measured"]
        return table

    @property
    def poses(self) -> dict[str, list[float]]:
        """Where goal, predictions and physics end, by the rows of a comparison."""
        made = {key: found.pose for key, found in self.predicted.items() if found}
        goal = {} if self.goal is None else {"goal": self.goal}
        real = self.measured and self.measured.pose
        ends = {**goal, **made, "achieved": self.achieved.pose}
        return {**ends, "measured": real} if real else ends

    @property
    def ignored(self) -> str:
        """Which predictions ignore which settings, in words; empty if none does."""
        return who_ignores({k: p.ignores for k, p in self.predicted.items() if p})


def _each(kind: type[Numbers], table: Mapping[str, Any]) -> dict[str, Numbers | None]:
    return {key: None if one is None else kind.read(one) for key, one in table.items()}
