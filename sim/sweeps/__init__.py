"""Sweeps: one scenario walked with many settings, and its numbers in one table."""
