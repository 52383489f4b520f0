"""Sec. 5.2: from a path to a plan, and its rollout, eq. (12); replanning, shooting."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
