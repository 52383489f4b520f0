"""Drafts of cards for robots that have none: legs, groups, posture and servos."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
