"""Guesses, limits and costs of programs whose fields turn coordinates at any rate."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from planner.optimisation.constraints import _stroke
from planner.optimisation.program import Program, Unknowns

RATES = {"a": {3: 2.0}, "b": {4: -0.5}, "": {}}


@dataclass(frozen=True, eq=False)
class Staged:
    """A stage with its stroke, or none, and what recovers meanwhile."""

    stroke: str
    recoveries: tuple


def stages(names):
    """Each stroke turns one coordinate; the other is recovered in the air."""
    recovers = {"a": (4, -0.25), "b": (3, 4.0)}
    return [
        Staged(
            stroke=name,
            recoveries=tuple(
                SimpleNamespace(coordinate=i, rate=rate, field=f"air {name}")
                for i, rate in ([recovers[name]] if name else [])
            ),
        )
        for name in names
    ]


def unknowns(names, **task):
    own = stages(names)
    task = {"most_recoveries": 1, "rates": lambda s: RATES[s.stroke]} | task
    return SimpleNamespace(
        count=len(own), stages=own, longest=np.full(len(own), 9.0), size=0.5,
        task=SimpleNamespace(stages=own, centred=False, **task),
    )  # fmt: skip


def test_recoveries_of_a_guess_centre_every_later_stroke_on_zero():
    """Whatever the rates: strokes of 2 and -0.5, recoveries of 4 and -0.25."""
    guess, strokes = unknowns("abab"), np.array([0.3, -0.8, 0.2, 0.6])
    start = np.array([0.0, 0.0, 0.0, 0.1, -0.2])
    clipped, amounts = Unknowns.centred(guess, strokes, start)
    assert (clipped == strokes).all()
    now = start.copy()
    for k, (stage, stroke) in enumerate(zip(guess.stages, strokes, strict=True)):
        (recovery,) = stage.recoveries
        now[recovery.coordinate] += recovery.rate * amounts[k, 0]
        ((turned, rate),) = RATES[stage.stroke].items()
        if k:  # the first stroke begins where the motion does
            assert now[turned] == pytest.approx(-stroke * rate / 2)
        now[turned] += stroke * rate
        if k == 2:  # nothing strokes there any more
            now_at_rest = now[3]
    assert now_at_rest == pytest.approx(0.2)
    assert now[3] == pytest.approx(start[3])


def test_a_stroke_is_as_long_as_its_coordinate_s_range_at_its_rate():
    """Of 1 rad, from -0.4 to 0.6, at 2 rad a unit; without a stroke there is none."""
    limits = {3: (-0.4, 0.6)}
    found = unknowns(["a", "b", ""], limits=limits)
    longest = Unknowns.longest.func(found)
    assert longest[[0, 2]] == pytest.approx([0.5, 0.0])
    assert longest[0] < longest[1] < np.inf  # of a coordinate without a range
    found.task.centred = True
    assert Unknowns.longest.func(found)[0] == pytest.approx(0.4)


def test_stages_without_strokes_or_recoveries_cost_nothing():
    ca = pytest.importorskip("casadi")
    own = [*stages(["a", "b"]), Staged("", ())]
    price = {"a": 2.0, "b": 3.0, "air a": 0.5, "air b": 0.25}
    task = SimpleNamespace(cost=price.__getitem__, most_recoveries=1)
    own = SimpleNamespace(task=task, unknowns=SimpleNamespace(stages=own))
    strokes, amounts = ca.DM([[1.0, 1.0, 100.0]]), ca.DM([[1.0, 1.0, 100.0]])
    assert float(Program._cost(own, strokes, amounts)) == pytest.approx(5.75)


def test_a_stroke_that_is_repositioned_before_turns_evenly_about_zero():
    """By 2 rad a unit, for 0.3 units: from -0.3 to 0.3 rad, wherever it stood."""
    ca = pytest.importorskip("casadi")
    x, angle = state = sp.symbols("x angle")
    system = SimpleNamespace(state=state, fields={"f": sp.Matrix([angle, 2])})
    task = SimpleNamespace(system=system, moved=[0], rates=lambda _: {1: 2.0})
    task.unmoved = [1]
    along = _stroke(task, SimpleNamespace(stroke="f"), np.array([0.0, 9.0]))
    rates = [float(along(ca.DM([5.0]), 0.3, share)) for share in (0.0, 0.5, 1.0)]
    assert rates == pytest.approx([-0.3, 0.0, 0.3])
