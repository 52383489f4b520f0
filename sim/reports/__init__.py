"""Pages about finished runs, drawn from their folders: of one, and of several."""
