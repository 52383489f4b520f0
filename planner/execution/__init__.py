"""Sec. 5.2: how plans are carried out: words, centring, leg repositioning."""
