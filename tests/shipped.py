"""Robots and worlds that come with the package are built once for many tests.

Walks of a sweep share them in the same way, and have the numbers of those that do not.
"""

from copy import copy
from functools import cache

from models import shipped_robots
from sim.preparation import setup
from sim.preparation.shared import Shared


class Shipped(Shared):
    """Things built of shipped robots; models are copies, which a test may change."""

    def cached(self, kind, key, build, most=32):
        """A thing that was built before; that of another's robot is built anew."""
        robot, *_ = key
        if not (robot in shipped_robots() if kind == "robot" else robot.is_shipped):
            return build()
        found = super().cached(kind, key, build, most)
        return (found[0], copy(found[1])) if kind == "world" else found


def share():
    """Whatever is prepared in this process shares them, unless told what to share."""
    setup.Shared = cache(Shipped)
