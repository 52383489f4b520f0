"""Feedback from noisy poses: an extended Kalman filter of pose and of what is missed.

What an imperfect robot misses in a segment is nearly the same all along a walk, and
changes with the direction in which it goes: a motion that is meant to be u becomes
u + b + A u and some scatter, all in the frame in which the segment begins. The filter
estimates the pose, b, A, and offset and rate of a gyroscope.
"""

from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from planner import Array
from sim.feedback.sensing import Sensing
from sim.motion.poses import compose, rotate, seen_from, wrap

POSE, BIAS, SLOPE = slice(0, 3), slice(3, 6), slice(6, 15)
OFFSET, DRIFT = 15, 16  # of the gyroscope
STATES = 17
GATE = 11.345  # 99 % of chi-squared with three degrees of freedom
STRANGE = 3  # readings in a row beyond the gate that mean that the robot was moved
LEAST = 1e-12  # standard deviation [m], [rad], which keeps exact readings regular
ABSURD = 1e9  # [m], [rad] or [s]; what is more is a mistake
MOST = np.repeat([10, 1e6], [12, 78])  # of b [m, rad] and A, and of their covariance
LEAST_DONE = 0.1  # share of what is meant, below which no segment can make up for it
LOWER = np.tril_indices(12)  # of the covariance of b and A


class Misses(NamedTuple):
    """Standard deviations of what a segment misses, lengths as shares of a radius.

    The defaults are those of twenty hobby robots, rounded up.
    """

    bias: Array = np.array([0.015, 0.015, 0.010])  # of b before anything is seen, (3,)
    slope: Array = np.outer([1, 1, 0.8], [0.1, 0.1, 0.02])  # of A, likewise, (3, 3)
    scatter: Array = np.array([0.001, 0.001, 0.0012])  # of a miss about b + A u, (3,)
    wander: Array = np.array([0.05e-3] * 3)  # of what b changes in a segment, (3,)


NONE_MISSED = Misses(bias=np.zeros(3), slope=np.zeros((3, 3)), wander=np.zeros(3))
"""Those of a robot whose segments miss nothing that could be learnt."""


@dataclass(frozen=True)
class Learnt:
    """What a walk has learnt of its robot, for the next walk."""

    bias: Array  # b, x and y [m] and yaw [rad], (3,)
    slope: Array  # A, (3, 3)
    covariance: Array  # of the entries of b and of the rows of A, (12, 12)

    @property
    def numbers(self) -> tuple[float, ...]:
        """As files have it: b, the rows of A, and the lower half of the covariance."""
        parts = self.bias, self.slope.ravel(), self.covariance[LOWER]
        return tuple(np.concatenate(parts).tolist())

    def __str__(self) -> str:
        return f"[learnt]\nnumbers = [{', '.join(map(repr, self.numbers))}]\n"

    @classmethod
    def of(cls, numbers: tuple[float, ...]) -> Self:
        """What files have; a ValueError says what is wrong with it."""
        if len(numbers) != 90:
            raise ValueError(f"90 numbers are needed, got {len(numbers)}")
        bias, slope = np.array(numbers[:3]), np.reshape(numbers[3:12], (3, 3))
        if not (np.abs(numbers) <= MOST).all():
            raise ValueError(f"b and A must be finite numbers, none beyond {MOST[0]:g}")
        if np.abs(np.linalg.eigvals(np.eye(3) + slope)).min() < LEAST_DONE:
            raise ValueError(f"less than {LEAST_DONE:.0%} of a segment would be walked")
        half = np.zeros((12, 12))
        half[LOWER] = numbers[12:]
        whole = half + np.tril(half, -1).T
        if np.linalg.eigvalsh(whole).min() < -1e-12:
            raise ValueError("the covariance must be positive semidefinite")
        return cls(bias, slope, whole)


