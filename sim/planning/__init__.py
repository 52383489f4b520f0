"""Plans for a walk, aimed where predictions say, within bounds and around obstacles."""
