"""The world that a run simulates: a robot on its floor with servos and sensors.

`model` builds it. `floor`, `servos` and `sensors` each add what the robot's file lacks;
`imperfections` and `dead_bands` add what plans know nothing of; `others` finds what
else would move or hold the robot, and `changes` says what is done about it.
"""
