"""The servos of a simulated walk: ideal ones, the robot's own, or a known make."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Literal

from models import Card, ServoKind
from models.description import KNOWN_SERVOS, board_rate, servo_of
from planner.support import did_you_mean
from sim.errors import UsageError
from sim.scenarios.scenario import Scenario

SOFT_STIFFNESS = 300.0  # [N m/rad]; docs/fidelity.md has the errors of softer servos


@dataclass(frozen=True, slots=True, kw_only=True)
class ServoSettings:
    """Servos as they are simulated; None leaves a number to the robot's file."""

    name: str  # `ideal`, or the make
    stiffness: float | None  # torque an error [N m/rad]
    damping: float | None  # torque a speed [N m s/rad]
    damping_ratio: float | None = None  # to the critical one, where no damping is given
    torque: float | None = None  # largest [N m]; None for no limit but the file's
    speed: float | None = None  # at which no torque is left [rad/s]
    rate: float  # commands a second; 0 for one a physics step
    resolution: float  # angle of a count [rad]; 0 for none
    armature: float | None = None  # of the motor, where a file has none
    kind: ServoKind | None = None  # the make, or what a data sheet gives, unless ideal
    # Whether to make up for loads, rehearsed or predicted; None by the stiffness.
    feed_forward: bool | Literal["predicted"] | None

    def feeds_forward(self, stiffness: float) -> bool:
        """Whether commands make up for loads, on servos of a stiffness [N m/rad]."""
        soft, asked = stiffness < SOFT_STIFFNESS, self.feed_forward
        return soft if asked is None else bool(asked)

    def table(self, simulated: tuple[float, float] | None) -> dict[str, object]:
        """As summary.json has it."""
        table = asdict(self)
        for key in ("damping_ratio", "armature", "kind"):  # what they came to is there
            del table[key]
        if simulated is not None:
            table["stiffness"], table["damping"] = simulated
        return table


def servo_settings(scenario: Scenario, card: Card) -> ServoSettings:
    """The servos that a scenario asks for; its numbers win over those of the make."""
    own = card.servo.made if card.servo is not None else ""
    name = scenario.servo or ("own" if own else "ideal")
    make = own if name == "own" else name
    asked = ServoSettings(
        name=make,
        stiffness=scenario.servo_stiffness,
        damping=scenario.servo_damping,
        rate=scenario.command_rate or 0.0,
        resolution=scenario.resolution or 0.0,
        feed_forward=scenario.feed_forward,
    )
    if name == "ideal":
        return asked
    data = card.servo.data if card.servo is not None and make == own else {}
    kind = _kind(make, {**data, **(scenario.servo_data or {})}, scenario)
    rate, resolution = asked.rate, asked.resolution
    if scenario.command_rate is not None:
        kind = kind.at_rate(rate)
    elif kind.signal == "pulse":
        kind = kind.at_rate(board_rate(kind.command_rate, card.board_clock))
    return replace(
        asked,
        stiffness=kind.stiffness if asked.stiffness is None else asked.stiffness,
        damping_ratio=1.0 if asked.damping is None else None,
        torque=kind.stall_torque,
        speed=kind.no_load_speed,
        rate=kind.command_rate if scenario.command_rate is None else rate,
        resolution=kind.resolution if scenario.resolution is None else resolution,
        armature=kind.rotor,
        kind=kind,
    )


def _kind(name: str, data: Mapping[str, float], scenario: Scenario) -> ServoKind:
    where = f"scenario {scenario.name!r}"
    if not name:
        raise UsageError(
            "servo = 'own', but the robot's card names no make",
            where,
            'give kind under [servo] in the card, or servo = "ideal"',
        )
    if name.lower() not in KNOWN_SERVOS:
        remedy = did_you_mean(name.lower(), ("ideal", "own", *KNOWN_SERVOS))
        raise UsageError(f"servo = {name!r} is unknown", where, remedy)
    try:
        return servo_of(name, data)
    except ValueError as error:
        remedy = f"{error}, in servo_data"
        raise UsageError(f"servo = {name!r}", where, remedy) from error
