"""Exports: their source, a run folder or a new walk, their files, and their playback.

Each reader takes what its writer wrote, and any other text is a ValueError. A joint
that leaves its servo's range is a UsageError.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np
import yaml

from models import JointServo, Kinematics, Robot, load
from models.description import actuators_driving
from planner.support import read_text
from sim.errors import UsageError
from sim.evaluation.deviations import Scale, departure, off
from sim.evaluation.summary import Played
from sim.export.header import read_header, write_header
from sim.export.servo_commands import ServoCommands, taken
from sim.export.servo_table import ServoTable, servo_table
from sim.folder import csv_lines, csv_text, whole
from sim.motion.poses import pose_of, seen_from
from sim.physics.engine import Engine
from sim.physics.measure import Sensors
from sim.physics.recording import Recorder
from sim.progress import Progress, silent
from sim.run_folder import run_of
from sim.runs.arrays import reading
from sim.runs.run import START, Run, read_run
from sim.scenarios.scenario import Scenario
from sim.simulation import simulate
from sim.world.servos import Channels, ServoSettings, servo_settings

AHEAD = 0.5  # [rad] by which commands are ahead of a soft or slack servo at most
TURNED = 4 * np.pi  # [rad] from the middle, of joints that turn without end


@dataclass(frozen=True, eq=False)
class Source:
    """A run with its robot and its model, which exporting and playing it needs."""

    run: Run
    robot: Robot
    model: mujoco.MjModel  # robot and world, as simulated

    @cached_property
    def servo(self) -> ServoSettings:
        """Make and command rate of the servos."""
        return servo_settings(self.run.scenario, self.run.card)

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, in the order of the legs."""
        return self.run.card.joints

    @property
    def steps(self) -> int:
        """Number of physics steps."""
        return len(self.run.commands["time"])

    @property
    def timestep(self) -> float:
        """Of the physics [s]."""
        return float(self.model.opt.timestep)

    def commands(self, rate: float) -> ServoCommands:
        """Commands of the servos at a rate, where the walk itself has none.

        Angles far beyond a joint's range, to which no servo leads it, are refused.
        """
        ctrl, asked = self.run.commands["ctrl"], self.servo.rate or rate
        drives = actuators_driving(self.model, self.joints)
        found = taken(ctrl, self.joints, drives, asked, self.timestep)
        if len(found.angles) < 2:
            least = 1.01 / (self.steps * self.timestep)
            raise UsageError.of("too_slow", "--rate", rate=rate, least=least)
        for joint, angles in zip(self.joints, found.angles.T, strict=True):
            own, low, high = self.model.joint(joint), angles.min(), angles.max()
            least, most = own.range if own.limited else (-TURNED, TURNED)
            if low < least - AHEAD or high > most + AHEAD:
                facts = {"low": low, "high": high, "least": least, "most": most}
                where = self.run.folder
                own = where == Path() and f"scenario {self.run.scenario.name!r}"
                raise UsageError.of("told_beyond", own or where, joint=joint, **facts)
        return found


def from_run(folder: Path, *, allow_external: bool = False) -> Source:
    """A walk from its run folder, whose robot may open files elsewhere if allowed."""
    run = read_run(folder)
    model = run.model
    run.require_width(run.commands["ctrl"], model.nu)
    with reading(folder):
        model.key("start")
    name, geometry = run.scenario.robot, run.scenario.geometry
    robot = load(name, allow_external=allow_external, geometry=geometry)
    return Source(run, robot, model)


def from_scenario(
    scenario: Scenario, robot: Robot, progress: Progress = silent
) -> Source:
    """A walk that is simulated now; nothing is written."""
    done = simulate(scenario, robot=robot, progress=progress)
    return Source(run_of(done.evaluation, done.summary), robot, done.walk.setup.model)


def play(
    source: Source,
    commands: ServoCommands,
    progress: Progress = silent,
    *,
    interpolated: bool = False,
) -> Played:
    """Walk what was read back, and compare it as the walk itself was compared."""
    run = source.run
    steps = np.round(run.time / source.timestep).astype(int)
    sensors = Sensors(source.model, source.robot)
    starts = round(run.summary.walk_starts / source.timestep)
    recorder = Recorder(Engine(source.model), sensors, source.steps)
    recorder.walk_starts = starts
    channels = Channels(source.robot, source.model)
    told = commands.rows(source.steps, source.timestep, interpolated)
    order = [commands.joints.index(joint) for joint in source.joints]
    named = (dict(zip(source.joints, row.T[order], strict=True)) for row in told)
    for done in recorder.play(map(channels.ctrl, named), np.union1d(steps, [starts])):
        progress("playing", done / source.steps)
    recording = recorder.finish()
    moments, walking = recording.moments, steps >= starts
    kept = np.isin(moments.step, steps[walking])
    address = source.robot.root_address_in(source.model)
    poses = seen_from(run.arrays[START], pose_of(moments.qpos[kept], address))
    slip = moments.slip[-1] - recording.slip_after(starts)
    summary, goal = run.summary, run.summary.goal
    lengths = summary.path_length, summary.distance_walked
    predicted = {key: found[walking] for key, found in run.predicted.items()}
    scale = Scale.of(run.scenario.path, Kinematics(source.robot).reach, predicted)
    return Played(
        pose=poses[-1].tolist(),
        min_margin=recording.least_margin,
        slip=float(np.maximum(slip, 0.0).sum()),
        bounces=recording.bounces,
        error={
            **({} if goal is None else {"goal": departure(poses[-1], np.array(goal))}),
            **{key: off(poses, found, *lengths) for key, found in predicted.items()},
        },
        weighed=scale.weigh(poses, predicted[scale.prediction], goal),
        changed=scale.share(poses[-1], run.achieved[-1]),
    )


