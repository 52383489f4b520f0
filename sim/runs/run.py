"""A finished run, as its report, its film, the viewer and an export see it.

Arrays are read when they are asked for, or taken from a simulation just ended.
"""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models import Card, description
from planner import Array
from planner.support import open_file, read_file, read_text
from sim.errors import UsageError
from sim.evaluation import flows
from sim.evaluation.flows import WalkedPhase
from sim.evaluation.summary import Summary
from sim.feedback.stops import Stop, read as read_stops
from sim.folder import blamed_on
from sim.motion.poses import compose, rotate, wrap
from sim.runs.arrays import archive, plain_json, reading
from sim.runs.seals import MODEL, seal, seals
from sim.scenarios import body_path, obstacles
from sim.scenarios.file import anchor, scenario_from
from sim.scenarios.predictions import PREDICTIONS, best
from sim.scenarios.scenario import Scenario
from sim.scenarios.settings import SETTINGS

SURE = 2.146  # standard deviations of a normal point in the plane that hold 90 %
PLACES = ("contact_point", "center_of_mass")  # arrays of points that are not poses
STATES = {"qvel", "contact", "slip", "achieved_margin", *PLACES}  # of any walk
START = "world_start_pose"  # array with the frame in which poses are given


def _array(name: str) -> cached_property[Array]:
    """One of a run's arrays, read when it is asked for."""
    return cached_property(lambda run: run.arrays[name])


