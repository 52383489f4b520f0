"""Many robots through many increments, each as long as its own contacts allow.

An increment in which feet touch, let go or change their load by much, and one without
an equilibrium, is repeated with a quarter of it. A lane ends that finds none, however
short the increment, or goes on in tiny ones alone, and one whose robot tips over.
"""

from dataclasses import dataclass

import numpy as np

from planner import Array
from sim.compliant.anatomy import Robots
from sim.compliant.increment import Done, Mechanics, State

LONGEST, SHORTEST = 0.02, 0.002  # [s]; increments that contacts and loads ask for
HOPELESS = 1e-6  # [s]; without an equilibrium even so, a lane ends
MOST_FAILED = 100  # increments that fail, with none of `SHORTEST` between, likewise
CALM = 0.08  # of the weight; a larger change of a load is resolved
SLACK = 1e-9  # [s]; times closer than this are the same
TIPPED = np.cos(np.deg2rad(30))  # of the body's tilt, beyond which it has tipped over


@dataclass(frozen=True, eq=False)
class Commands:
    """A row of commands for every joint and physics step.

    Smooth commands come to row k at the end of step k; held ones keep it until they
    change, and no increment lasts beyond that.
    """

    rows: Array  # (T, F, J) [rad]
    timestep: float  # [s]
    edges: Array  # times at which increments end, ascending, the last at the end [s]
    held: bool = False

    def over(self, begin: Array, end: Array) -> tuple[Array, Array]:
        """Commands at the beginning and the end of increments, (B, F, J) each."""
        if self.held:
            row = np.floor((begin + SLACK) / self.timestep).astype(int)
            now = self.rows[np.minimum(row, len(self.rows) - 1)]
            return now, now
        return self.at(begin), self.at(end)

    def at(self, time: Array) -> Array:
        """Smooth commands at times (B,), (B, F, J)."""
        steps = np.clip(time / self.timestep, 0.0, len(self.rows))
        whole = np.minimum(steps.astype(int), len(self.rows) - 1)
        part = (steps - whole)[:, None, None]
        before, now = self.rows[np.maximum(whole - 1, 0)], self.rows[whole]
        return (1 - part) * before + part * now


def changes(rows: Array, timestep: float) -> Array:
    """Times at which held commands (T, ...) change [s]."""
    flat = rows.reshape(len(rows), -1)
    return (1 + np.flatnonzero((np.diff(flat, axis=0) != 0).any(axis=1))) * timestep


@dataclass(frozen=True, eq=False)
class Track:
    """What lanes went through: their begins and the ends of all increments, by lane."""

    lane: Array  # (N,), int
    time: Array  # (N,) [s]
    place: Array  # of the root, (N, 3) [m]
    turned: Array  # (N, 3, 3)
    slip: Array  # of every foot in the increment, (N, F) [m]
    load: Array  # of every foot, normal to the floor, (N, F) [N]
    torque: Array  # of every servo, (N, F, J) [N m]
    center: Array  # of mass about the root, (N, 3) [m]
    point: Array  # where feet touch about the root, (N, F, 2) [m]

    def of(self, lane: int) -> slice:
        """The rows of a lane."""
        return slice(*np.searchsorted(self.lane, [lane, lane + 1]).tolist())


def march(
    mechanics: Mechanics,
    robots: Robots,
    commands: Commands,
    begin: Array,
    end: Array,
    yaw: Array,
) -> tuple[Track, Array, Array]:
    """Walk lanes (B,) from their begins to their ends [s], from a heading [rad] each.

    At its begin a robot stands unloaded in the joints' commands. Beside the track are
    the time at which a lane could not go on, else infinite, (B,) [s], and whether its
    robot tipped over there, (B,), bool.
    """
    lanes, time, until = np.arange(len(begin)), begin, end
    h, failed = np.full(len(begin), SHORTEST), np.zeros(len(begin), dtype=int)
    ended, tipped = np.full(len(begin), np.inf), np.zeros(len(begin), dtype=bool)
    first, _ = commands.over(begin, begin + SLACK)
    done = mechanics.standing(robots, first, yaw)
    state, rows = done.state, [_row(lanes, time, done, done.holds)]
    while len(lanes):
        edge = commands.edges[np.searchsorted(commands.edges, time + SLACK)]
        stop = np.minimum(time + h, np.minimum(edge, until))
        length = stop - time
        done = mechanics.increment(robots, state, *commands.over(time, stop), length)
        event = _eventful(state, done.state, CALM * robots.weight)
        accepted = done.holds & (~event | (length <= SHORTEST * (1 + SLACK)))
        if accepted.any():
            rows.append(_row(lanes, stop, done, accepted))
            state = state.put(accepted, done.state)
            time = np.where(accepted, stop, time)
        longer = np.where(event, SHORTEST, np.minimum(2 * h, LONGEST))
        shorter = np.maximum(length / 4, np.where(done.holds, SHORTEST, 0.0))
        h = np.where(accepted, np.maximum(longer, SHORTEST), shorter)
        failed = np.where(accepted & (length > SHORTEST / 2), 0, failed + ~done.holds)
        over = accepted & (done.state.turned[:, 2, 2] < TIPPED)
        lost = over | (~accepted & (h < HOPELESS)) | (failed > MOST_FAILED)
        if (gone := lost | (time >= until - SLACK)).any():
            ended[lanes[lost]], tipped[lanes[over]] = time[lost], True
            on = ~gone
            lanes, time, h, until = lanes[on], time[on], h[on], until[on]
            failed = failed[on]
            robots, state = robots.take(on), state.take(on)
    return _track(rows), ended, tipped


def _eventful(before: State, after: State, calm: Array) -> Array:
    """Whether a foot touches, lets go, or changes its load by much, (B,), bool."""
    change = np.abs(after.force - before.force).max(axis=(1, 2, 3))
    switched = (after.force[..., 2] > 0) != (before.force[..., 2] > 0)
    return switched.any(axis=(1, 2)) | (change > calm)


def _row(lanes: Array, time: Array, done: Done, which: Array) -> tuple[Array, ...]:
    """What a track has of the lanes that were accepted, in its order."""
    state, load = done.state, np.maximum(done.state.force[..., 2], 0.0)
    whole = load.sum(axis=2)
    share = load / np.maximum(whole, 1e-12)[..., None]
    even = np.where(whole[..., None] > 0, share, 1 / load.shape[2])
    point = (even[..., None] * done.arm[..., :2]).sum(axis=2)
    body = state.place, state.turned, done.slip, whole, done.torque, done.center
    return tuple(part[which] for part in (lanes, time, *body, point))


def _track(rows: list[tuple[Array, ...]]) -> Track:
    """The rows of all sweeps, sorted by their lanes."""
    parts = [np.concatenate(column) for column in zip(*rows, strict=True)]
    order = np.argsort(parts[0], kind="stable")
    return Track(*(part[order] for part in parts))
