"""Sec. 4: which directions the strata of a gait reach together."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
