"""Loads what commands need, once, in the process from which tests fork them."""

from importlib import import_module

import sim
from models import equations, load
from sim.commands.parsing import COMMANDS, MODULES

for name in dir(sim):
    getattr(sim, name)
for name in COMMANDS:
    import_module(f"sim.commands.{MODULES.get(name, name)}")
for name in ("sim.reports.page", "matplotlib.backends.backend_svg"):
    import_module(name)
equations(load("hexapod"))
