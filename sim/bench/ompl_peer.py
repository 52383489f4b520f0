"""OMPL as a peer: kinematic planners that sample strokes, and a closed form.

The propagator is the stratified kinematics, called from C++ in Python, so these
planners see far fewer samples in a second than they would natively. The closed form of
Reeds and Shepp may also go straight, which both tripods approach by ever smaller
strokes: no plan has less swing travel. This needs the extra `peers`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ompl import base, control, util

from sim.bench.arcs import START, Pose, Stroke, Task

PLANNERS = ("RRT", "EST", "KPIECE1")
PATIENCE = 3.0  # [s] given to each
NEAR = 0.1  # of the way, where they are content
STEP = 0.05  # of the way, of which strokes are multiples
LONGEST = 40  # steps of a stroke
SEED = 1  # time still decides how far they get
ROOM = 3.0  # radii around start and goal


def reeds_shepp(task: Task) -> float:
    """Lower bound on the swing travel of all plans [rad]."""
    space = base.ReedsSheppStateSpace(task.arcs.radius)
    length = space.distance(_state(space, START), _state(space, task.goal))
    return float(length / task.arcs.stride)


def sampled(task: Task, planner: str) -> list[Stroke]:
    """Strokes of the path that a planner finds in time, near the goal or not.

    Args:
        task: What to reach.
        planner: Name of one of OMPL's kinematic planners.
    """
    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(SEED)
    space = base.SE2StateSpace()
    space.setBounds(_around(task))
    setup = control.SimpleSetup(_choices(space))
    setup.setStateValidityChecker(lambda state: space.satisfiesBounds(state))

    def propagate(state: Any, chosen: Any, duration: float, result: Any) -> None:
        pose = (state.getX(), state.getY(), state.getYaw())
        side, swing = _stroke(chosen, duration)
        _place(result, task.arcs.after(pose, side, swing, math))

    setup.setStatePropagator(propagate)
    start, goal = _state(space, START), _state(space, task.goal)
    way = math.hypot(*task.goal[:2])
    setup.setStartAndGoalStates(start, goal, NEAR * way)
    information = setup.getSpaceInformation()
    information.setPropagationStepSize(STEP * way / task.arcs.stride)
    information.setMinMaxControlDuration(1, LONGEST)
    setup.setPlanner(getattr(control, planner)(information))
    setup.solve(PATIENCE)
    path = setup.getSolutionPath()
    runs = zip(path.getControls(), path.getControlDurations(), strict=True)
    return [_stroke(chosen, duration) for chosen, duration in runs]


def _choices(space: Any) -> Any:
    """Controls in [-2, 2]: the sign is the sense of a stroke, the size its tripod."""
    choices = control.RealVectorControlSpace(space, 1)
    bounds = base.RealVectorBounds(1)
    bounds.setLow(-2.0)
    bounds.setHigh(2.0)
    choices.setBounds(bounds)
    return choices


def _stroke(chosen: Any, duration: float) -> Stroke:
    return (1 if abs(chosen[0]) < 1 else -1, math.copysign(duration, chosen[0]))


def _around(task: Task) -> Any:
    bounds = base.RealVectorBounds(2)
    room = ROOM * task.arcs.radius
    for axis in range(2):
        bounds.setLow(axis, min(0.0, task.goal[axis]) - room)
        bounds.setHigh(axis, max(0.0, task.goal[axis]) + room)
    return bounds


def _state(space: Any, pose: Pose) -> Any:
    state = space.allocState()
    _place(state, pose)
    return state


def _place(state: Any, pose: Sequence[float]) -> None:
    state.setXY(pose[0], pose[1])
    state.setYaw(math.remainder(pose[2], math.tau))
