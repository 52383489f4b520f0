"""The array type of this project, and the bound of rounding errors."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
"""Numbers, truth values or indices. Docstrings give the shape and the unit.

Example:
    >>> import numpy as np
    >>> from planner import Array
    >>> x: Array = np.zeros(3)
"""

ROUNDING = 1e-12
"""A value is zero if it is below this part of the terms that it is a sum of."""
