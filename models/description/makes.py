"""Makes of servo, each number with where it comes from.

Sources: *sheet* is the data sheet of the make, *sellers* its table in their shops,
*manual* its page of emanual.robotis.com/docs/en/dxl, *measured* the identification of
github.com/Rhoban/bam, *assumed* what nobody says. A dead band is the whole width of the
error without torque; pulse servos are assumed to give full voltage at three of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import pi, radians
from typing import Any

from models.description.servos import BOARD_COUNTS, ServoKind
from planner.support import unknown

KGF_CM = 0.0980665  # [N m]
SIXTY = pi / 3  # [rad]; data sheets give the time for 60 degrees
RATE = 50.0  # frames a second, which every pulse servo takes


def _pulse(
    torque: float,
    speed: float,
    volts: float,
    *,
    degrees: float,
    dead: float,
    source: str,
) -> ServoKind:
    """A servo of some range, 500 to 2500 us, with a dead band in microseconds."""
    a_microsecond, count = radians(degrees / 2000), 1e6 / BOARD_COUNTS / RATE
    return ServoKind(
        stall_torque=torque,
        no_load_speed=speed,
        volts=volts,
        dead_band=a_microsecond * dead,
        full_error=3 * a_microsecond * dead,
        command_rate=RATE,
        resolution=a_microsecond * count,
        center=round(1500 / count),
        reach=radians(degrees / 2),
        source=source,
    )


def _counts(number: int, degrees: float, rate: float = 100.0) -> dict[str, Any]:
    """A bus on which so many counts turn a servo by some degrees; rates are assumed."""
    return {
        "resolution": radians(degrees / number),
        "center": number // 2,
        "reach": radians(degrees / 2),
        "command_rate": rate,
        "signal": "bus",
    }


SERVO_KINDS = {
    "mg90": ServoKind(
        stall_torque=0.216,  # sheet: 2.2 kgf cm
        no_load_speed=13.1,  # sheet: 60 degrees in 0.08 s
        volts=6.0,  # sheet
        dead_band=radians(0.5),  # sheet: 5 us
        full_error=3 * radians(0.45),  # assumed
        command_rate=60.0,  # assumed: 50 to 333 are taken
        resolution=radians(180 / 350),  # counts of 4.07 us of a PCA9685 at 60 Hz
        center=365,  # assumed: 180 degrees (sheet) from 773 to 2197 us
        reach=radians(90),  # sheet
        armature=240**2 * 4e-9,  # assumed: 240 : 1 on a coreless rotor
        source="TowerPro MG90S data sheet, 6 V; NXP PCA9685 data sheet, 60 Hz",
    ),
    "sg90": _pulse(
        1.8 * KGF_CM,  # sheet
        SIXTY / 0.10,  # sheet
        4.8,  # sheet
        degrees=180,  # sheet; its pulses are assumed
        dead=10,  # sheet
        source="TowerPro SG90 data sheet, 4.8 V",
    ),
    "mg996r": _pulse(
        11 * KGF_CM,  # sheet
        SIXTY / 0.14,  # sheet
        6.0,  # sheet
        degrees=180,  # assumed, as its pulses are
        dead=5,  # sheet
        source="TowerPro MG996R data sheet, 6 V",
    ),
    "ds3218": _pulse(
        21.5 * KGF_CM,  # sellers
        SIXTY / 0.14,  # sellers
        6.8,  # sellers
        degrees=270,  # sellers, with its pulses
        dead=3,  # sellers
        source="tables of sellers of the DSServo DS3218, 6.8 V, 270 degrees",
    ),
    "ax-12": ServoKind(
        stall_torque=1.5,  # manual
        no_load_speed=6.18,  # manual: 59 revolutions a minute
        volts=12.0,  # manual
        dead_band=2 * radians(300 / 1024),  # manual: compliance margin 1, each side
        # manual: all torque eight counts from the goal with compliance slope 8; as
        # delivered the slope is 32, and the servo a quarter as stiff
        full_error=8 * radians(300 / 1024),
        **_counts(1024, 300),  # manual
        source="emanual.robotis.com/docs/en/dxl/ax/ax-12a, 12 V, compliance slope 8",
    ),
    "rx-28": ServoKind(
        stall_torque=3.7,  # manual
        no_load_speed=85 * 2 * pi / 60,  # manual: 85 revolutions a minute
        volts=18.5,  # manual
        dead_band=2 * radians(300 / 1024),  # manual: compliance margin 1, each side
        full_error=8 * radians(300 / 1024),  # manual: slope 8; as delivered it is 32
        **_counts(1024, 300),  # manual
        source="emanual.robotis.com/docs/en/dxl/rx/rx-28, 18.5 V, compliance slope 8",
    ),
    "xl-330": ServoKind(
        stall_torque=0.52,  # manual
        no_load_speed=10.8,  # manual: 103 revolutions a minute
        volts=5.0,  # manual
        dead_band=radians(360 / 4096),  # assumed: the error is in whole counts
        # manual: gain / 128 of 885 steps of voltage a count, all at 14 counts with a
        # gain of 8000; as delivered it is 400, and the servo a twentieth as stiff
        full_error=885 * 128 / 8000 * radians(360 / 4096),
        armature=0.0017,  # measured
        **_counts(4096, 360),  # manual
        source="emanual.robotis.com/docs/en/dxl/x/xl330-m288, 5 V, P gain 8000",
    ),
    "sts3215": ServoKind(
        stall_torque=19.5 * KGF_CM,  # sheet
        no_load_speed=SIXTY / 0.192,  # sheet
        volts=7.4,  # sheet
        dead_band=2 * radians(360 / 4096),  # memory table: a count on each side
        full_error=1 / (32 * 0.166),  # measured: duty cycle a radian with P gain 32
        armature=0.0284,  # measured
        profile_speed=400 * radians(360 / 4096),  # counts a second of its write-speed
        **_counts(4096, 360),  # sheet
        source="Feetech STS3215 data sheet and memory table, 7.4 V, P gain 32",
    ),
    "lx-16a": ServoKind(
        stall_torque=17 * KGF_CM,  # sheet
        no_load_speed=SIXTY / 0.16,  # sheet
        volts=7.4,  # sheet
        dead_band=2 * radians(0.24),  # sheet: accuracy 0.24 degrees, either way
        full_error=6 * radians(0.24),  # assumed: three dead bands
        **_counts(1000, 240, rate=50.0),  # sheet; 20 ms are its shortest move
        source="Hiwonder LX-16A data sheet, 7.4 V",
    ),
}
"""Servos by name.

