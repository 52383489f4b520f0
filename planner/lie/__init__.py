"""Sec. 2: Hall basis, coordinates and words of inputs, eqs. (3), (6)-(9), (20)."""
