"""Sec. 2: Hall basis, coordinates and words of inputs, eqs. (3), (6)-(9), (20)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