@dataclass(frozen=True, eq=False)
class Run:
    """A finished run; lengths in metres, poses relative to the start pose."""

    folder: Path  # a walk that is never written has none to look into
    settings: Mapping[str, Any]  # contents of scenario.toml
    card_text: str  # contents of model.toml
    summary: Summary
    phases: tuple[WalkedPhase, ...]  # lines of flows.csv
    arrays: Mapping[str, Array]  # of trajectory.npz, (T, ...) but for the start pose
    commands: Mapping[str, Array]  # `time` [s] and `ctrl`, a row a physics step
    stops: tuple[Stop, ...] = ()  # lines of feedback.csv, if it was replanned
    frame: Array | None = None  # pose in the world, (3,), in which others are given
    inspected: bool = False  # whether its model may be compiled without a look at it

    time = _array("time")  # of each row [s], (T,)
    phase = _array("phase")  # index of each row's phase, (T,)
    qpos = _array("qpos")  # positions of all joints, (T, nq)
    qvel = _array("qvel")  # velocities, (T, nv)
    achieved = _array("achieved_pose")  # poses in the physics, (T, 3)
    contact = _array("contact")  # whether each foot touches the ground, (T, F), bool
    contact_point = _array("contact_point")  # where feet stand or stood, (T, F, 2) [m]
    margin = _array("achieved_margin")  # stability margin, (T,) [m]

    @property
    def title(self) -> str:
        """The folder's own name, by which people know the run."""
        return self.folder.name

    @cached_property
    def model_file(self) -> Path:
        """MJCF file of robot and world, which has been found fit to be compiled."""
        path = self.folder / MODEL
        if not self.inspected:
            description.inspect_model(path, remedy="walk the scenario again")
            with reading(self.folder):
                self.require_sealed({MODEL: seal(path)})
        return path

    @cached_property
    def model(self) -> mujoco.MjModel:
        """Robot and world, compiled; the states of the run are states of it."""
        spec = description.read_spec(self.model_file)
        model = description.compile_model(spec, str(self.model_file))
        self.require_width(self.qpos, model.nq)
        self.require_width(self.qvel, model.nv)
        return model

    def require_sealed(self, own: Mapping[str, str | None]) -> None:
        """Refuse files, with a ValueError, whose seals the summary does not have."""
        told = self.summary.seals
        if isinstance(told, Mapping) and own != {name: told.get(name) for name in own}:
            raise ValueError("its files are of different walks, or were changed")

    def require_width(self, array: Array, width: int) -> None:
        """Refuse states or commands that are not those of the model."""
        if array.shape[1:] != (width,):
            raise UsageError.of("widths", self.folder, own=array.shape[1:], model=width)

    @cached_property
    def scenario(self) -> Scenario:
        """What was walked."""
        table = deepcopy(dict(self.settings))
        anchor(table, self.folder)
        walked = scenario_from(table, {}, str(self.folder / "scenario.toml"))
        return replace(walked, given=frozenset(SETTINGS))  # nothing was left open

    @cached_property
    def card(self) -> Card:
        """The robot's card, as it was simulated."""
        return description.parse_card(self.card_text, str(self.folder / "model.toml"))

    @cached_property
    def walking(self) -> slice:
        """Rows from the start of the walk on."""
        first = int(np.searchsorted(self.time, self.summary.walk_starts - 1e-9))
        return slice(min(first, len(self.time) - 1), None)

    @cached_property
    def ctrl(self) -> Array:
        """Commands in force at each row, (T, nu)."""
        return self.ctrl_at(self.time)

    def ctrl_at(self, time: Array) -> Array:
        """Commands in force at some times (n,) [s], (n, nu)."""
        rows = np.searchsorted(self.commands["time"], time - 1e-9)
        ctrl = self.commands["ctrl"]
        return ctrl[np.minimum(rows, len(ctrl) - 1)]

    @cached_property
    def predicted(self) -> dict[str, Array]:
        """Poses of each prediction that could be made, by its key, (T, 3)."""
        names = {key: name.array("pose") for key, name in PREDICTIONS.items()}
        return {key: self.arrays[n] for key, n in names.items() if n in self.arrays}

    @cached_property
    def compared(self) -> dict[str, Array]:
        """Poses of each prediction, and of a real robot that was measured, (T, 3)."""
        real = self.arrays.get("measured_pose")
        return self.predicted if real is None else {**self.predicted, "measured": real}

    @property
    def drawn(self) -> dict[str, Array]:
        """Poses of the predictions that pictures of the robot show, by their keys."""
        names = dict.fromkeys(("measured", "ideal", self.best))
        return {n: self.compared[n] for n in names if n in self.compared}

    @property
    def best(self) -> str:
        """Key of the prediction that the walk is measured by."""
        return best(self.predicted)

    def error(self, name: str) -> Array:
        """Achieved less predicted or measured pose, yaw wrapped, (T, 3)."""
        apart = self.achieved - self.compared[name]
        return np.concatenate([apart[:, :2], wrap(apart[:, 2:])], axis=1)

    @cached_property
    def center_of_mass(self) -> Array:
        """Projected on the floor, (T, 2) [m]."""
        return self.arrays["center_of_mass"][:, :2]

    @cached_property
    def clearance(self) -> Array | None:
        """Distance from obstacles, where there are any, (T,) [m]."""
        return self.arrays.get("achieved_clearance")

    @cached_property
    def nominal(self) -> Array:
        """The nominal path as it is drawn, or the way of a played motion, (N, 3)."""
        if "motion" in self.settings:
            return self.predicted[self.best]
        path = body_path.decode(self.settings["path"])
        poses = np.array([path(s) for s in np.linspace(0, 1, 400)])  # as it is drawn
        return poses if self.frame is None else compose(self.frame, poses)

    @property
    def path_labels(self) -> tuple[str, str]:
        """What that path and its end are called; a played motion has no goal."""
        played = "motion" in self.settings
        return ("predicted path", "its end") if played else ("nominal path", "goal")

    @cached_property
    def thought(self) -> tuple[Array, ...]:
        """Where feedback was 90 % sure to be, if not told exactly, lines (n, 2) [m]."""
        if self.summary.feedback is None:
            return ()
        around = np.linspace(0, 2 * np.pi, 33)
        circle = SURE * np.stack([np.cos(around), np.sin(around)], axis=1)
        lines = (np.array(s.expected[:2]) + circle * s.doubt[:2] for s in self.stops)
        frame = np.zeros(3) if self.frame is None else self.frame
        return tuple(_points(frame, line) for line in lines)

    @cached_property
    def obstacles(self) -> tuple[Array, ...]:
        """Outlines of the obstacles on the floor, from the start, (n, 2) each."""
        found = obstacles.decode(self.settings.get("obstacles", ()))
        return tuple(piece.corners for each in found for piece in each.pieces)

    @property
    def segments(self) -> int:
        """How many were walked; bounds may have cut those of the scenario."""
        return 1 + max((phase.segment for phase in self.phases), default=0)

    @property
    def legs(self) -> tuple[int, ...]:
        """Numbers of the legs, in the order of every array's feet."""
        return tuple(sorted(self.card.legs))

    @cached_property
    def group_of_foot(self) -> tuple[int, ...]:
        """Index of each foot's group, feet in ascending order of their legs."""
        return tuple(self.card.group_of_leg.values())

    @cached_property
    def reach(self) -> float:
        """Largest distance from the body's centre to a foot at the end [m]."""
        feet = self.contact_point[-1] - self.achieved[-1, :2]
        return float(np.hypot(*feet.T).max())

    def in_world(self) -> "Run":
        """The run with all arrays read, poses and points in world coordinates."""
        with reading(self.folder):
            _ = self.scenario  # which says in time what is wrong
            frame = self.arrays[START]
            arrays = {name: _placed(frame, name, a) for name, a in self.arrays.items()}
            return replace(self, arrays=arrays, frame=frame)


