"""Errors of robots and systems; each names the value, the place and the remedy."""

from collections.abc import Callable

from planner.support import sentences

message = sentences("models", "refusals.toml")


def refusals(package: str, name: str) -> Callable[..., "ModelError"]:
    """Says why a file is refused, by the key of a sentence of a file and its source."""
    say = sentences(package, name)
    return lambda key, source, /, **facts: ModelError(say(key, source=source, **facts))


class ModelError(Exception):
    """A robot file that exists but cannot be used; exit code 3 on the command line.

    Example:
        >>> from models import load
        >>> load("hexapod", geometry={"wings": 2.0})
        Traceback (most recent call last):
        models.errors.ModelError: hexapod: geometry.wings is unknown; ...
    """


class UnknownRobotError(ValueError):
    """A robot name that is not shipped, or a file that is not there.

    Example:
        >>> from models import load
        >>> load("spider")
        Traceback (most recent call last):
        models.errors.UnknownRobotError: unknown robot: 'spider'; ...
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
        >>> from models import shipped_system
        >>> shipped_system("spider")
        Traceback (most recent call last):
        models.errors.ProblemError: system 'spider' is unknown; ...
    """