class Feedback:
    """Estimates pose and errors of segments from planned and measured motion.

    Poses are x, y [m] and yaw [rad] in the frame in which the walk starts.

    Args:
        sensing: The noise of the readings that it will get.
        radius: Mean distance of the feet from the body's centre [m].
        misses: What is expected of segments.
        learnt: What an earlier walk has learnt, in place of what `misses` expects.
        batch: Shape of many walks that are followed at once.

    Attributes:
        pose: Estimate of the pose, (..., 3).
        bias: Estimate of b in the error b + A u of a segment along u, (..., 3).
        slope: Estimate of A in the same error, (..., 3, 3).
        scatter: Standard deviation of the error about b + A u, (3,).
        covariance: Of pose, b, A by rows, offset and rate, (..., 17, 17).
        foreknown: Covariance of b before anything was seen, were A known, (..., 3, 3).

    Example:
        >>> from math import radians
        >>> from sim import Feedback, Sensing
        >>> camera = Sensing(position=0.002, yaw=radians(1))
        >>> feedback = Feedback(camera, radius=0.2)
        >>> meant = feedback.aim([0.005, 0.0, 0.0])  # walk this, and then
        >>> feedback.moved(meant)
        >>> feedback.seen([0.004, 0.001, 0.02])
        >>> bool(feedback.pose[0] < 0.005)
        True
    """

    def __init__(
        self,
        sensing: Sensing,
        radius: float,
        misses: Misses | None = None,
        learnt: Learnt | None = None,
        batch: tuple[int, ...] = (),
    ) -> None:
        misses = Misses() if misses is None else misses
        self.sensing, self.batch = sensing, batch
        if not 0.0 < radius < np.inf:
            raise ValueError(f"radius is {radius}; give a distance beyond 0 [m]")
        unit = np.array([radius, radius, 1.0])
        self.scatter, self._wander = misses.scatter * unit, misses.wander * unit
        self.pose, self.bias = np.zeros((*batch, 3)), np.zeros((*batch, 3))
        self.slope = np.zeros((*batch, 3, 3))
        self.gyro = np.zeros((*batch, 2))  # offset [rad] and rate [rad/s]
        first = np.zeros(STATES)
        first[BIAS] = misses.bias * unit
        first[SLOPE] = (misses.slope * np.outer(unit, 1 / unit)).ravel()
        first[DRIFT] = sensing.gyro_drift
        self.covariance = np.broadcast_to(np.diag(first**2), (*batch, STATES, STATES))
        if learnt is not None:
            self.bias, self.slope = self.bias + learnt.bias, self.slope + learnt.slope
            self.covariance = self.covariance.copy()
            self.covariance[..., 3:15, 3:15] = learnt.covariance
        self._strange = np.zeros(batch, int)
        self.foreknown = _given_slope(self.covariance[..., 3:15, 3:15])

    @property
    def claimed(self) -> Array:
        """Standard deviation that it claims for its pose, (..., 3) [m], [rad]."""
        variances = np.diagonal(self.covariance, axis1=-2, axis2=-1)[..., POSE]
        return np.sqrt(np.maximum(variances, 0.0))

    @property
    def learnt(self) -> Learnt:
        """What one walk has learnt of its robot."""
        return Learnt(self.bias, self.slope, self.covariance[3:15, 3:15])

    def missing(self, meant: ArrayLike) -> Array:
        """What a meant motion is expected to miss, b + A u, (..., 3)."""
        return self.bias + (self.slope @ np.asarray(meant)[..., None])[..., 0]

    def aim(self, target: ArrayLike) -> Array:
        """The motion to mean so as to end at a target, in the robot's frame.

        It is (I + A)^-1 (wanted - b), shape (..., 3); x, y [m], yaw [rad].
        """
        wanted = seen_from(self.pose, self._motion(target, "target"))
        left = (wanted - self.bias)[..., None]
        return np.linalg.solve(np.eye(3) + self.slope, left)[..., 0]

    def _motion(self, given: ArrayLike, what: str) -> Array:
        """A pose or step of every walk, (..., 3)."""
        numbers = np.asarray(given, dtype=float)
        if numbers.shape[-1:] != (3,) or not (np.abs(numbers) < ABSURD).all():
            raise ValueError(f"the {what} {given!r} is not x, y [m] and yaw [rad]")
        return np.broadcast_to(numbers, self.pose.shape)

    def moved(self, meant: ArrayLike, seconds: float = 1.0) -> None:
        """Take note of a segment that was walked, and of the time that it took [s]."""
        meant = self._motion(meant, "step")
        if not 0.0 <= seconds < ABSURD:
            raise ValueError(f"a step of {seconds} s; give the time that it took")
        step = meant + self.missing(meant)
        turn = np.zeros((*self.batch, 3, 3))
        for axis in range(2):
            turn[..., :2, axis] = rotate(np.eye(2)[axis], self.pose[..., 2])
        turn[..., 2, 2] = 1.0
        moves = np.tile(np.eye(STATES), (*self.batch, 1, 1))  # derivative by the state
        moves[..., POSE, BIAS] = turn
        by_slope = turn[..., None] * meant[..., None, None, :]
        moves[..., POSE, SLOPE] = by_slope.reshape(*self.batch, 3, 9)
        moves[..., :2, 2] = rotate(step[..., :2], self.pose[..., 2] + np.pi / 2)
        moves[..., OFFSET, DRIFT] = seconds
        added = np.zeros((*self.batch, STATES, STATES))
        added[..., POSE, POSE] = (turn * self.scatter**2) @ np.swapaxes(turn, -1, -2)
        added[..., BIAS, BIAS] = np.diag(self._wander**2)
        added[..., OFFSET, OFFSET] = (self.sensing.gyro_noise or 0.0) ** 2 * seconds
        self.covariance = moves @ self.covariance @ np.swapaxes(moves, -1, -2) + added
        self.pose = compose(self.pose, step)
        self.gyro = self.gyro + self.gyro[..., 1:] * [seconds, 0.0]

    def seen(
        self, pose: ArrayLike | None = None, gyro: ArrayLike | None = None
    ) -> None:
        """Take a reading: a camera's pose (..., 3), a gyroscope's yaw (...,).

        What was not measured is None or NaN; infinite noise tells nothing either. A
        reading farther off than 99 % should be counts for less the farther it is. After
        three in a row the robot was moved: its pose is learnt anew, not what it misses.
        """
        if gyro is not None:
            reading = np.asarray(gyro, dtype=float)[..., None]
            expected = (self.pose[..., 2] + self.gyro[..., 0])[..., None]
            self._take(wrap(reading - expected), [(2, OFFSET)], np.array([LEAST]))
        if pose is None:
            return
        reading = np.asarray(pose, dtype=float)
        if reading.shape[-1:] != (3,) or (np.abs(reading) >= ABSURD).any():
            raise ValueError(f"{pose} is not x, y [m] and yaw [rad], or NaN")
        off = reading - self.pose
        off[..., 2] = wrap(off[..., 2])
        noise = np.maximum(self.sensing.noise, LEAST)
        self._take(off, [(0,), (1,), (2,)], noise, gated=not self.sensing.is_exact)
        if self.sensing.is_exact:
            self.pose = np.where(np.isnan(reading), self.pose, reading)

    def _take(
        self, off: Array, sums: list[tuple[int, ...]], noise: Array, gated: bool = False
    ) -> None:
        """Update by how far readings of sums of the state are off what is expected."""
        given = np.isfinite(off) & np.isfinite(noise)
        reads = np.zeros((len(sums), STATES))
        for row, states in enumerate(sums):
            reads[row, list(states)] = 1.0
        seeing = given[..., None] * reads  # a reading that is missing sees nothing
        off = np.where(given, off, 0.0)
        doubt = np.where(given, noise, 1.0)[..., None] ** 2 * np.eye(len(sums))
        if gated:
            doubt = self._gate(off, seeing, doubt, np.asarray(given.any(axis=-1)))
        spread = seeing @ self.covariance
        total = spread @ np.swapaxes(seeing, -1, -2) + doubt
        gain = np.swapaxes(np.linalg.solve(total, spread), -1, -2)
        change = (gain @ off[..., None])[..., 0]
        left = self.covariance - gain @ spread
        self.covariance = (left + np.swapaxes(left, -1, -2)) / 2
        self.pose = self.pose + change[..., POSE]
        self.bias = self.bias + change[..., BIAS]
        self.slope = self.slope + change[..., SLOPE].reshape(self.slope.shape)
        self.gyro = self.gyro + change[..., OFFSET:]

    def _gate(self, off: Array, seeing: Array, doubt: Array, given: Array) -> Array:
        """Variance of a reading, raised where it is farther off than it should be."""
        total = seeing @ self.covariance @ np.swapaxes(seeing, -1, -2) + doubt
        solved = np.linalg.solve(total, off[..., None])[..., 0]
        beyond = (off * solved).sum(axis=-1) / GATE
        self._strange = np.where(beyond > 1, self._strange + 1, self._strange * ~given)
        was_moved = self._strange >= STRANGE
        shifted = np.where(was_moved[..., None], off**2, 0.0)
        self.covariance = self.covariance.copy()
        self.covariance[..., POSE, POSE] += shifted[..., None] * np.eye(3)
        self._strange = np.where(was_moved, 0, self._strange)
        factor = np.where(was_moved, 1.0, np.maximum(beyond, 1.0) ** 2)
        return doubt * factor[..., None, None]


