"""Checks that a model and its card describe a robot that can walk."""
