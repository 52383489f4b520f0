"""How far plans miss before they are corrected, divided or called of no use."""

from types import SimpleNamespace

import numpy as np
import pytest

from planner.errors import PlannerError
from planner.planning import chained_forms
from planner.planning.chained_forms import ChainedForm
from planner.planning.critical_steps import _Steps, critical_step
from planner.planning.nominal import require_use
from planner.planning.plane import Plane
from planner.systems.flows import Flow
from planner.systems.strata import StratifiedSystem

PLAIN = StratifiedSystem("x y", {"0": {"f": [1, 0], "g": [0, 1]}}, "0")


def corrected(misses, monkeypatch):
    """How many plans a chained form makes that miss their goals by so much in turn."""
    made = []

    def straight(*_):
        made.append(misses[len(made)])
        plan = SimpleNamespace(nominal=[0], missed=made[-1])
        plan.segments = lambda: [()]
        return plan

    form = SimpleNamespace(_straight=straight, system=None)
    form._separated = lambda *_: PlannerError("apart")
    monkeypatch.setattr(chained_forms, "_apart", lambda plan, goal: plan.missed)
    monkeypatch.setattr(chained_forms, "_plan_of", lambda *_: None)
    try:
        ChainedForm._corrected(form, 0, 1, 1)
    except PlannerError:
        return -len(made)
    return len(made)


@pytest.mark.parametrize(
    ("misses", "plans"),
    [
        ([0.9e-11], 1),  # rounding
        ([1.1e-11, 0.0], 2),
        ([0.9e-2, 0.0], 2),
        ([1.1e-2], -1),  # no rounding of an integration
        ([0.9e-9, 1e-9], 2),  # near enough, though it cannot be corrected
        ([1.1e-9, 2e-9], -2),
        ([1e-3, 1e-5, 1e-7, 1e-8], -4),  # three corrections at most
        ([1e-3, 1e-5, 1e-7, 1e-10], 4),
    ],
)
def test_what_integration_misses_is_corrected_up_to_three_times(
    misses, plans, monkeypatch
):
    assert corrected(misses, monkeypatch) == plans


def test_words_that_swing_too_far_are_planned_in_4_and_16_times_as_many_segments():
    tried = []

    def refused(start, goal, segments):
        tried.append(segments)
        raise PlannerError("too far")

    form = SimpleNamespace(_corrected=refused)
    for given in ((), (3,)):
        with pytest.raises(PlannerError, match="too far"):
            ChainedForm._planned(form, 0, 1, *given)
    assert tried == [1, 4, 16, 3, 12, 48]


@pytest.mark.parametrize(("direction", "serves"), [(0.99, True), (-1.01, False)])
def test_a_chart_serves_within_a_radian_of_its_direction(direction, serves):
    plane = SimpleNamespace(way_in=lambda x: ([], x), direction=lambda x: direction)
    assert ChainedForm._holds(SimpleNamespace(plane=plane), None) == serves


def test_a_vehicle_that_is_steered_turns_its_fastest_heading_by_a_quarter_radian():
    plane = SimpleNamespace(
        system=SimpleNamespace(dimension=3),
        steered=2,
        headings=(0, 1),
        _driving=lambda x: np.array([2.0 * x[2], -x[2], 9.0]),
    )
    assert Plane._step.func(plane) == pytest.approx(0.25 / (2.0 * 1.1))


@pytest.mark.parametrize(("missed", "least"), [(0.89, 1e-9), (0.91, 1.1e-6)])
def test_a_plan_is_of_use_that_comes_a_tenth_nearer_or_is_not_nearly_singular(
    missed, least
):
    require_use(*nearly_singular(least), [Flow("0", "f", 1.0 - missed)])
    with pytest.raises(PlannerError):
        require_use(*nearly_singular(0.9e-6), [Flow("0", "f", 0.09)])


def nearly_singular(least):
    """Elements of which one is so much smaller, and a way along the other."""
    columns = SimpleNamespace(
        values=lambda x: np.tile(np.diag([1.0, least]), (2, 1, 1))
    )
    steering = SimpleNamespace(element_units=lambda x: None)
    extended = SimpleNamespace(system=PLAIN, columns=columns, steering=steering)
    return extended, np.array([[0.0, 0.0], [1.0, 0.0]])


def test_steps_span_a_billionth_or_a_hundred_thousand_grains_at_least():
    """A grain is what floating-point numbers leave of a place."""
    assert _Steps(PLAIN, (0.0, 0.0), None).shortest == 1e-9
    far = _Steps(PLAIN, (2.0**20, 0.0), None).shortest
    assert far == pytest.approx(1e5 * 2.0**-32)


def test_no_step_longer_than_a_thousand_is_tried(monkeypatch):
    monkeypatch.setattr(_Steps, "critical", lambda self, ray, longest: longest)
    assert critical_step(PLAIN, (0.0, 0.0), (1.0, 0.0)) == 1e3
    assert critical_step(PLAIN, (0.0, 0.0), (1.0, 0.0), within=2.0) == 2.0
