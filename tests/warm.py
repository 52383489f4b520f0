"""Does what commands begin with, once, in the process from which tests fork them.

Sympy remembers what it has compiled, and libraries load parts of theirs at first use.
"""

from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO

import sim
from models.description import inspection
from sim import run_folder
from sim.cli import main
from sim.commands.declared import COMMANDS
from tests import trials

inspection.subprocess = trials.FORKED
run_folder._report = lambda *_: None
trials.begin()
for name in dir(sim):
    getattr(sim, name)
for declared in COMMANDS.values():
    import_module(f"sim.commands.{declared['module']}")
for name in ("sim.reports.page", "matplotlib.backends.backend_svg"):
    import_module(name)
with redirect_stdout(StringIO()):
    main(["plan", "line", "--segments", "4"])
