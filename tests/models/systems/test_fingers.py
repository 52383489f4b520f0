"""Finger gaiting: a disc turned once around by contacts that come and go."""

import numpy as np
import pytest

from models.systems.catalogue import shipped_system
from planner.errors import RangeError
from planner.execution.execution import Execution
from planner.extension.extended import extend
from planner.planning.algorithm import plan
from planner.planning.rollouts import play, rollout
from tests.systems import with_lifts

EXACT = 1e-9  # what a nilpotent plan promises; rounding is far below


def test_disc_turns_once_around_within_the_fingers_range():
    problem = shipped_system("finger-gaiting")
    planned = plan(
        problem.system,
        problem.path,
        problem.segments,
        problem.elements,
        execution=Execution(stance=problem.stance, limits=problem.limits),
    )
    states = rollout(planned)
    assert states[-1, 0] == pytest.approx(2 * np.pi, abs=EXACT)
    assert np.abs(states[:, 1:4]).max() <= 0.5 + EXACT


def test_fingers_part_from_the_disc_and_return():
    problem = shipped_system("finger-gaiting")
    compiled = extend(problem.system, problem.elements)
    planned = plan(
        compiled,
        problem.path,
        8,
        execution=Execution(stance="centred", limits=problem.limits),
    )
    lifts = {step: f"lift_{step}" for step in problem.system.strata if step != "123"}
    lifted = with_lifts(planned.flows, 0.01, lifts)
    states = play(problem.system, lifted, planned.start)
    assert states[-1] == pytest.approx(problem.states[1], abs=EXACT)
    off = states[:, 4:] > 0.005
    assert off.any(axis=0).all()  # every finger lets go
    assert off.sum(axis=1).max() == 1  # and never two at a time


def test_fingers_in_contact_turn_with_the_disc():
    system = shipped_system("finger-gaiting", {"fingers": 5, "reach": 0.25}).system
    names = [str(symbol) for symbol in system.state]
    for stratum, fields in system.strata.items():
        for field in fields.values():
            rates = dict(zip(names, field, strict=True))
            for finger in stratum:
                assert rates["disc"] == 0.25 * rates[f"phi_{finger}"]


def test_segments_are_as_many_as_the_fingers_range_asks_for():
    problem = shipped_system("finger-gaiting", {"span": 0.3})
    execution = Execution(stance="centred", limits=problem.limits)
    assert 10 < 2 * np.pi / 0.6 < 11  # strokes of 0.6 rad in a turn of the disc
    plan(problem.system, problem.path, 11, problem.elements, execution=execution)
    with pytest.raises(RangeError, match="plan at least 11 segments"):
        plan(problem.system, problem.path, 10, problem.elements, execution=execution)


@pytest.mark.parametrize("fingers", [2, 9])
def test_two_to_nine_fingers_are_a_hand(fingers):
    system = shipped_system("finger-gaiting", {"fingers": fingers}).system
    assert len(system.state) == 1 + 2 * fingers
