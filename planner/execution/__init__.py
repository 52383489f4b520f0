"""Sec. 5.2: flows of a plan ordered by stratum, within the range of the legs."""
