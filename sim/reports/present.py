"""The data from which the page's script describes the moment under the cursor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from planner import Array
from sim.pictures.clock import clock
from sim.runs.run import Run
from sim.scenarios.predictions import PREDICTIONS

ROWS = 1500  # at most


def moments(run: Run) -> Mapping[str, Any]:
    """Poses, distances and margins at moments evenly spread, for the script."""
    last = len(run.time) - 1
    rows = np.unique(np.linspace(0, last, min(ROWS, last + 1)).astype(int))
    off = 1e3 * np.hypot(*run.error(run.best)[rows, :2].T)
    phase = np.clip(run.phase[rows], 0, len(run.phases) - 1)
    margin = 1e3 * run.margin[rows]
    return {
        "time": np.round(run.time[rows], 3).tolist(),
        "x": _finite(1e3 * run.achieved[rows, 0], 2),
        "y": _finite(1e3 * run.achieved[rows, 1], 2),
        "off": _finite(off, 3),
        "margin": _finite(margin, 1),
        "phase": phase.tolist(),
        "phases": [_said(p.kind, p.stratum, p.group) for p in run.phases],
        "best": PREDICTIONS[run.best].label,
        "playback": clock(run.time, run.settings.get("playback")).playback,
        "begins": float(run.time[0]),
    }


def _finite(values: Array, digits: int) -> list[float | None]:
    """Rounded numbers; None for what JSON has no number for."""
    return [round(float(v), digits) if np.isfinite(v) else None for v in values]


def _said(kind: str, stratum: str, group: str) -> str:
    what = {
        "hold": "standing still",
        "lift": f"group {group} lifts off",
        "swing": f"group {group} swings",
        "land": f"group {group} touches down",
    }
    return f"stratum {stratum}, {what.get(kind, kind)}"
