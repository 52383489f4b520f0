"""Walks in the physics, open loop or planned again from every pose reached."""
