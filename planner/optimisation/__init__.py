"""The shortest plans along a path, found by multiple shooting over strokes in turn."""
