"""Seals of a run: digests by which files of one walk are known to belong together.

They hold no secret, so that they guard against mixtures and slips alone. `model.toml`
has none, since servos may be mounted anew.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Mapping
from pathlib import Path

from planner.support import open_file
from sim.scenarios.settings import SETTINGS

MODEL = "model.xml"  # whose seal waits until it was inspected
FREE = {k for k, s in SETTINGS.items() if s.affects <= {"label", "film", "refusal"}}
TOLD = ("seals", "timing")  # of summary.json; a film that is drawn takes time
WHOLE = ("commands.npz", "trajectory.npz", "flows.csv", "feedback.csv")


def seals(
    folder: Path, scenario: Mapping[str, object], summary: Mapping[str, object]
) -> dict[str, str | None]:
    """Seals of all files but the model, from what two of them hold."""
    tables = {
        "scenario.toml": _seal_of_table(scenario, FREE),
        "summary.json": _seal_of_table(summary, TOLD),
    }
    return tables | {name: seal(folder / name) for name in WHOLE}


def seal(path: Path) -> str | None:
    """Digest of a file; None if it is not there."""
    if not path.exists():
        return None
    with open_file(path) as file:
        return hashlib.sha256(file.read()).hexdigest()[:16]


def _seal_of_table(table: Mapping[str, object], without: Collection[str]) -> str:
    own = {key: value for key, value in table.items() if key not in without}
    plain = json.loads(json.dumps(own, default=str))  # as it is read
    text = json.dumps(plain, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]
