"""Robots and systems: bodies in MJCF with a card each, and the equations of motion.

Public names are imported from here, `from models import load`, and loaded when they are
first used; `__init__.pyi` lists them. The rooms behind this door, in the order in which
a file becomes something to plan for:

================  ====================================================================
Room              What it answers
================  ====================================================================
description       What the MJCF file and its card say
contact           Where the feet are, which loads they bear, how they slide
adoption          A card drafted for a robot that has none
checks            Whether file and card make a robot that can walk
motion            Its equations of motion, eqs. (16)-(19), and its body twists
systems           Systems without a body: the paper's, wheels, fingers, chained forms
morphology        The shipped robots in numbers, and the MJCF written from them
robots            The shipped robots as files
================  ====================================================================
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
