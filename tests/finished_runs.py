"""Finished runs with other contents, for tests of what shows them."""

from dataclasses import replace

from sim.evaluation.flows import WalkedPhase


def predicted_elsewhere(run, place):
    """The run with the poses that predictions have replaced by `place(poses)`."""
    names = ("predicted_pose", "quasi_static_pose", "compliant_pose")
    moved = {name: place(run.arrays[name]) for name in names}
    return replace(run, arrays={**run.arrays, **moved})


def phase(kind, stratum, group):
    """A phase of which only the words matter."""
    return WalkedPhase(0, 0.0, 1.0, kind, stratum, "", 0.0, group, 0.0, True)
