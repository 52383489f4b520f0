"""Secs. 2 and 3: fields, strata and flows, eqs. (1), (2), (10)-(12), and Def. 1."""
