"""The array type of this project, its real numbers, and the bound of rounding."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
"""Numbers, truth values or indices. Docstrings give the shape and the unit.

Example:
    >>> import numpy as np
    >>> from planner import Array
    >>> x: Array = np.zeros(3)
"""

ROUNDING = 1e-12  # of the terms of a sum; less of it is zero


def reals(values: ArrayLike, what: str) -> Array:
    """A copy as floats; `ValueError` for dates, texts and complex numbers."""
    array = np.asarray(values)
    none = array.dtype == object and None in array.ravel().tolist()
    if none or array.dtype.kind not in "biufO":  # NumPy would make floats of them, too
        raise ValueError(f"{what} are of type {array.dtype}; give real numbers")
    return np.array(array, dtype=float)
