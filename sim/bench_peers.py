"""Peers on the walk sideways: the same two tripods, the same goal.

On the floor the hexapod moves along arcs, one circle a tripod, forward and back. What
is compared is wall time, how far from the goal a plan ends, and the swing travel of
loaded tripods. The stratified planner knows the arcs as vector fields only. OMPL
samples them, or takes the closed form of Reeds and Shepp. CasADi and IPOPT optimise
their lengths by multiple shooting; the best of many starts stands for the optimum.
Joint ranges are left out: swings in the air cost nothing here, so that a long stride
can be cut in as many as the range asks for. Needs the extra `peers`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from models.equations import Equations, equations
from models.robot import load
from planner.errors import ConvergenceError
from planner.execution import Coordinates, Execution
from planner.extended import extend
from planner.paths import line
from planner.plan import Plan, plan
from planner.rollout import rollout
from planner.shooting import aim
from sim.errors import UsageError

GOAL = (0.15, 0.15, 0.0)  # x [m], y [m], yaw [rad], of the scenario `line`
SEGMENTS = 40  # likewise
ARCS = 8  # of which the optimum uses fewer
STARTS = 40  # of the optimisation
PATIENCE = 5.0  # [s] given to sampling
NEAR = 0.01  # [m], where sampling is content
WORDS: Mapping[str, Coordinates] = {
    "the paper's words": "backward",
    "shortest words": "shortest",
}
LOADED = ("g1_1", "g2_2")  # fields that swing a tripod that stands
REPEATS = 5  # of what takes milliseconds; the median counts

Array = np.ndarray
Answer = tuple[Array, float]  # end, swing travel [rad]


@dataclass(frozen=True, slots=True)
class Peer:
    """How one planner did."""

    planner: str
    seconds: float
    end_error: float  # [m], yaw times the radius of the arcs
    swing_travel: float  # [rad], of loaded tripods
    over_optimum: float  # swing travel over that of the optimum

    def __str__(self) -> str:
        return (
            f"{self.planner:46}{1e3 * self.seconds:9.1f} ms, off by "
            f"{1e3 * self.end_error:7.2g} mm, {self.swing_travel:6.2f} rad, "
            f"{self.over_optimum:5.2f} of the optimum"
        )


@dataclass(frozen=True, slots=True)
class Arcs:
    """The body on the floor: tripod 1 swings it to the left, tripod 2 to the right."""

    stride: float  # [m/rad]
    yaw_gain: float  # [rad/rad]

    @property
    def radius(self) -> float:
        """Radius of both arcs [m]."""
        return self.stride / self.yaw_gain

    def after(self, pose: Any, side: int, swing: Any, functions: Any = np) -> list[Any]:
        """The pose after a swing, in numbers or in symbols.

        Args:
            pose: x [m], y [m], yaw [rad].
            side: 1 for tripod 1, -1 for tripod 2.
            swing: Angle to swing [rad].
            functions: Module that has `sin` and `cos` for the pose.
        """
        x, y, yaw = pose[0], pose[1], pose[2]
        turned = yaw + side * self.yaw_gain * swing
        radius = side * self.radius
        return [
            x + radius * (functions.sin(turned) - functions.sin(yaw)),
            y - radius * (functions.cos(turned) - functions.cos(yaw)),
            turned,
        ]

    def error(self, pose: Array) -> float:
        """Distance from the goal [m]."""
        x, y, yaw = np.asarray(pose) - GOAL
        return math.hypot(x, y, self.radius * yaw)


def peers() -> Iterator[Peer]:
    """All planners, the optimum first.

    Raises:
        UsageError: The extra is not installed.
    """
    for library in ("casadi", "ompl"):
        if find_spec(library) is None:
            raise UsageError(
                f"{library} is missing", "--peers", "install the extra: .[peers]"
            )
    hexapod = equations(load("hexapod"))
    first = hexapod.twists["g1_1"]
    arcs = Arcs(stride=first[0], yaw_gain=first[2])
    shooting = MultipleShooting(arcs)
    seconds, found = _timed(shooting.best, repeats=1)
    optimum = found[1]
    name = f"CasADi and IPOPT, best of {STARTS} starts"
    yield Peer(name, seconds, arcs.error(found[0]), optimum, 1.0)
    for name, solve, repeats in [
        ("CasADi and IPOPT, from one start", shooting.once, REPEATS),
        *plans(hexapod),
        ("OMPL, closed form of Reeds and Shepp", lambda: reeds_shepp(arcs), REPEATS),
        (f"OMPL, RRT for {PATIENCE:.0f} s at most", lambda: sampled(arcs), 1),
    ]:
        seconds, (end, travel) = _timed(solve, repeats)
        yield Peer(name, seconds, arcs.error(end), travel, travel / optimum)


def _timed(solve: Callable[[], Answer], repeats: int) -> tuple[float, Answer]:
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        answer = solve()
        times.append(time.perf_counter() - began)
    return float(np.median(times)), answer


def plans(
    hexapod: Equations, segments: int = SEGMENTS
) -> Iterator[tuple[str, Callable[[], Answer], int]]:
    """Plans in the paper's words and in the shortest, as coarse as can be aimed.

    Args:
        hexapod: What walks.
        segments: Number of pieces of one more plan, which keeps to the line.
    """
    compiled = extend(hexapod.system, hexapod.elements)
    goal = np.array([*GOAL, *[0.0] * (hexapod.system.dimension - 3)])
    path = line(np.zeros_like(goal), goal)
    for name, coordinates in WORDS.items():
        aimed = partial(
            aim, compiled, path, execution=Execution(coordinates=coordinates)
        )
        few = _fewest(aimed)
        count = f"{few} segment{'s' * (few > 1)}"
        yield f"{name}, {count}, aimed", partial(_played, aimed, few), REPEATS
    tracked = partial(plan, compiled, path)
    name = f"the paper's words, {segments} segments along the line"
    yield name, partial(_played, tracked, segments), REPEATS


def _fewest(planned: Callable[[int], Plan]) -> int:
    """The smallest number of segments that can be aimed."""
    for segments in range(1, SEGMENTS):
        try:
            planned(segments)
        except ConvergenceError:
            continue
        return segments
    return SEGMENTS


def _played(planner: Callable[[int], Plan], segments: int) -> Answer:
    planned = planner(segments)
    loaded = (f for f in planned.flows if f.field in LOADED)
    return rollout(planned)[-1, :3], sum(abs(flow.duration) for flow in loaded)


class MultipleShooting:
    """The arcs' lengths as a nonlinear program: poses between them are unknowns too."""

    def __init__(self, arcs: Arcs) -> None:
        import casadi

        self._arcs = arcs
        forward, back = (casadi.SX.sym(name, ARCS) for name in ("forward", "back"))
        poses = casadi.SX.sym("poses", 3, ARCS)
        gaps = []
        for k, side in enumerate(_sides()):
            before = poses[:, k - 1] if k else np.zeros(3)
            after = arcs.after(before, side, forward[k] - back[k], casadi)
            gaps.append(casadi.vertcat(*after) - poses[:, k])
        gaps.append(poses[:, -1] - np.array(GOAL))
        program = {
            "x": casadi.vertcat(forward, back, casadi.vec(poses)),
            "f": casadi.sum1(forward + back),
            "g": casadi.vertcat(*gaps),
        }
        quiet: dict[str, Any] = {
            "ipopt.print_level": 0,
            "print_time": False,
            "ipopt.sb": "yes",
        }
        self._solver = casadi.nlpsol("solver", "ipopt", program, quiet)
        self._lowest = np.concatenate([np.zeros(2 * ARCS), np.full(3 * ARCS, -np.inf)])

    def once(self, swings: Array | None = None) -> Answer:
        """Swings from one start, by default a tenth of a radian each."""
        swings = np.full(ARCS, 0.1) if swings is None else swings
        poses = _poses(self._arcs, swings)
        guess = np.concatenate(
            [np.maximum(swings, 0), np.maximum(-swings, 0), poses.ravel()]
        )
        found = np.array(self._solver(x0=guess, lbx=self._lowest, lbg=0, ubg=0)["x"])
        swings = found[:ARCS, 0] - found[ARCS : 2 * ARCS, 0]
        return _poses(self._arcs, swings)[-1], float(np.abs(swings).sum())

    def best(self) -> Answer:
        """The shortest of many that meet the goal."""
        rng = np.random.default_rng(0)
        answers = [self.once(rng.normal(size=ARCS)) for _ in range(STARTS)]
        met = [answer for answer in answers if self._arcs.error(answer[0]) < 1e-6]
        return min(met, key=lambda answer: answer[1])


