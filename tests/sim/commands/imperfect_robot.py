"""An imperfect robot in MuJoCo as a process: commands come in, poses go out.

It holds each command until the next one comes, and tells where it is thirty times a
second, as a camera does. At the end it writes where it truly is on standard error.
"""

import json
import sys
from math import radians

import mujoco
import numpy as np

from models.description import actuator_of
from sim import load_scenario, prepare
from sim.motion.poses import seen_from

CHANGES = {"slope": [0.02, 1.0], "backlash": 0.005, "draw": 4}
FRAMES = 30.0  # a second


def main(noise):
    setup = prepare(load_scenario("line", CHANGES))
    model, random = setup.model, np.random.default_rng(0)
    data, zeros = mujoco.MjData(model), {}
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    start, shown = setup.pose(data.qpos), 0
    for line in sys.stdin:
        told = json.loads(line)
        while data.time < told["time"] - model.opt.timestep / 2:
            mujoco.mj_step(model, data)
            if data.time * FRAMES >= shown:
                shown += 1
                off = random.normal(0, 1, 3) * [noise, noise, 5 * noise]
                x, y, yaw = seen_from(start, setup.pose(data.qpos)) + off
                pose = {"time": data.time, "x": x, "y": y, "yaw": yaw}
                print(json.dumps(pose), flush=True)
        for joint, angle in told["ctrl"].items():
            zero = zeros.setdefault(joint, random.uniform(-1, 1) * radians(0.5))
            data.ctrl[actuator_of(model, joint)] = angle + zero
    print(json.dumps(seen_from(start, setup.pose(data.qpos)).tolist()), file=sys.stderr)


if __name__ == "__main__":
    main(float(sys.argv[1]))
