"""Loads what commands need, once, in the process from which tests fork them."""

from importlib import import_module

import sim
from models import equations, load
from sim.commands.parsing import COMMANDS

for name in dir(sim):
    getattr(sim, name)
for module in COMMANDS.values():
    import_module(f"sim.commands.{module}")
for name in ("sim.reports.page", "matplotlib.backends.backend_svg"):
    import_module(name)
equations(load("hexapod"))
