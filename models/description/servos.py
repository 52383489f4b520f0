"""Servos that people build with, in numbers from their data sheets.

A hobby servo is a proportional controller with a direct-current motor behind a gear
train. Near its target it is a spring: the stall torque divided by the error at which
its controller gives full voltage. Controllers are taken to be critically damped,
whatever inertia they move. The servo of one joint takes for the joint's angle the count
center + sign * counts_per_radian * (angle - offset).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf, isfinite, pi, radians
from typing import Literal

# [s]; 52 and 63 ms were measured on an STS3215 and an XL-330 (github.com/Rhoban/bam),
# 14 ms follow from 240 : 1 on a coreless rotor of 4e-9 kg m^2, as of an MG90S
START_UP = 0.03


@dataclass(frozen=True, slots=True)
class ServoKind:
    """One make of servo, and how it takes commands.

    Attributes:
        stall_torque: Largest torque, at no speed [N m].
        no_load_speed: Largest speed, at no torque [rad/s].
        full_error: Error at which the controller gives all of the torque [rad].
        command_rate: Commands taken in a second; 0 for one a physics step [1/s].
        resolution: Angle of one count of a command; 0 for none [rad].
        center: Count of angle zero.
        reach: Farthest that it turns from its centre [rad].
        bus: `pwm` for pulses of a PCA9685, `dynamixel` for ticks on a bus.
        armature: Inertia of the rotor behind the gears; 0 where nobody has measured it
            [kg m^2].
        source: Where the numbers come from.

    Raises:
        ValueError: A number is not finite, or of the wrong sign.

    Example:
        >>> from models import ServoKind
        >>> ServoKind(stall_torque=1.0, no_load_speed=6.0, full_error=0.1).stiffness
        10.0
    """

    stall_torque: float
    no_load_speed: float
    full_error: float
    command_rate: float = 0.0
    resolution: float = 0.0
    center: int = 0
    reach: float = pi
    bus: Literal["pwm", "dynamixel"] = "pwm"
    armature: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        for name in ("stall_torque", "no_load_speed", "full_error", "reach"):
            if not 0 < (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must be positive and finite, got {value}")
        for name in ("command_rate", "resolution", "armature"):
            if not 0 <= (value := getattr(self, name)) < inf:
                raise ValueError(f"{name} must not be negative: {value}")

    @property
    def stiffness(self) -> float:
        """Torque an error near zero [N m/rad]."""
        return self.stall_torque / self.full_error

    def at_rate(self, rate: float) -> ServoKind:
        """The servo given so many commands a second; 0 for one a physics step.

        Pulses are counted in parts of a frame, so their counts are as many times finer
        as frames are shorter. On a bus, and at a rate of 0, counts stay.
        """
        if self.bus != "pwm" or not (rate and self.command_rate):
            return replace(self, command_rate=rate)
        finer = rate / self.command_rate
        resolution, center = self.resolution / finer, round(self.center * finer)
        return replace(self, command_rate=rate, resolution=resolution, center=center)

    @property
    def lost_torque(self) -> float:
        """Torque that the motor loses with its speed [N m s/rad]."""
        return self.stall_torque / self.no_load_speed

    @property
    def rotor(self) -> float:
        """Inertia of the rotor behind the gears, measured or likely [kg m^2].

        A motor on its full voltage comes to 63 % of its speed within its inertia over
        the torque that it loses with speed.
        """
        return self.armature or START_UP * self.lost_torque


@dataclass(frozen=True, slots=True, kw_only=True)
class JointServo:
    """The servo of one joint; None leaves a value to the make of the servo.

    Attributes:
        channel: Output of the servo controller, or the servo's number on its bus.
        sign: 1 where counts grow with the joint's angle, otherwise -1.
        center: Count of the servo's centre.
        offset: Angle of the joint at the servo's centre [rad].
        counts_per_radian: Counts that turn the servo by a radian.
        limits: Lowest and highest angle of the joint [rad].

    Raises:
        ValueError: A value is impossible.

    Example:
        >>> from models import JointServo
        >>> JointServo(channel=3, sign=-1).offset
        0.0
    """

    channel: int | None = None
    sign: float = 1
    center: float | None = None
    offset: float = 0.0
    counts_per_radian: float | None = None
    limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("channel", "center"):
            value = getattr(self, name)
            if value is not None and not 0 <= value < inf:
                raise ValueError(f"{name} must not be negative, got {value}")
        if self.sign not in (-1, 1):
            raise ValueError(f"sign must be 1 or -1, got {self.sign:g}")
        if not isfinite(self.offset):
            raise ValueError(f"offset must be finite, got {self.offset}")
        counts = self.counts_per_radian
        if counts is not None and not 0 < counts < inf:
            raise ValueError(f"counts_per_radian must be positive, got {counts}")
        match self.limits:
            case None:
                return
            case (low, high) if -inf < low < high < inf:
                return
        raise ValueError(
            f"limits are the lowest and the highest angle, got {list(self.limits)}"
        )


SERVO_KINDS = {
    # The data sheet of the MG90S: 13.4 g, 2.2 kgf cm and 60 degrees in 0.08 s at 6 V,
    # 180 degrees, a dead band of 5 us, half a degree. It does not say at which error
    # the voltage is full: three dead bands are assumed. Nor does it say which pulses
    # are 180 degrees: 773 to 2197 us are assumed. A PCA9685 at 60 Hz divides the frame
    # into 4096 counts of 4.07 us, of which these are 190 to 540.
    "mg90": ServoKind(
        stall_torque=0.216,
        no_load_speed=13.1,
        full_error=3 * radians(0.45),
        command_rate=60.0,
        resolution=radians(180 / 350),
        center=365,
        reach=radians(90),
        armature=240**2 * 4e-9,
        source="TowerPro MG90S data sheet, 6 V; NXP PCA9685 data sheet, 60 Hz",
    ),
    # The manual: 1.5 N m and 59 revolutions a minute at 12 V; 1024 counts over 300
    # degrees; with compliance slope 8 the torque is full eight counts from the goal.
    # As delivered the slope is 32, and the servo a quarter as stiff.
    "ax-12": ServoKind(
        stall_torque=1.5,
        no_load_speed=6.18,
        full_error=8 * radians(300 / 1024),
        command_rate=100.0,
        resolution=radians(300 / 1024),
        center=512,
        reach=radians(150),
        bus="dynamixel",
        source="emanual.robotis.com/docs/en/dxl/ax/ax-12a, 12 V, compliance slope 8",
    ),
    # The manual: 0.52 N m and 103 revolutions a minute at 5 V; 4096 counts a turn. The
    # controller gives gain / 128 of its 885 steps of voltage a count: all at 14 counts
    # of error with a gain of 8000. As delivered the gain is 400, and the servo a
    # twentieth as stiff.
    "xl-330": ServoKind(
        stall_torque=0.52,
        no_load_speed=10.8,
        full_error=885 * 128 / 8000 * radians(360 / 4096),
        command_rate=100.0,
        resolution=radians(360 / 4096),
        center=2048,
        reach=radians(180),
        bus="dynamixel",
        source="emanual.robotis.com/docs/en/dxl/x/xl330-m288, 5 V, P gain 8000",
    ),
}
"""Servos by name.

Example:
    >>> from models import SERVO_KINDS
    >>> sorted(SERVO_KINDS)
    ['ax-12', 'mg90', 'xl-330']
"""
