"""Sec. 4, eqs. (13) and (14): what a gait can reach, and which fields commute."""
