"""Errors of robots and systems; each names the value, the place and the remedy."""


class ModelError(Exception):
    """A robot file that exists but cannot be used; exit code 3 on the command line.

    Example:
        >>> from models import ModelError, load
        >>> try:
        ...     load("hexapod", geometry={"wings": 2.0})
        ... except ModelError as error:
        ...     print(str(error)[:35])
        hexapod: geometry.wings is unknown;
    """


class UnknownRobotError(ValueError):
    """A robot name that is not shipped, or a file that is not there.

    Example:
        >>> from models import UnknownRobotError, load
        >>> try:
        ...     load("spider")
        ... except UnknownRobotError as error:
        ...     print(str(error)[:24])
        unknown robot: 'spider';
    """


class MeasurementError(Exception):
    """A field that no experiment could measure; exit code 4 on the command line.

    Example:
        >>> from models import MeasurementError
        >>> issubclass(MeasurementError, Exception)
        True
    """


class ProblemError(ValueError):
    """A system that is not shipped, or is described wrongly; exit code 2.

    Example:
        >>> from models import ProblemError, shipped_system
        >>> try:
        ...     shipped_system("spider")
        ... except ProblemError as error:
        ...     print(str(error)[:27])
        system 'spider' is unknown;
    """
