"""Numbers as values of options, refused in one line where they are out of range."""

from __future__ import annotations

import math
from argparse import ArgumentTypeError
from collections.abc import Callable


def whole(least: int) -> Callable[[str], int]:
    """A reader of whole numbers.

    Args:
        least: Smallest that is taken.
    """

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            value = least - 1
        if value < least:
            raise ArgumentTypeError(
                f"{text} cannot be; give a whole number, {least} or more"
            )
        return value

    return read


def real(what: str, example: float, zero: bool = True) -> Callable[[str], float]:
    """A reader of finite numbers that are not negative.

    Args:
        what: What such a number is.
        example: One that is taken.
        zero: Whether 0 is taken, too.
    """

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not (0 < value < math.inf or (zero and value == 0)):
            raise ArgumentTypeError(
                f"{text} is not {what}; give a number such as {example:g}"
            )
        return value

    return read
