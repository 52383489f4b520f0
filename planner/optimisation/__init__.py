"""Plans as short as they can be: strokes in turn, by multiple shooting."""