PWM = {"csv": None, "ros2": None, "header": True, "dynamixel": False}  # None: angles
SECOND = 1_000_000_000  # [ns]
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # in C it is 10 times faster


def servos(
    source: Source,
    form: str,
    given: Mapping[str, JointServo] | None = None,
    *,
    microseconds: bool = False,
    rate: float = 0.0,
) -> ServoTable:
    """The servos that a walk is exported for: its card's, unless others are given.

    The rate is that of a walk that has none of its own. A joint without a servo is a
    UsageError.
    """
    missing = [] if given is None else [j for j in source.joints if j not in given]
    if missing:
        raise UsageError.of("not_listed", "--servo-table", joint=missing[0])
    make, rate = source.servo.kind, source.servo.rate or rate
    table = servo_table(source.run.card, source.joints, make, PWM[form], given, rate)
    return table.in_microseconds() if microseconds else table


def write(
    path: Path, form: str, source: Source, commands: ServoCommands, table: ServoTable
) -> None:
    """Write commands in a format."""
    table.require_range(commands)
    if form in ("csv", "dynamixel"):
        text = write_table(commands, None if form == "csv" else table)
    elif form == "ros2":
        text = write_trajectory(commands)
    else:
        scenario, robot = source.run.summary.scenario, source.run.summary.robot
        title = f"{scenario} on {robot}, planned by stratawalk."
        text = write_header(commands, table, title=title, name=scenario, file=path.name)
    content = text.encode()
    with whole(path, len(content), new=True) as part:
        part.write_bytes(content)


def read(path: Path, form: str, table: ServoTable) -> ServoCommands:
    """Read what `write` wrote; another file is a ValueError."""
    text = read_text(path, 10**9)  # bytes
    if form in ("csv", "dynamixel"):
        return read_table(text, None if form == "csv" else table)
    return read_trajectory(text) if form == "ros2" else read_header(text, table)


def write_table(commands: ServoCommands, table: ServoTable | None = None) -> str:
    """A column `time` [s] and a column a joint: every digit of its angles [rad].

    With a table of servos they are ticks, in the order of the channels.
    """
    joints = commands.joints if table is None else table.joints
    values = commands.angles if table is None else table.counts(commands)
    rows = zip(commands.time.tolist(), values.tolist(), strict=True)
    return csv_text([("time", *joints), *((moment, *row) for moment, row in rows)])


def read_table(text: str, table: ServoTable | None = None) -> ServoCommands:
    """The commands of such a table, for the same servos."""
    (first, *joints), *rows = csv_lines(text)
    if first != "time" or len(rows) < 2:
        raise ValueError("needs a column time, and two commands at least")
    values = np.array(rows, dtype=float)
    rate = float((len(values) - 1) / (values[-1, 0] - values[0, 0]))
    if table is None:
        return ServoCommands(tuple(joints), rate, values[:, 1:])
    if tuple(joints) != table.joints:
        raise ValueError(f"columns {tuple(joints)} for joints {table.joints}")
    return table.commands(values[:, 1:], rate)


def write_trajectory(commands: ServoCommands) -> str:
    """A `JointTrajectory`, one line a point; angles to a billionth of a radian."""
    listed = json.dumps(commands.joints, ensure_ascii=False)
    lines = [f"joint_names: {listed}", "points:"]
    for number, row in enumerate(commands.angles.tolist()):
        sec, nanosec = divmod(round(number * SECOND / commands.rate), SECOND)
        positions = ", ".join(f"{angle:z.9f}" for angle in row)
        when = f"{{sec: {sec}, nanosec: {nanosec}}}"
        lines.append(f"- {{positions: [{positions}], time_from_start: {when}}}")
    return "\n".join(lines) + "\n"


def read_trajectory(text: str) -> ServoCommands:
    """The commands of such a trajectory."""
    try:
        read = yaml.load(text, Loader=LOADER)  # noqa: S506
        points = read["points"]
        last = points[-1]["time_from_start"]
        duration = last["sec"] + last["nanosec"] / SECOND
        angles = np.array([point["positions"] for point in points], dtype=float)
    except (yaml.YAMLError, KeyError, IndexError, TypeError) as error:
        raise ValueError(f"no trajectory, {error}") from error
    if len(points) < 2:
        raise ValueError("needs two points at least")
    rate = (len(points) - 1) / duration
    return ServoCommands(tuple(read["joint_names"]), rate, angles)
