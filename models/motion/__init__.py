"""Equations of motion, eqs. (16)-(19), and predictions of body twists."""
