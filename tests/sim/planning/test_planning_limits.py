"""When legs are on counts, when plans tip over, and what is above zero."""

from types import SimpleNamespace

import numpy as np
import pytest

from sim.errors import SimulationError, StratawalkError, UsageError
from sim.motion import prediction
from sim.planning import soundness
from sim.planning.open_loop import _count
from sim.scenarios.body_path import ellipse
from sim.scenarios.declaration import Text, setting


def counted(gain, angle, limit=1.0):
    """The count, of 0.1 rad, to which a group of legs of two gains is brought."""
    setup = SimpleNamespace(
        robot=SimpleNamespace(
            swing_gain=np.array([1.0, gain]),
            group_of_leg=np.zeros(2, dtype=int),
            groups=("1",),
        ),
        servo=SimpleNamespace(resolution=0.1),
        equations=SimpleNamespace(limits={"phi_1": (-limit, limit)}),
    )
    return _count(setup, 0, angle) / 0.1


@pytest.mark.parametrize(
    ("gain", "apart"),
    [(1.0, 1), (0.5, 2), (1 / 3, 3), (0.25, 4), (0.2, 1), (0.2519, 4),
     (1 / 3 + 0.006, 3), (1 / 3 + 0.007, 1)],
)  # fmt: skip
def test_groups_stop_where_all_legs_are_on_counts_if_these_are_four_apart_at_most(
    gain, apart
):
    """A leg is on a count that is off it by a fiftieth."""
    reached = {round(counted(gain, angle)) for angle in np.linspace(0.0, 1.0, 81)}
    assert reached == set(range(0, 11, apart))


@pytest.mark.parametrize(("beyond", "reached"), [(0.9e-9, 5), (1.1e-9, 4)])
def test_counts_at_the_ends_of_the_range_are_reached_but_for_rounding(beyond, reached):
    assert round(counted(1.0, 0.6, limit=0.5 - beyond)) == reached


@pytest.mark.parametrize(("margin", "tips"), [(-0.9e-6, False), (-1.1e-6, True)])
def test_a_plan_tips_a_robot_over_that_lacks_a_micrometre(margin, tips, monkeypatch):
    monkeypatch.setattr(
        prediction, "stability_margin", lambda *_: np.array([1.0, margin])
    )
    monkeypatch.setattr(
        soundness, "_refusal", lambda what, *_: SimulationError(what, "", "")
    )
    phase = SimpleNamespace(stratum="12", planted=lambda robot: [True])
    schedule = SimpleNamespace(
        phases=[phase],
        angles=lambda rows: (0, 0),
        phase_of=lambda rows: np.zeros(2, int),
    )
    stance = SimpleNamespace(feet=None, center_of_mass=None)
    setup = SimpleNamespace(
        kinematics=SimpleNamespace(robot=None, stance=lambda *_: stance)
    )
    if tips:
        with pytest.raises(StratawalkError, match="tips the robot over: .* S12"):
            soundness._refuse_tipping(setup, schedule, np.arange(2))
    else:
        soundness._refuse_tipping(setup, schedule, np.arange(2))


def test_lengths_above_zero_are_a_billionth_at_least():
    assert ellipse([1e-9, 1.0]).length > 0
    with pytest.raises(UsageError, match="above 0"):
        ellipse([0.9e-9, 1.0])


def test_settings_are_wanted_and_texts_are_words_unless_that_is_said():
    assert not setting("it", 1.0, "plan").metadata["imperfection"]
    assert Text() == Text(empty=False, file_name=False)
