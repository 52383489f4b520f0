"""Thin commands over the packages; run as `python -m scripts.NAME` from the root."""
