"""Sec. 5.2: from a path to a plan, played, planned again, saved."""
