"""Comparison of a walk with its predictions: errors, sources, contacts, clearance."""
