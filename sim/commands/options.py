"""What commands share: settings, robots, folders, words."""

import argparse
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from itertools import count
from math import hypot, radians, tau
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.commands.declared import GUESSES
from sim.endings import again, keeping, kept_work
from sim.errors import ExitCode, SimulationError, UsageError, one_line, printable
from sim.progress import bar, say, stage
from sim.scenarios.settings import SETTINGS

if TYPE_CHECKING:
    from models import Robot
    from sim.logs.log import Log, Readers
    from sim.scenarios.scenario import Scenario

PAGES = (".html", ".htm")
DONE = "the work is done and its files are written; only what it prints is lost"
FAR = 5.0  # [m], 20 times the reach of shipped robots; others may mean millimetres


def scenario_of(options: argparse.Namespace, stops: bool = False) -> "Scenario":
    """The scenario asked for, or UsageError; with `stops`, be it replanned or not."""
    from sim.scenarios.file import load_scenario, shipped_scenarios, tell_of_run

    source = options.scenario
    of_robot = Path(source).suffix in (".xml", ".urdf")
    known = source in shipped_scenarios() or (Path(source).exists() and not of_robot)
    if not known and (meant := command_for(source, options.execute.name)):
        raise UsageError(f"{source!r} is no scenario", "SCENARIO", f"try {meant}")
    overrides = settings_of(options)
    for key, option in given_settings(options).items():
        if key in overrides:
            raise UsageError(f"{key} is given twice", option, "keep one")
        overrides[key] = getattr(options, key)
    tell_of_run(Path(source), overrides)
    scenario = load_scenario(source, overrides)
    stops |= scenario.replan
    for name, setting in SETTINGS.items():
        unused = name.startswith(("sense", "gyro", "learn")) and not stops
        if unused and getattr(scenario, name) not in (setting.default, False):
            raise UsageError.of("unused", f"scenario {scenario.name!r}", name=name)
    *place, yaw = scenario.path.goal
    tell_radians("yaw", yaw)
    for given in (dict[str, Any](each.given) for each in scenario.obstacles):
        tell_radians("yaw of an obstacle", given.get("yaw", 0.0))
    if (far := hypot(*place)) > FAR:
        notice(f"x and y are in metres: the goal is {far:g} m away")
    return scenario


def tell_radians(name: str, angle: float) -> None:
    """Say in which unit an angle is, where it looks like degrees."""
    if abs(angle) > tau:
        notice(f"{name} is in radians: {angle:g} degrees is {radians(angle):.5g}")


def command_for(name: str, robots: str = "run") -> str:
    """What does what a shipped name or a first guess asks for; empty for others.

    Robots are for the command `robots`, systems are planned, scenarios are walked.
    """
    from models import SYSTEMS, shipped_robots
    from sim.scenarios.file import shipped_scenarios

    meant = {name: f"run {name}" for name in shipped_scenarios()}
    meant |= {name: f"plan {name}" for name in SYSTEMS}
    meant |= {name: f"{robots} line --robot {name}" for name in shipped_robots()}
    meant |= GUESSES["names"]
    if Path(name).suffix in (".xml", ".urdf"):
        meant[name] = f"{robots} line --robot {name}"
    return f"stratawalk {meant[name]}" if name in meant else ""


def given_settings(options: argparse.Namespace) -> dict[str, str]:
    """Settings that have been given by options of their own, and these."""
    given = (key for key in SETTINGS if getattr(options, key, None) is not None)
    return {key: f"--{key.replace('_', '-')}" for key in given}


def settings_of(options: argparse.Namespace) -> dict[str, object]:
    """What `--set` sets; a key that comes twice, or by its own word too, is refused."""
    from sim.scenarios.file import parse_override

    values: dict[str, object] = {}
    for key, value in map(parse_override, options.set):
        if key in values or (key == "robot" and getattr(options, key, None)):
            raise UsageError(f"{key} is given twice", f"--set {key}", "keep one")
        values[key] = value
    return values


def reader_of(
    options: argparse.Namespace, robot: "Robot", scenario: "Scenario"
) -> "Callable[[Path], Log]":
    """What reads a robot's logs, in `--units`; counts and pulses by its servo table."""
    from sim.export.servo_table import servo_table
    from sim.logs.log import read_log
    from sim.world.servos import servo_settings

    card, pulses = robot.card, options.units == "microseconds"
    angles: Readers | str = options.units
    if pulses or options.units == "counts":
        settings = servo_settings(scenario, card)
        make = settings.kind
        pwm = pulses or (make.signal == "pulse" if make else None)
        table = servo_table(card, card.joints, make, pwm, rate=settings.rate)
        servos = (table.in_microseconds() if pulses else table).channels
        angles = {servo.joint: servo.angle for servo in servos}
        if unknown := [s for s in servos if s.joint not in card.joint_servos]:
            one = unknown[0]
            turn = f"{tau * one.counts_per_radian:.0f} {options.units} a turn"
            line = f"the card gives no servo of {one.joint!r}; {turn} are taken"
            notice(f"{line}, {one.center:.0f} at angle zero")
    return partial(read_log, joints=card.joints, legs=robot.legs, angles=angles)


