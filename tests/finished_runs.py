"""Finished runs with other contents, for tests of what shows them."""

import json
from dataclasses import replace

from models.description import parse_toml
from sim.evaluation.flows import WalkedPhase
from sim.runs.seals import MODEL, seal, seals


def predicted_elsewhere(run, place):
    """The run with the poses that predictions have replaced by `place(poses)`."""
    names = ("predicted_pose", "quasi_static_pose", "compliant_pose")
    moved = {name: place(run.arrays[name]) for name in names}
    return replace(run, arrays={**run.arrays, **moved})


def phase(kind, stratum, group):
    """A phase of which only the words matter."""
    return WalkedPhase(0, 0.0, 1.0, kind, stratum, "", 0.0, group, 0.0, True)


def reset(folder, change, **numbers):
    """Give a run other settings, and numbers of its summary, as if it had had them."""
    text = (folder / "scenario.toml").read_text()
    changed = change(text)
    assert changed != text
    (folder / "scenario.toml").write_text(changed)
    sealed(folder, **numbers)


def sealed(folder, **numbers):
    """Make whatever files a run has been given, and numbers of its summary, its own."""
    path = folder / "summary.json"
    summary = json.loads(path.read_text()) | numbers
    names = "scenario.toml", "model.toml"
    tables = [parse_toml((folder / name).read_text()) for name in names]
    summary["seals"] = seals(folder, *tables, summary)
    summary["seals"][MODEL] = seal(folder / MODEL)
    path.write_text(json.dumps(summary))
