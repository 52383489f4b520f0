"""Obstacles: their shapes, the robot's outline, the room between, the way around."""
