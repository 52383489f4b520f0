"""Robot cards in TOML, as a file or as a custom text of an MJCF file."""

from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path

from models.description import card
from models.description.servos import BOARD_CLOCK, NUMBERS, JointServo, make_named
from models.description.table import Table, parse_toml
from models.errors import ModelError, message
from planner.support import read_text

PLAIN = ("description", "lift_angle", "lift_time", "start", "fitted")
KEYS: dict[str, tuple[str, ...]] = dict.fromkeys(PLAIN, ()) | {
    "leg": ("swing", "lift", "raise", "foot", "hold"),
    "group": ("legs", "twist", "swing"),
    "gait": ("strata", "least_load"),
    "pattern": ("strata", "groups", "twist"),
    "servo": ("stiffness", "damping", "kind", *NUMBERS),
    "board": ("clock", "divider"),
    "learnt": ("numbers",),
}
JOINT_SERVO_KEYS = tuple(item.name for item in fields(JointServo))


def card_text(path: Path) -> str:
    """Text of a card's file."""
    try:
        return read_text(path, 10**6)
    except (ValueError, OSError) as error:
        why = getattr(error, "strerror", error)
        raise ModelError(f"bad robot card: {path}; {why}") from error


def parse_card(text: str, source: str) -> card.Card:
    """A robot card from TOML, as in docs/robots.md; refusals name its source."""
    try:
        return _card(Table(parse_toml(text), known=KEYS))
    except ValueError as error:
        raise ModelError(f"bad robot card: {source}; {error}") from error


def _card(table: Table) -> card.Card:
    gait = Table(table.get("gait"), "gait", KEYS["gait"])
    board, learnt = (table.table(key, KEYS[key]) for key in ("board", "learnt"))
    return card.Card(
        lift_angle=table.number("lift_angle"),
        legs={_leg_number(name): _leg(t) for name, t in _each(table, "leg")},
        groups={name: _group(t) for name, t in _each(table, "group")},
        gait=gait.texts("strata"),
        patterns={
            name: t.make(
                card.PatternCard,
                strata=t.texts("strata"),
                groups=t.gains("groups", required=True),
                twist=_twist(t),
            )
            for name, t in (_each(table, "pattern") if "pattern" in table else ())
        },
        least_load=gait.number("least_load", 0.0),
        lift_time=table.number("lift_time", card.LIFT_TIME),
        servo=_servo(table.table("servo")) if "servo" in table else None,
        joint_servos={
            joint: _joint_servo(Table(value, f"servo.{joint}", JOINT_SERVO_KEYS))
            for joint, value in table.table("servo").values.items()
            if isinstance(value, dict)
        },
        board_clock=board.number("clock", BOARD_CLOCK),
        board_divider=board.whole("divider", 0),
        start=table.gains("start"),
        learnt=learnt.numbers("numbers") if "learnt" in table else (),
        fitted=table.table("fitted").values,
        description=table.text("description", ""),
    )


def _each(table: Table, key: str) -> Iterable[tuple[str, Table]]:
    """Entries of a table of tables."""
    return table.tables(key, KEYS[key]).items()


def _leg_number(name: str) -> int:
    if not name.isdecimal() or name != str(int(name)):
        raise ValueError(f"leg.{name}: legs have numbers, such as [leg.1]")
    return int(name)


def _group(table: Table) -> card.GroupCard:
    gains = table.gains("legs", required=True)
    legs = {_leg_number(leg): gain for leg, gain in gains.items()}
    ends = "the lowest and the highest angle [rad]"
    swing = table.numbers("swing", 2, ends) if "swing" in table else None
    return table.make(card.GroupCard, legs=legs, twist=_twist(table), swing=swing)


def _leg(table: Table) -> card.LegCard:
    parts = {"foot": table.texts("foot"), "hold": table.gains("hold")}
    joints = {key: table.text(key) for key in ("swing", "lift")}
    raised = table.number("raise", 1)
    return table.make(card.LegCard, raise_sign=raised, **joints, **parts)


def _servo(servo: Table) -> card.Servo | None:
    """The servo of all joints; None where only single ones are described."""
    common = {k: v for k, v in servo.values.items() if not isinstance(v, dict)}
    if servo.values and not common:
        return None
    table = Table(common, "servo", KEYS["servo"])
    kind = make_named(table.text("kind", ""))
    data = {key: table.number(key) for key in NUMBERS if kind and key in table}
    made = card.made_of(kind, data) if kind else None
    if double := [key for key in ("stiffness", "damping") if kind and key in table]:
        raise ValueError(message("of_make", key=double[0], kind=kind))
    return table.make(
        card.Servo,
        stiffness=table.number("stiffness", made.stiffness if made else None),
        damping=table.number("damping", made.lost_torque if made else None),
        made=kind,
        armature=table.number("armature", 0.0),
        data=data,
    )


def _joint_servo(table: Table) -> JointServo:
    other: dict[str, Callable[[str], object]]
    other = {"channel": table.whole, "limits": table.numbers}
    given = {key: other.get(key, table.number)(key) for key in table.values}
    return table.make(JointServo, **given)


def _twist(table: Table) -> card.Twist | None:
    if "twist" not in table:
        return None
    return table.numbers("twist", 3, "forward, left [m/rad], yaw [rad/rad]")
