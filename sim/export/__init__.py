"""Walks as files that servos understand, read back and played in the physics."""
