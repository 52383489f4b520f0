"""The shipped robots, an MJCF file and a card each."""
