"""The world that a run simulates: a robot on its floor with servos and sensors.

`model` builds it. `floor`, `servos`, `sensors`, `walls` and `assets` each add what the
robot's file lacks; `imperfections` adds what plans know nothing of.
"""
