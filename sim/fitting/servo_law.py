"""What a joint on its servo answers to commands, step by step and lane by lane.

The law is that of the simulated servos: a spring from the command to the joint with a
dead band, a motor that brakes the joint all the while, and behind it gears with
backlash, in which the leg rests on the side to which its load pushes:

    I a + d v = k (e - clip(e, -w/2, w/2)) - load,   e = command + zero - angle

Between steps it is solved exactly, within the band and outside it. The delay shifts
what is answered.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from planner import Array
from sim.world.imperfections import RUBBED

NOTHING = 1e-300  # beside angles [rad]


@dataclass(frozen=True, eq=False)
class Commanded:
    """What joints are told, in equal steps of time, and what they bear meanwhile."""

    step: float  # [s]
    angle: Array  # (T, P) [rad]
    load: Array  # torque of gravity and floor against the joint's angle, (T, P) [N m]
    inertia: Array  # about every joint, rotor and leg, (P,) [kg m^2]
    leg: Array  # of that, what the backlash lets loose, (P,) [kg m^2]

    def answers(self, servos: Array, rows: Array) -> Array:
        """Angles (V, N, P) at times (N,) [s] of variants of servos, (V, P, 6).

        A servo is log stiffness, log damping, dead band, backlash, zero and delay.
        """
        k, d = np.exp(servos[..., 0]).ravel(), np.exp(servos[..., 1]).ravel()
        w, b = servos[..., 2].ravel() / 2, servos[..., 3].ravel() / 2
        lanes = len(servos)
        inertia = np.tile(self.inertia, lanes)
        told = np.tile(self.angle, (1, lanes)) + servos[..., 4].ravel()
        told[1:] = (told[1:] + told[:-1]) / 2  # of a step, its middle
        load = np.tile(self.load, (1, lanes))
        zero, one = np.zeros_like(k), np.ones_like(k)
        held = expm(self.step * _rows((zero, one), (-k / inertia, -d / inertia)))
        free = expm(self.step * _rows((zero, one), (zero, -d / inertia)))
        (_, held_v), (held_p, held_t) = np.moveaxis(held, 0, -1)
        held_q, free_v, free_s = held[:, 0, 0], free[:, 0, 1], free[:, 1, 1]
        falls, slows = (self.step - free_v) / d, (1 - free_s) / d  # under a unit's load
        bent, angle = load / k, np.empty_like(told)
        q, v = told[0] - bent[0] - np.sign(load[0]) * w, zero
        s, u = -np.sign(load[0]) * b, zero  # of the leg, from the motor
        kept = np.exp(-self.step * RUBBED / np.tile(self.leg, lanes))
        fallen = load * (1 - kept) / RUBBED
        for t in range(len(told)):
            e = told[t] - q
            rest = e - np.minimum(np.maximum(e, -w), w) - bent[t]
            held_turn = rest - held_q * rest + held_v * v
            held_speed = held_t * v - held_p * rest
            free_turn = free_v * v - falls * load[t]
            free_speed = free_s * v - slows * load[t]
            before = np.abs(e) - w
            after = np.abs(e - np.where(before > 0, held_turn, free_turn)) - w
            out = np.maximum(before, 0) + np.maximum(after, 0)  # of the band, of a step
            out /= np.abs(before) + np.abs(after) + NOTHING
            q = q + free_turn + out * (held_turn - free_turn)
            u, v = u + v, free_speed + out * (held_speed - free_speed)
            u = kept * (u - v) - fallen[t]
            loose = s + self.step * u
            s = np.minimum(np.maximum(loose, -b), b)
            u = np.where(s == loose, u, 0.0)
            angle[t] = q + s
        return self._at(angle, rows, servos)

    def _at(self, angle: Array, rows: Array, servos: Array) -> Array:
        """Evenly between steps, as late as the servos are."""
        lanes, joints = servos.shape[:2]
        late = rows[None, :, None] - servos[:, None, :, 5]
        place = np.clip(late / self.step, 0.0, len(angle) - 1.001)
        before = place.astype(int)
        lane = np.arange(lanes * joints).reshape(lanes, 1, joints)
        part = place - before
        found: Array = (1 - part) * angle[before, lane] + part * angle[before + 1, lane]
        return found


def _rows(*rows: tuple[Array, Array]) -> Array:
    """Matrices (L, 2, 2) of rows of numbers a lane."""
    return np.moveaxis(np.array(rows), -1, 0)
