"""Commands that need optional packages."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import wraps

from sim.errors import ExitCode, UsageError

Execute = Callable[[argparse.Namespace], ExitCode | None]


def needs_extra(extra: str) -> Callable[[Execute], Execute]:
    """Have a command say what to install where a package of an extra is missing.

    Args:
        extra: Name of the extra, one of those in pyproject.toml.
    """

    def decorate(execute: Execute) -> Execute:
        @wraps(execute)
        def told(options: argparse.Namespace) -> ExitCode | None:
            try:
                return execute(options)
            except ModuleNotFoundError as error:
                if error.name in ("planner", "models", "sim"):
                    raise
                raise UsageError(
                    f"package {error.name!r} is not installed",
                    f"the extra {extra!r}",
                    f"pip install 'stratawalk[{extra}]'",
                ) from error

        return told

    return decorate
