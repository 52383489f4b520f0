"""The world that a run simulates: a robot on its floor with servos and sensors.

`model` builds it. `floor`, `servos`, `sensors`, `start` and `assets` each add what the
robot's file lacks; `channels` assigns actuators to legs.
"""
