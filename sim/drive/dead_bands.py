"""Allowance for the dead bands of servos: half a band toward the torque.

A tripod on its feet has one free motion, about its pivot, which its swing servos alone
hold. At lift-off and touchdown the sum Q of their torques, each times its gain, pushes
it across the bands, and the yaw of that adds up. Every swing command is therefore
shifted by half its band along the group's motion, to the side to which Q points, every
other one to that of its own torque. Where whole bands come nearer to an odd number of
counts, half a count is added to both, so that both are whole counts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner import Array
from sim.preparation.setup import Setup


@dataclass(frozen=True, eq=False)
class DeadBands:
    """The bands that commands allow for, on the servos of a robot."""

    setup: Setup

    @cached_property
    def half(self) -> Array:
        """Half of each leg joint's band, as it is assumed, shape (J,) [rad]."""
        scenario, joints = self.setup.scenario, self.setup.robot.card.joints
        assumed = scenario.assumed_dead_band
        whole = scenario.dead_band if assumed is None else assumed
        return np.broadcast_to(np.array(whole, dtype=float) / 2, len(joints))

    def shifts(self, torque: Array) -> Array:
        """What to add to commands, for torques of all leg joints, (n, J) each [rad]."""
        robot, joints = self.setup.robot, self.setup.robot.card.joints
        swings = [joints.index(joint) for joint in robot.swing_joints]
        gain, group, side = robot.swing_gain, robot.group_of_leg, np.sign(torque)
        each = torque[:, swings] * gain
        push = [each[:, group == g].sum(axis=1) for g in range(len(robot.groups))]
        side[:, swings] = np.sign(np.stack(push, axis=1))[:, group] * np.sign(gain)
        shifts: Array = self.half * side
        if resolution := self.setup.servo.resolution:
            odd = np.round(2 * self.half[swings] / resolution) % 2
            shifts[:, swings] += odd * resolution / 2 * np.sign(gain)
        return shifts
