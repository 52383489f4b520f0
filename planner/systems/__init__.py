"""Secs. 2 and 3: fields, flows, strata and gaits, eqs. (1), (2), (10), (11)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