def _placed(frame: Array, name: str, array: Array) -> Array:
    """An array in world coordinates, if it holds poses or points."""
    if name.endswith("_pose") and name != START:
        return compose(frame, array)
    if name in PLACES:
        return np.concatenate([_points(frame, array), array[..., 2:]], axis=-1)
    return array


def _points(frame: Array, points: Array) -> Array:
    return frame[:2] + rotate(points[..., :2], frame[2])


def read_run(folder: Path, *, inspected: bool = False) -> Run:
    """Read the folder of a run that came to its end, or raise UsageError.

    All its arrays are read once, and its model is compiled in a process with limits
    before anything else does, unless that has been done.
    """
    stops = folder / "feedback.csv"
    with blamed_on(folder), reading(folder):
        open_file(folder / MODEL).close()  # without which nothing can be shown
        card = read_text(folder / "model.toml", 10**6)
        feet = len(description.parse_card(card, str(folder / "model.toml")).legs)
        summary = plain_json(read_file(folder / "summary.json", 10**6))
        run = Run(
            folder=folder.resolve(),
            settings=description.parse_toml(read_text(folder / "scenario.toml")),
            card_text=card,
            summary=Summary.read(summary),
            phases=flows.read(read_text(folder / "flows.csv")),
            arrays=archive(folder, "trajectory.npz", feet, (START,), not inspected),
            commands=archive(folder, "commands.npz", feet, (), not inspected),
            stops=read_stops(read_text(stops)) if stops.exists() else (),
            inspected=inspected,
        )
        if len(run.stops) > run.phases[-1].segment + 1:
            raise ValueError("feedback.csv has more stops than the walk has segments")
        _ = run.obstacles  # which say in time what is wrong, as the path does
        if (far := np.abs(run.nominal[:, :2]).max()) > 1e5:  # [m], for a picture
            raise ValueError(f"its path leads {far:.3g} m away")
        if lacks := STATES.difference(run.arrays):
            raise KeyError(f"{min(lacks)} in trajectory.npz")
        if lacks := {"time", "ctrl"}.difference(run.commands):
            raise KeyError(f"{min(lacks)} in commands.npz")
        if not inspected:
            about = description.parse_toml(card)
            run.require_sealed(seals(run.folder, run.settings, about, summary))
            flows.require_known(run.phases, run.card)
            known = run.phase.dtype.kind in "iu"
            if not (known and np.isin(run.phase, range(len(run.phases))).all()):
                raise ValueError("trajectory.npz has a row of a phase not in flows.csv")
            if not (np.diff(run.time) > 0).all():
                raise ValueError("the rows of trajectory.npz are not in time's order")
            times = run.phase, run.time, run.commands["time"]
            flows.require_times(run.phases, *times, run.scenario.timestep)
        weighed = run.summary.weighed
        if weighed and weighed.prediction not in [*run.predicted]:
            raise ValueError(f"unknown prediction {weighed.prediction!r}")
    return run
