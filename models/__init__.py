"""Robots: a body in MJCF, a card that names its parts, and the equations of both."""
