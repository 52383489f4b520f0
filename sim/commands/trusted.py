"""The robot of a command, whose model may open files outside its own folder."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from models import Robot


def add_robot_argument(
    parser: argparse.ArgumentParser,
    about: str,
    metavar: str = "ROBOT",
    optional: bool = False,
) -> None:
    """Add a robot and `--allow-external` to a command that is about one robot."""
    parser.add_argument(
        "robot", metavar=metavar, nargs="?" if optional else None, help=about
    )
    add_trust_argument(parser)


def add_trust_argument(parser: argparse.ArgumentParser) -> None:
    """Add the option to a command that loads robots."""
    parser.add_argument(
        "--allow-external",
        action="store_true",
        help="let a robot's MJCF open files outside its own folder",
    )


def robot_of(options: argparse.Namespace, name: str) -> Robot:
    """Load a robot, and say what it took from elsewhere.

    Raises:
        UnknownRobotError: If there is no such robot or file.
        ModelError: If file or card cannot be used.
    """
    from models import load

    robot = load(name, allow_external=options.allow_external)
    if robot.borrowed:
        print(
            f"stratawalk: notice: {robot.path} has no card; that of the shipped robot "
            f"{robot.borrowed!r}, whose model name it carries, is used",
            file=sys.stderr,
        )
    if robot.external:
        taken = ", ".join(map(str, robot.external))
        print(
            f"stratawalk: notice: taken from outside the folder of {robot.path}: "
            f"{taken}",
            file=sys.stderr,
        )
    return robot
