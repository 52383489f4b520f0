"""Estimates of what a robot did not come with: servos, floor and load, from logs."""