def require_different(paths: Sequence[Path]) -> None:
    """Refuse files or folders of which one is named twice, and would count twice."""
    last = {os.path.realpath(path): path for path in paths}
    for path in paths:
        if last[os.path.realpath(path)] is not path:
            raise UsageError("named twice", str(path), "name it once")


def run_of(options: argparse.Namespace) -> Path:
    """The run that is asked for, or the newest of a folder; UsageError without one."""
    folder = Path(GUESSES["runs"].get(options.run, options.run))
    ended = runs_in(folder)
    if (folder / "scenario.toml").exists() or not (folder == Path("runs") or ended):
        return folder
    if not ended:
        raise UsageError("no run here", str(folder), "walk one: stratawalk run line")
    notice(f"the newest run, {ended[0]}")
    return ended[0]


def runs_in(folder: Path) -> list[Path]:
    """Finished runs in a folder, the newest first."""
    newest = sorted(folder.glob("*/summary.json"), key=os.path.getmtime, reverse=True)
    return [file.parent for file in newest]


def kept_in(folder: Path, out: str | None) -> str:
    """What a folder, named by `out` or not, keeps of ended work, and how to redo it."""
    there = sorted(path.name for path in folder.glob("[!.]*"))
    if not there:
        return f"nothing is kept; start again: {again()}"
    return f"{folder} keeps {', '.join(there)}; start again: {again(*elsewhere(out))}"


def elsewhere(out: str | None, option: str = "--out") -> list[str]:
    """Words for another place than the one that an option named, which is taken."""
    if not out:
        return []
    taken = Path(out)
    names = (f"{taken.stem}-{number}{taken.suffix}" for number in count(2))
    free = (path for path in map(taken.with_name, names) if not os.path.lexists(path))
    place = str(next(free))
    return [option, f"./{place}" if place.startswith("-") else place]


def require_robot(name: str) -> None:
    """Refuse a scenario where a robot is wanted, and name the robot that walks it."""
    from sim.scenarios.file import load_scenario, shipped_scenarios

    if name in shipped_scenarios():
        robot = load_scenario(name).robot
        meant = re.sub(rf" {name}(?!\S)", f" {robot}", again(), count=1)
        raise UsageError(f"{name!r} is a scenario", "ROBOT", f"try {meant}")


def robot_of(
    options: argparse.Namespace, name: str, geometry: Mapping[str, float] | None = None
) -> "Robot":
    """Load a robot, and say what it took from elsewhere."""
    from models import load

    require_robot(name)
    robot = load(name, allow_external=options.allow_external, geometry=geometry)
    if robot.borrowed:
        own = f"{robot.borrowed!r}, whose model name it carries"
        notice(f"{robot.path} has no card; that of the shipped robot {own}, is used")
    if robot.opened.external:
        taken = ", ".join(map(str, robot.opened.external))
        notice(f"taken from outside the folder of {robot.path}: {taken}")
    return robot


def report(options: argparse.Namespace, facts: Any, *lines: object) -> None:
    """Print facts as JSON alone where that is asked for, and lines elsewhere."""
    found = json.dumps(facts, indent=1) if options.json else "\n".join(map(str, lines))
    is_kept = not kept_work() and (getattr(options, "out", None) or "written" in facts)
    with keeping(lambda: DONE) if is_kept else nullcontext():
        print(printable(found), flush=True)


@contextmanager
def working(options: argparse.Namespace, on: str) -> Iterator[None]:
    """Show a stage of the work for as long as the block runs."""
    with bar(quiet=options.json) as progress, stage(progress, on):
        yield


def notice(text: str, kind: str = "notice") -> None:
    """Print what a user should know on standard error."""
    say(f"stratawalk: {kind}: {printable(' '.join(text.split()))}")


def ended(code: ExitCode, how: str, where: str, remedy: str) -> ExitCode:
    """Print why a walk does not end the command with 0, and return its code."""
    notice(one_line(SimulationError(how, where, remedy)), "error")
    return code
