"""Sec. 5.2: how plans are carried out: words, centring, leg repositioning."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
