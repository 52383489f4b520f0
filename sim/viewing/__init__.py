"""Finished walks to look at from all sides: in a browser now, or in a file later."""
