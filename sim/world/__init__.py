"""The world that a run simulates: a robot on its floor, commanded and measured.

`model` is the way in. `floor`, `servos`, `sensors`, `start` and `assets` each add what
a robot's file lacks; `channels` says which actuator turns which leg.
"""
