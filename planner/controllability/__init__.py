"""Sec. 4: which directions the strata of a gait reach together."""
