"""Names of the predictions: in files, for people, and of their arrays.

This is the only place that knows that `quasi_static` is shown as `quasi-static`.
"""

from __future__ import annotations

from typing import NamedTuple


class PredictionName(NamedTuple):
    """The names that one prediction goes by."""

    key: str  # in summary.json and in the columns of sweeps
    label: str  # for people, and as a value of `steer`
    prefix: str  # of its arrays in trajectory.npz

    def array(self, quantity: str) -> str:
        """Name of one of its arrays in trajectory.npz, such as `predicted_pose`."""
        return f"{self.prefix}_{quantity}"


IDEAL = PredictionName("ideal", "ideal", "predicted")
QUASI_STATIC = PredictionName("quasi_static", "quasi-static", "quasi_static")
IDENTIFIED = PredictionName("identified", "identified", "identified")
PREDICTIONS = {name.key: name for name in (IDEAL, QUASI_STATIC, IDENTIFIED)}
LABELS = tuple(name.label for name in PREDICTIONS.values())


def prediction_key(label: str) -> str:
    """Key of the prediction with a label, such as a scenario's `steer`."""
    return next(name.key for name in PREDICTIONS.values() if name.label == label)
