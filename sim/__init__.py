"""Physics, measurement, pictures and the command line.

A run, in order:

====================================  ================================================
What to walk                          scenario, scenario_file, settings, nominal
Everything decided beforehand         setup, world, obstacles, effort
Flows, aimed where they should end    planning, steering, bounds, forecast, twist_models
Flows to joint commands               schedule
Physics, and what is kept of it       walk, physics, recording, identify
Contact, slip, margin                 measure, support, creep
Prediction beside what was achieved   prediction, phases, evaluate, attribution
For people                            comparison, film, figures, bench, commands
Files                                 folder, resolve, run
====================================  ================================================
"""
