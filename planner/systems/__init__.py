"""Secs. 2 and 3: fields, flows, strata and gaits, eqs. (1), (2), (10), (11)."""
