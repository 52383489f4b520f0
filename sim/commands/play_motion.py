"""`stratawalk play`: walk joint motion from anywhere, a gait or the log of a robot."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.judging import TOLERANCE
from sim.commands.options import (
    LOOK,
    folder_of,
    notice,
    option,
    robot_of,
    robot_options,
    set_option,
    settings_of,
    whole,
)
from sim.commands.run import VIDEO, can_film, walk
from sim.errors import ExitCode, UsageError

if TYPE_CHECKING:
    from models import Robot
    from sim.logs.log import Log, Reader
    from sim.scenarios.scenario import Scenario

HELP = "play joint motion from elsewhere in MuJoCo: a gait, or the log of a robot"
UNITS = ("radians", "degrees", "counts", "microseconds")
OPTIONS = (
    *robot_options("a shipped robot, or an MJCF file", "NAME|FILE.xml"),
    option(
        "files",
        metavar="FILE",
        nargs="+",
        help="CSV of time [s] and a column a joint; several are trials of one motion",
    ),
    option(
        "--units",
        choices=UNITS,
        default=UNITS[0],
        help="what the columns of joints are in; counts and microseconds are those of "
        "the card's servo table",
    ),
    option(
        "--repeat",
        type=whole(1),
        default=1,
        metavar="N",
        help="play a period that ends as it begins so many times",
    ),
    option("--out", metavar="DIR", help="run folder to make; otherwise runs/FILE-NNN"),
    VIDEO,
    LOOK,
    set_option("replace a setting, as in run"),
    TOLERANCE,
)


def execute(options: argparse.Namespace) -> ExitCode:
    """Play the motion and print how it went."""
    from sim.folder import claim
    from sim.logs.playing import scenario_of

    robot = robot_of(options, options.robot)
    files = [Path(name) for name in options.files]
    scenario = scenario_of(robot, files[0], settings_of(options))
    log = _log(robot, scenario, files, options)
    look = options.look if can_film(options.video) else None
    folder = claim(folder_of(options), scenario.name)
    for line in log.done:
        notice(line)
    return walk(scenario, robot, folder, look, options, log)


def _log(
    robot: Robot, scenario: Scenario, files: list[Path], options: argparse.Namespace
) -> Log:
    """The log in the files, in radians."""
    from sim.logs.alignment import together
    from sim.logs.log import read_log

    angles: Reader | str = options.units
    if options.units in UNITS[2:]:
        angles = _by_servo_table(robot, scenario, pulses=options.units == UNITS[3])
    logs = [read_log(file, robot.card.joints, robot.legs, angles) for file in files]
    try:
        log = together(logs)
        return log.repeated(options.repeat) if options.repeat > 1 else log
    except ValueError as error:
        raise UsageError.at(str(files[0]), error) from error


def _by_servo_table(robot: Robot, scenario: Scenario, pulses: bool) -> Reader:
    """A reader of counts, or of the length of pulses [us], by the card's servos."""
    from sim.export.servo_table import servo_table
    from sim.world.servo_settings import servo_settings

    card, settings = robot.card, servo_settings(scenario, robot.card)
    make = settings.kind
    pwm = pulses or (make is not None and make.signal == "pulse")
    table = servo_table(card, card.joints, make, pwm, rate=settings.rate)
    servos = (table.in_microseconds() if pulses else table).channels
    of = {servo.joint: servo for servo in servos}
    return lambda joint, numbers: of[joint].angle(numbers)
