"""What is refused about a robot, each with the value, the place and the way out."""


class ModelError(Exception):
    """A robot file that exists but cannot be used; exit code 3 on the command line."""


class UnknownRobotError(ValueError):
    """A robot name that is not shipped, or a file that is not there."""
