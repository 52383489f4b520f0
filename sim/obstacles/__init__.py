"""The outline of the robot, and its clearance from obstacles."""
