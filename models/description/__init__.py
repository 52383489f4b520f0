"""The description of a robot: an MJCF file, and a card that names its parts."""
