"""What is refused about a robot or a system: the value, the place, the way out."""


class ModelError(Exception):
    """A robot file that exists but cannot be used; exit code 3 on the command line."""


class UnknownRobotError(ValueError):
    """A robot name that is not shipped, or a file that is not there."""


class UnknownSystemError(ValueError):
    """A system name that is not shipped, or a file that is not there."""


class SystemFileError(ValueError):
    """A file that exists but describes no system; exit code 2 on the command line."""
