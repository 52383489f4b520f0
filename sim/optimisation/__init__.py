"""Walks as short as they can be: the planner's optimiser for robots and their time."""
