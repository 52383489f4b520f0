"""Physics, measurement, pictures and the command line.

Public names are imported from here, `from sim import simulate`, and loaded when they
are first used; `__init__.pyi` lists them. Data takes this way through the rooms:

============  ========================================================================
Room          What happens there
============  ========================================================================
scenarios     What to walk: settings, nominal path, obstacles
logs          Joint motion from elsewhere is read, checked and aligned
motion        Flows become joint commands; their motion and stability are predicted
drive         Intended angles become servo commands: zeros, counts, rate and delay
world         The robot on its floor, with servos and sensors, as one MuJoCo model
physics       The engine steps; contact and slip are measured and recorded
preparation   Everything that can be decided before the first step is decided
experiments   Fields are measured, and so is the creep of a standing robot
compliant     The motion of a robot on soft servos and a soft floor is predicted
obstacles     The robot's outline and its distance from obstacles
feedback      Where the robot is, as sensors tell, and what its segments miss
problems      What to plan, for a scenario or a system, and how it is solved
optimisation  The shortest walks are searched for, and bounded from below
planning      Plans are made, aimed, kept within bounds, led around obstacles
walking       Plans are carried out
evaluation    Achieved and predicted motion are compared
runs          A finished run, in memory or read from its folder
pictures      Films
viewing       Finished walks are looked at from all sides, in a browser
reports       Pages about one run or several
templates     How pages, the texts of commands and firmware are worded
export        Walks become files for servos, which are read back and played
fitting       Servos, floor and load are estimated from logs
figures       The paper's figures again, beside physics
bench         Speed and memory, measured side by side
sweeps        One scenario is walked with many settings, into one table
studies       What the table of a sweep says, in maps
commands      The command line, one module a command
============  ========================================================================

`simulation` does all of this and writes nothing; `run_folder` writes its results.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