Example:
    >>> from models import SERVO_KINDS
    >>> sorted(SERVO_KINDS)[:4]
    ['ax-12', 'ds3218', 'lx-16a', 'mg90']
"""

GENERIC = {
    "pulse": _pulse(
        1.0,
        1.0,
        0.0,
        degrees=180,
        dead=5,
        source="your data sheet; 180 degrees in 2000 us and 5 us are assumed",
    ),
    "bus": ServoKind(
        stall_torque=1.0,
        no_load_speed=1.0,
        full_error=3 * radians(360 / 4096),
        dead_band=radians(360 / 4096),
        **_counts(4096, 360),
        source="your data sheet; 4096 counts a turn are assumed",
    ),
}
"""Servos of no make, to which a data sheet gives torque and speed at least."""
KNOWN_SERVOS = SERVO_KINDS | GENERIC
NEEDED = ("stall_torque", "no_load_speed")


def servo_of(name: str, given: Mapping[str, float] | None = None) -> ServoKind:
    """A make, or a pulse or bus servo of none, with numbers of a data sheet.

    Raises:
        ValueError: There is no such make, or a number is missing or impossible.

    Example:
        >>> from models.description import servo_of
        >>> servo_of("pulse", {"stall_torque": 1.0, "no_load_speed": 6.0}).signal
        'pulse'
    """
    name, given = name.lower(), given or {}
    if name not in KNOWN_SERVOS:
        raise ValueError(f"it {unknown(name, KNOWN_SERVOS)}")
    if missing := [n for n in NEEDED if name in GENERIC and n not in given]:
        raise ValueError(f"give {' and '.join(missing)} of its data sheet")
    return KNOWN_SERVOS[name].with_numbers(given)
