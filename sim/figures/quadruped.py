"""Fig. 3: the strata of four feet, and a crawl that lifts one at a time."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.axes import Axes

from sim.figures.biped import of_robots, of_systems
from sim.figures.physics import Walked
from sim.figures.sheet import Shown


def paper(axes: Mapping[str, Axes]) -> Shown:
    """The crawl of four legs within all sets of their feet."""
    return of_systems([axes["a"]], ["quadruped-crawl"])


def metres(axes: Mapping[str, Axes], walks: Mapping[str, Walked]) -> Shown:
    """The robot that crawls in MuJoCo, with its margins."""
    return of_robots([axes["a"]], ["quadruped"])
