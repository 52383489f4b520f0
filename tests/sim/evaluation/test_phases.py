"""What is told of each phase of a walk: its slip, and whether contacts were planned."""

from dataclasses import replace

import numpy as np
import pytest

from sim.evaluation.assessment import evaluate
from sim.evaluation.phases import as_planned, phase_slip
from sim.physics.measure import ContactLog
from sim.planning.open_loop import plan_open_loop
from sim.preparation.setup import prepare
from sim.scenarios.body_path import line
from sim.scenarios.scenario import Scenario
from sim.walking.walks import Walker, carry_out

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def walk():
    """Half a centimetre ahead."""
    path = line((0.005, 0.0, 0.0))
    setup = prepare(Scenario(name="step", segments=1, path=path))
    return carry_out(Walker(setup), plan_open_loop(setup))


def first(walk, kind):
    return next(phase for phase in walk.phases if phase.kind == kind)


def with_feet(walk, phase, wrong, step):
    """The walk, its feet as planned in a phase but for some in a single state."""
    planned = walk.setup.robot.planted(phase.stratum)
    flags = np.array([planned, planned ^ wrong, planned])
    contacts = ContactLog(np.array([0, step, step + 1]), flags)
    return replace(walk, recording=replace(walk.recording, contacts=contacts))


def test_the_slip_of_all_phases_is_that_of_the_walk_from_its_first_step_on(walk):
    parts = np.array([phase_slip(walk, phase) for phase in walk.phases])
    assert walk.phases[0].start == 0
    assert parts[0].max() > 0
    # speeds at contacts are not negative; sums differ by rounding
    assert parts.min() >= 0
    assert parts.sum(axis=0) == pytest.approx(
        walk.recording.moments.slip[-1], abs=1e-15
    )


def test_slip_in_swings_is_that_of_phases_that_swing(walk):
    parts = [phase_slip(walk, p).sum() for p in walk.phases if p.kind == "swing"]
    found = evaluate(walk, ("identified", "compliant", "creep_floor")).summary
    assert 0 < found.achieved.slip_swing == pytest.approx(sum(parts), abs=1e-15)


@pytest.mark.parametrize("foot", [0, 1], ids=["that stands", "in the air"])
def test_contacts_are_asked_after_each_step_of_a_phase_and_of_no_other(walk, foot):
    phase, wrong = first(walk, "swing"), np.arange(6) == foot
    found = [
        as_planned(with_feet(walk, phase, wrong, step), phase)
        for step in (phase.start, phase.start + 1, phase.stop, phase.stop + 1)
    ]
    assert found == [True, False, False, True]


@pytest.mark.parametrize("kind", ["lift", "land"])
def test_only_feet_that_are_lifted_or_landed_are_not_asked(walk, kind):
    phase = first(walk, kind)
    moving = np.isin(walk.setup.robot.group_of_leg, phase.moving)
    assert as_planned(with_feet(walk, phase, moving, phase.stop), phase)
    for foot in np.flatnonzero(~moving):
        wrong = np.arange(len(moving)) == foot
        assert not as_planned(with_feet(walk, phase, wrong, phase.stop), phase)
