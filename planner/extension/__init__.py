"""Sec. 5.1: the stratified extended system, eqs. (4), (5), (13)-(15) and (19)."""
