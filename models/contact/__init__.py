"""Feet on the floor: where they touch, what they bear, how they slide."""
