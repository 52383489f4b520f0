"""Short walks before they are walked: their schedules and their commands."""

import numpy as np

from sim.compliant.prediction import Leg, course_of, phases_of
from sim.drive.drive import Drive
from sim.motion.schedule import Scheduler
from sim.preparation.scheduling import schedule_flows
from sim.preparation.setup import prepare
from sim.problems.scenario import ScenarioProblem
from sim.scenarios.file import load_scenario

SHORT = {"segments": 2, "path.goal": [0.01, 0.01, 0.0], "feed_forward": False}


def course(name="line", **changes):
    """Setup, phases and course of a scenario's plan, open loop, with its first hold."""
    setup = prepare(load_scenario(name, SHORT | changes))
    plan = ScenarioProblem.ready(setup).solve().plan
    scheduler = Scheduler(setup.limits, setup.at_rest)
    scheduler.hold(setup.limits.hold)
    schedule_flows(setup, scheduler, list(plan.segments()))
    leg = Leg(scheduler.finish(), np.zeros(3))
    phases = phases_of(setup)
    rows = Drive(setup).commands(leg.schedule, None)
    return setup, phases, course_of(setup, phases, [leg], rows), leg