def _sides() -> list[int]:
    return [1, -1] * (ARCS // 2)


def _poses(arcs: Arcs, swings: Array) -> Array:
    """Poses after each arc, shape (ARCS, 3)."""
    poses = [[0.0, 0.0, 0.0]]
    for side, swing in zip(_sides(), swings, strict=True):
        poses.append(arcs.after(poses[-1], side, swing))
    return np.array(poses[1:])


def reeds_shepp(arcs: Arcs) -> Answer:
    """The shortest path with bounded curvature; straight pieces take both tripods."""
    from ompl import base

    space = base.ReedsSheppStateSpace(arcs.radius)
    start, goal = _state(space, (0.0, 0.0, 0.0)), _state(space, GOAL)
    return np.array(GOAL), space.distance(start, goal) / arcs.stride


def sampled(arcs: Arcs) -> Answer:
    """Arcs sampled by a kinematic planner, until one path ends near or time is up."""
    from ompl import base, control, util

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(1)
    space = base.SE2StateSpace()
    space.setBounds(_bounds(base, 2, 3 * max(GOAL)))
    controls = control.RealVectorControlSpace(space, 1)  # its sign runs, its size picks
    controls.setBounds(_bounds(base, 1, 2.0))
    setup = control.SimpleSetup(controls)
    setup.setStateValidityChecker(lambda state: True)

    def propagate(state: Any, chosen: Any, duration: float, result: Any) -> None:
        side = 1 if abs(chosen[0]) < 1 else -1
        pose = (state.getX(), state.getY(), state.getYaw())
        swing = math.copysign(duration, chosen[0])
        _place(result, arcs.after(pose, side, swing))

    setup.setStatePropagator(propagate)
    setup.setStartAndGoalStates(
        _state(space, (0.0, 0.0, 0.0)), _state(space, GOAL), NEAR
    )
    information = setup.getSpaceInformation()
    information.setPropagationStepSize(0.1)  # [rad] of swing
    information.setMinMaxControlDuration(1, 20)
    setup.setPlanner(control.RRT(information))
    setup.solve(PATIENCE)
    path = setup.getSolutionPath()
    end = path.getState(path.getStateCount() - 1)
    return np.array([end.getX(), end.getY(), end.getYaw()]), sum(
        path.getControlDurations()
    )


def _bounds(base: Any, size: int, largest: float) -> Any:
    bounds = base.RealVectorBounds(size)
    bounds.setLow(-largest)
    bounds.setHigh(largest)
    return bounds


def _state(space: Any, pose: tuple[float, ...]) -> Any:
    state = space.allocState()
    _place(state, pose)
    return state


def _place(state: Any, pose: Any) -> None:
    state.setX(pose[0])
    state.setY(pose[1])
    state.setYaw(math.remainder(pose[2], math.tau))