def _given_slope(covariance: Array) -> Array:
    """Covariance (..., 3, 3) of b if A were known, from that of both, (..., 12, 12)."""
    across, slope = covariance[..., :3, 3:], covariance[..., 3:, 3:]
    told = across @ np.linalg.pinv(slope) @ np.swapaxes(across, -1, -2)
    return covariance[..., :3, :3] - told


def bound(
    sensing: Sensing,
    meant: Array,
    seen: Array,
    scatter: Array,
    seconds: Array,
    foreknown: Array,
) -> tuple[float, float]:
    """Least error of position [m] and yaw [rad] that any estimator could have.

    The posterior Cramer-Rao bound at the last stop but before its reading (Van Trees,
    Detection, Estimation and Modulation Theory), where nothing is unknown but a
    constant bias, foreknown with a covariance (3, 3). Motions (n, 3) were meant in so
    many seconds (n,), with a scatter (3,) about the bias; of readings (n, 4) it only
    counts which are NaN.
    """
    knows = Feedback(sensing, 1.0, NONE_MISSED._replace(scatter=scatter))
    knows.covariance = knows.covariance.copy()
    knows.covariance[BIAS, BIAS] = foreknown
    for k, motion in enumerate(meant):
        knows.moved(motion - knows.bias, float(seconds[k]))
        if k < len(meant) - 1:
            pose = np.append(knows.pose, knows.pose[2])
            reading = np.where(np.isnan(seen[k]), np.nan, pose)
            knows.seen(reading[:3], reading[3])
    x, y, yaw = knows.claimed
    return sqrt(x**2 + y**2), float(yaw)
