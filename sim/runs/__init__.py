"""A finished run: in memory after a simulation, or read from its folder."""
