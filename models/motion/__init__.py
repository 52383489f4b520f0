"""Equations of motion, eqs. (16)-(18); twists by contact kinematics or measured."""
