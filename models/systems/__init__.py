"""Systems without a body, stratified and smooth, each with a problem to solve.

They are data for `planner`: fields, a gait, elements to steer with, a start and a goal.
Robots with bodies are described in `description.robot`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
