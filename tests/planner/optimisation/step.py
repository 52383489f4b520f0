"""A step of the biped as a problem for the optimiser."""

import numpy as np

from models.systems.catalogue import shipped_system
from planner.extension.extended import extend
from planner.optimisation.corridor import Tolerance
from planner.optimisation.optimise import Criterion, Optimiser
from planner.optimisation.stages import cycle
from planner.optimisation.task import Task
from planner.planning.paths import line

BIPED = shipped_system("biped")
EXTENDED = extend(BIPED.system, BIPED.elements)
STEP = line(np.zeros(7), [0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
POINTS_ALONG = np.linspace(0, 1, 1001)
POINTS = STEP.at(POINTS_ALONG)
POSITION, YAW, SPAN = 0.5, 1.0, 0.6


def time_of(flows):
    return sum(abs(flow.duration) for flow in flows)


def optimised(path=STEP, objective="time", hops=0, **changes):
    system = BIPED.system
    given = {
        "system": system,
        "stages": cycle(system, BIPED.elements),
        "tolerances": (Tolerance((0, 1), POSITION), Tolerance((2,), YAW)),
        "limits": {3: (-SPAN, SPAN), 4: (-SPAN, SPAN)},
    }
    criterion = Criterion(objective, time_of)
    task = Task(**(given | changes))
    return Optimiser(task, criterion, EXTENDED, path, 4, hops=hops)


def within(position):
    """The tolerances with another one of the position."""
    return Tolerance((0, 1), position), Tolerance((2,), YAW)
