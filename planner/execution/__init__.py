"""Sec. 5.2: how plans are carried out: regrouping, centring, leg repositioning."""
