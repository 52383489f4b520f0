"""The shipped robots as numbers, and the MJCF written from them."""
