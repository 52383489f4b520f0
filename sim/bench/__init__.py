"""Measurements of speed and memory, and other planners on the same tasks."""
