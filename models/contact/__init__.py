"""Feet on the floor: where they touch, what they bear, how they slide."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
