"""Errors of robots and systems; each names the value, the place and the remedy."""


class ModelError(Exception):
    """A robot file that exists but cannot be used; exit code 3 on the command line."""


class UnknownRobotError(ValueError):
    """A robot name that is not shipped, or a file that is not there."""


class MeasurementError(Exception):
    """A field that no experiment could measure; exit code 4 on the command line."""


class ProblemError(ValueError):
    """A system that is not shipped, or is described wrongly; exit code 2."""
