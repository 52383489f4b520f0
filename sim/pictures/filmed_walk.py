"""A finished walk for a film, read from its run folder, in world coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

from models import Card
from models.description import read_card
from planner import Array
from planner.support import open_file
from sim.finished_run import arrays_of, nominal_poses, phases_of, reading
from sim.motion.poses import rotate
from sim.palette import Colour
from sim.scenarios.file import load_scenario
from sim.scenarios.scenario import Scenario

NOSE = "nose"  # geom on the front of the shipped robots
PREDICTIONS = {"predicted_pose": "ideal", "quasi_static_pose": "quasi_static"}


class FlowRow(NamedTuple):
    """One line of flows.csv, as far as films show it."""

    kind: str  # hold, lift, swing or land
    stratum: str  # groups in contact
    group: str  # that move; empty in a hold
    segment: int = 0


@dataclass(frozen=True)
class FilmedWalk:
    """A walk, row by row: shapes (T, ...), poses and positions in the world."""

    model: Path  # MJCF file
    card: Card
    scenario: Scenario
    flows: tuple[FlowRow, ...]
    time: Array  # (T,) [s]
    phase: Array  # index into flows, (T,)
    qpos: Array  # (T, nq)
    achieved: Array  # (T, 3)
    predicted: dict[str, Array]  # by the prediction's name, (T, 3) each
    contact: Array  # (T, F), bool
    contact_point: Array  # where each foot stands, or last stood, (T, F, 2) [m]
    center_of_mass: Array  # projected on the floor, (T, 2) [m]
    margin: Array  # (T,) [m]
    clearance: Array | None  # from obstacles, where there are any, (T,) [m]
    nominal: Array  # (N, 3)
    nose: Colour | None  # of the part that shows which side is the front

    @property
    def ideal(self) -> Array:
        """Poses predicted by the paper's fields, (T, 3)."""
        return self.predicted["ideal"]

    @property
    def segments(self) -> int:
        """How many were walked; bounds may have cut those of the scenario."""
        return 1 + max(flow.segment for flow in self.flows)

    @cached_property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups of legs."""
        return tuple(self.card.groups)

    @cached_property
    def group_of_foot(self) -> tuple[int, ...]:
        """Index of each foot's group, feet in ascending order of their legs."""
        return tuple(self.card.group_of_leg.values())

    @cached_property
    def legs_per_group(self) -> int:
        """How many legs every group has; 0 where the groups differ."""
        sizes = {len(group.legs) for group in self.card.groups.values()}
        return sizes.pop() if len(sizes) == 1 else 0

    @cached_property
    def reach(self) -> float:
        """Largest distance from the body's centre to a foot at the end [m]."""
        feet = self.contact_point[-1] - self.achieved[-1, :2]
        return float(np.hypot(*feet.T).max())


def read_walk(folder: Path) -> FilmedWalk:
    """Read a run folder.

    Raises:
        UsageError: If it is not the folder of a finished run.
    """
    with reading(folder, "no film of an unfinished run"):
        return _read(folder)


def _read(folder: Path) -> FilmedWalk:
    open_file(folder / "model.xml").close()  # the processes that draw will need it
    scenario = load_scenario(str(folder / "scenario.toml"))
    arrays = arrays_of(folder, "trajectory.npz")
    start = arrays["world_start_pose"]
    return FilmedWalk(
        model=folder / "model.xml",
        card=read_card(folder / "model.toml"),
        scenario=scenario,
        flows=tuple(
            FlowRow(row["kind"], row["stratum"], row["group"], int(row["segment"]))
            for row in phases_of(folder)
        ),
        time=arrays["time"],
        phase=arrays["phase"],
        qpos=arrays["qpos"],
        achieved=_in_world(start, arrays["achieved_pose"]),
        predicted={
            name: _in_world(start, arrays[key])
            for key, name in PREDICTIONS.items()
            if key in arrays
        },
        contact=arrays["contact"],
        contact_point=_points_in_world(start, arrays["contact_point"]),
        center_of_mass=_points_in_world(start, arrays["center_of_mass"][:, :2]),
        margin=arrays["achieved_margin"],
        clearance=arrays.get("achieved_clearance"),
        nominal=_in_world(start, nominal_poses(scenario.path)),
        nose=_colour_of(folder / "model.xml", NOSE),
    )


def _colour_of(model: Path, name: str) -> Colour | None:
    """Colour of a geom in an MJCF file; None where there is no such geom."""
    geoms = mujoco.MjSpec.from_file(str(model)).geoms
    for red, green, blue, _ in (geom.rgba for geom in geoms if geom.name == name):
        return Colour(round(255 * red), round(255 * green), round(255 * blue))
    return None


def _points_in_world(start: Array, points: Array) -> Array:
    """Points given in the frame of the start pose, shape (..., 2)."""
    return start[:2] + rotate(points, start[2])


def _in_world(start: Array, pose: Array) -> Array:
    """Poses given in the frame of the start pose, shape (..., 3)."""
    yaw = pose[..., 2:] + start[2]
    return np.concatenate([_points_in_world(start, pose[..., :2]), yaw], axis=-1)
