"""Sec. 5.1: the stratified extended system, eqs. (4), (5) and (13)-(15)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
