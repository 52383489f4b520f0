"""A pause of Python's garbage collector while many lasting objects are made.

The collector goes through all objects again and again as their number grows. That takes
a third of the time of a plan of thousands of segments, and finds nothing.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uncollected() -> Iterator[None]:
    """Look for no cyclic garbage meanwhile."""
    if not gc.isenabled():
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
