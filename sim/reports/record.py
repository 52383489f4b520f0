"""A finished run as its folder records it, for pages that explain it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from models import Card
from models.description import parse_toml, read_card
from planner import Array
from planner.support import read_file
from sim.finished_run import arrays_of, nominal_poses, phases_of, reading
from sim.motion.poses import wrap
from sim.pictures.clock import clock
from sim.scenarios import body_path, obstacles

PREDICTIONS = {
    "ideal": "ideal",
    "quasi_static": "quasi-static",
    "identified": "identified",
}


class Phase(NamedTuple):
    """One line of flows.csv."""

    segment: int
    start: float  # [s]
    end: float  # [s]
    kind: str  # hold, lift, swing or land
    stratum: str  # groups in contact throughout
    field: str  # of a swing
    amount: float  # [rad]
    group: str  # that move; empty in a hold
    slip: float  # of all feet [m]
    as_planned: bool  # contacts


@dataclass(frozen=True)
class Record:
    """What a run folder says, lengths in metres and poses relative to the start."""

    folder: Path
    summary: Mapping[str, Any]
    settings: Mapping[str, Any]  # of scenario.toml
    card: Card
    card_text: str
    phases: tuple[Phase, ...]
    arrays: Mapping[str, Array]  # of trajectory.npz
    nominal: Array  # (N, 3)
    obstacles: tuple[Array, ...]  # outlines on the floor, (n, 2) each

    @property
    def title(self) -> str:
        """The folder's own name, by which people know the run."""
        return self.folder.name

    @property
    def time(self) -> Array:
        """Of each row [s], (T,)."""
        return self.arrays["time"]

    @cached_property
    def walking(self) -> slice:
        """Rows from the start of the walk on."""
        first = int(np.searchsorted(self.time, self.summary["walk_starts"] - 1e-9))
        return slice(min(first, len(self.time) - 1), None)

    @property
    def achieved(self) -> Array:
        """Poses in the physics, (T, 3)."""
        return self.arrays["achieved_pose"]

    @cached_property
    def predicted(self) -> dict[str, Array]:
        """Poses of each prediction that could be made, (T, 3)."""
        arrays = {name: self.arrays.get(key_of(name, "pose")) for name in PREDICTIONS}
        return {name: array for name, array in arrays.items() if array is not None}

    @property
    def best(self) -> str:
        """The prediction that the walk is measured by."""
        return "quasi_static" if "quasi_static" in self.predicted else "ideal"

    def error(self, name: str) -> Array:
        """Achieved less predicted pose, yaw wrapped, (T, 3)."""
        apart = self.achieved - self.predicted[name]
        return np.concatenate([apart[:, :2], wrap(apart[:, 2:])], axis=1)

    @property
    def legs(self) -> tuple[int, ...]:
        """Numbers of the legs, in the order of every array's feet."""
        return tuple(sorted(self.card.legs))

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups of legs."""
        return tuple(self.card.groups)

    @cached_property
    def playback(self) -> float:
        """Speed of the film against real time, whether there is a film or not."""
        return clock(self.time, self.settings.get("playback")).playback


def key_of(prediction: str, quantity: str) -> str:
    """Name of a prediction's array in trajectory.npz."""
    return f"{'predicted' if prediction == 'ideal' else prediction}_{quantity}"


def read_run(folder: Path) -> Record:
    """Read a run folder.

    Args:
        folder: Of a run that came to its end, whatever that end was.

    Raises:
        UsageError: If it is not the folder of a finished run.
    """
    with reading(folder, "not the folder of a finished run"):
        return _read(folder.resolve())


def _read(folder: Path) -> Record:
    settings = parse_toml(read_file(folder / "scenario.toml").decode())
    return Record(
        folder=folder,
        summary=json.loads(read_file(folder / "summary.json")),
        settings=settings,
        card=read_card(folder / "model.toml"),
        card_text=read_file(folder / "model.toml").decode(),
        phases=tuple(map(_phase, phases_of(folder))),
        arrays=arrays_of(folder, "trajectory.npz", without=("qpos", "qvel")),
        nominal=nominal_poses(body_path.decode(settings["path"])),
        obstacles=tuple(
            piece.corners
            for obstacle in obstacles.decode(settings.get("obstacles", ()))
            for piece in obstacle.pieces
        ),
    )


def _phase(row: Mapping[str, str]) -> Phase:
    return Phase(
        int(row["segment"]),
        float(row["start"]),
        float(row["end"]),
        row["kind"],
        row["stratum"],
        row["field"],
        float(row["amount"]),
        row["group"],
        float(row["slip"]),
        row["as_planned"] == "1",
    )
