"""Dimensions of the shipped robots, and the MJCF files written from them."""
