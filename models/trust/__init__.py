"""Whether a user's model may be read: how large it is, what it opens, its numbers."""
