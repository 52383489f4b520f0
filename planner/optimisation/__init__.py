"""The shortest plans along a path, found by multiple shooting over strokes in turn."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
