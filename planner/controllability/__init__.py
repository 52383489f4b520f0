"""Sec. 4 and eq. (13): what a gait can reach, and which fields may act together."""
