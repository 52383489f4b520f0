"""The shortest walks: the planner's optimiser applied to robots and their time."""
