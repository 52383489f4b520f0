"""What trajectory.npz holds: the achieved motion beside every prediction."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from planner import Array
from sim.evaluation.assessment import Evaluation


def trajectory(evaluation: Evaluation) -> Iterator[tuple[str, Array]]:
    """The arrays of trajectory.npz, one after another."""
    walk, achieved = evaluation.walk, evaluation.achieved
    recording, predicted = walk.recording, evaluation.predicted
    moments, ideal = recording.moments, predicted["ideal"]
    starts = np.array([phase.start for phase in walk.phases])
    arrays = {
        "time": moments.step * recording.timestep,
        "qpos": moments.qpos,
        "qvel": moments.qvel,
        "achieved_pose": achieved.pose,
        "predicted_pose": ideal.pose,
        "contact": achieved.contact,
        "planned_contact": ideal.contact,
        "slip": achieved.slip,
        "predicted_slip": ideal.slip,
        "achieved_margin": achieved.margin,
        "predicted_margin": ideal.margin,
        "contact_point": achieved.point,
        "center_of_mass": achieved.center_of_mass,
        "phase": np.searchsorted(starts, recording.during, side="right") - 1,
    }
    for name, prediction in predicted.items():
        if name != "ideal":
            arrays[f"{name}_pose"] = prediction.pose
            arrays[f"{name}_slip"] = prediction.slip
            arrays[f"{name}_margin"] = prediction.margin
    for name, clearance in evaluation.clearance.items():
        arrays[f"{'predicted' if name == 'ideal' else name}_clearance"] = clearance
    for name, array in arrays.items():
        yield name, array[recording.marks.sampled]
    yield "world_start_pose", walk.origin
