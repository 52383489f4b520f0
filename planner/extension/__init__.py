"""Sec. 5.1: the stratified extended system, eqs. (4), (5) and (13)-(15)."""
