"""A robot as it is written down: an MJCF file, and a card that names its parts."""
