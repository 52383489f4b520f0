"""Equations of motion, eqs. (16)-(19), and predictions of body twists."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
