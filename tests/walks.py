"""Walks in memory, judged by what costs no physics of its own."""

from sim.simulation import simulate

COSTLY = ("identified", "compliant", "creep_floor")


def simulated(scenario):
    """A scenario planned, walked and compared with all but measured predictions."""
    return simulate(scenario, without=COSTLY)
