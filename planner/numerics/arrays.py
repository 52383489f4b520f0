"""The one array type of this project, and how much of a value is rounding."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

Array = NDArray[Any]
"""Numbers, truth values or indices; docstrings give shape and unit."""

ROUNDING = 1e-12
"""Part of a value's terms below which the value is zero."""
