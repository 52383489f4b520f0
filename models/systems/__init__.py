"""Systems that need no body: stratified and smooth ones, each with a problem to solve.

They are data for `planner`: fields, a gait, elements to steer with, a start and a goal.
Robots with bodies are in `description.robot`.
"""
