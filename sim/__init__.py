"""Physics, measurement, pictures and the command line.

Public names are imported from here, `from sim import simulate`, and loaded when they
are first used; `__init__.pyi` lists them. Data takes this way through the rooms:

============  ========================================================================
Room          What happens there
============  ========================================================================
scenarios     What to walk: settings, nominal path, obstacles
motion        Flows become joint commands; their motion and stability are predicted
world         The robot on its floor, with servos and sensors, as one MuJoCo model
physics       The engine steps, sensors become contact and slip, rows are kept
preparation   Everything is decided before the first step
experiments   Fields are measured, and how far a standing robot creeps
obstacles     The robot's outline and its distance from walls
planning      Plans are made, aimed, bounded, led around obstacles
walking       The plan is carried out
evaluation    What was achieved beside what was predicted
pictures      Films
figures       The paper's figures again, beside physics
bench         Speed and memory, measured side by side
commands      The command line, one module a command
============  ========================================================================

`simulation` runs the whole way and writes nothing, `run_folder` keeps what it gives.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
