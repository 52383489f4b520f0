"""Which rows are fitted, and what is too small to be found."""

from copy import copy
from dataclasses import replace
from datetime import date
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from models import load
from sim.cli import main
from sim.commands.fit import _check_logs
from sim.errors import UsageError
from sim.fitting.estimate import Estimates, Parameter, _in_words
from sim.fitting.fitting import JointFit, _rows, check_steps, fit_joints, servos
from sim.fitting.poses import BODY, PoseFit
from sim.fitting.servo_law import known_servos, on_floor, on_stand
from sim.logs.log import Log
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario
from tests.sim.fitting.test_servos import NOISE, classroom_log, moves


def test_three_quarters_of_a_log_are_fitted_and_the_rest_checks():
    time = np.arange(20.0)
    log = SimpleNamespace(time=time, measured=time[:, None])
    for kept, rows in ((False, [*range(1, 15)]), (True, [*range(15, 20)])):
        assert _rows(log, kept)[0].tolist() == rows
        assert _rows(log, kept)[1][:, 0].tolist() == rows


@pytest.mark.parametrize(("step", "first"), [(0.01, 5), (0.1, 5), (1.0, 1)])
def test_a_log_is_fitted_from_its_first_half_second_or_tenth_on(step, first):
    """It may begin in motion."""
    time = step * np.arange(51.0)
    log = SimpleNamespace(time=time, measured=time[:, None])
    assert _rows(log, kept=False)[0][0] == pytest.approx(first * step)
    log.time = np.append(time[:50], 600.0)  # nearly all of whose rows are in a tenth
    assert _rows(log, kept=False)[0][0] == pytest.approx(min(first, 5) * step)


def test_more_angles_than_memory_is_lent_for_are_refused(monkeypatch):
    monkeypatch.setattr("sim.fitting.fitting.MOST_ANGLES", 79)
    log = SimpleNamespace(time=np.arange(20.0), measured=np.ones((20, 2)), commanded=0)
    log.joints, log.pose, log.duration = ("hip", "knee"), None, 0.1
    _check_logs(["a"], [log], held=False)
    with pytest.raises(UsageError, match="too long to fit: a; give 51% of it"):
        _check_logs(["a", "b"], [log, log], held=False)
    log.duration = 0.2  # however few its rows are
    with pytest.raises(UsageError, match="too long to fit"):
        _check_logs(["a"], [log], held=False)


@pytest.mark.parametrize(("timestep", "many"), [(0.001, False), (0.0009, True)])
def test_ten_minutes_of_walking_are_fitted_at_a_thousand_steps_a_second(timestep, many):
    logs = [SimpleNamespace(duration=seconds) for seconds in (600.0, 1.0)]
    if not many:
        check_steps(Path("a"), logs, timestep)
        return
    with pytest.raises(UsageError, match=r"6.67e\+05 steps of physics, 650000 are the"):
        check_steps(Path("a"), logs, timestep)


def estimates(parameters, value, error):
    """Of one problem, with a spread that nothing is left of."""
    information = np.diag(1 / np.array(error, dtype=float) ** 2)[None]
    value = np.array([value], dtype=float)
    return Estimates(tuple(parameters), 0 * value, value, information, np.ones(1))


@pytest.mark.parametrize(("value", "none"), [(1.99, True), (2.01, False)])
@pytest.mark.parametrize("low", [0.0, -np.inf])
def test_backlash_of_less_than_two_standard_errors_is_none(value, none, low):
    one = Parameter(name="a", unit="", spread=1e6, step=1.0, low=low, setting="slack")
    make, own = estimates([one], [value], [1.0]), estimates([one], [0.0], [1e9])
    fit = JointFit(("hip",), make, make, own, np.zeros(1), np.zeros(1))
    found, error = fit.settings(["hip"], {})["slack"]
    assert error == pytest.approx(1.0)
    assert found == pytest.approx(0.0 if none and low == 0 else value)


@pytest.mark.parametrize("errors", [{"bands": [0.01, 0.02]}, 5, {"bands": [0.01]}])
def test_joints_that_a_log_has_not_keep_what_an_earlier_fit_has_found(errors):
    one = Parameter(name="a", unit="", spread=1.0, step=1.0, low=0.0, setting="bands")
    own = estimates([one], [0.3], [0.03])
    fit = JointFit(("hip",), own, own, own, np.zeros(1), np.zeros(1))
    found = fit.settings(["hip", "knee"], {"bands": [0.1, 0.2], "errors": errors})
    value, error = found["bands"]
    assert value == pytest.approx([0.3, 0.2])
    whole = isinstance(errors, dict) and len(errors["bands"]) == 2
    # what is expected beforehand, within 1, makes the first a little smaller
    assert error == pytest.approx([0.03, 0.02 if whole else 0.0], rel=1e-3)


def test_joints_of_which_nothing_was_seen_keep_what_an_earlier_fit_has_found():
    """Though they were commanded: a bench has encoders for a few."""
    one = Parameter(name="a", unit="", spread=1.0, step=1.0, low=0.0, setting="bands")
    seen, unseen = (estimates([one], [0.3], [error]) for error in (0.03, 1e9))
    names = "start", "value", "information", "noise"
    parts = [np.concatenate([getattr(e, n) for e in (seen, unseen)]) for n in names]
    own = Estimates((one,), *parts)
    fit = JointFit(("hip", "knee"), own, seen, own, np.zeros(2), np.zeros(2))
    earlier = {"bands": [0.1, 0.2], "errors": {"bands": [0.01, 0.02]}}
    value, error = fit.settings(["hip", "knee"], earlier)["bands"]
    assert value == pytest.approx([0.3, 0.2])
    assert error == pytest.approx([0.03, 0.02], rel=1e-3)


@pytest.mark.parametrize("odd", [date(1979, 5, 27), "x", np.nan, True])
def test_earlier_errors_that_are_no_numbers_are_refused(odd):
    one = Parameter(name="a", unit="", spread=1.0, step=1.0, low=0.0, setting="bands")
    own = estimates([one], [0.3], [0.03])
    fit = JointFit(("hip",), own, own, own, np.zeros(1), np.zeros(1))
    with pytest.raises(UsageError, match="bands = .* is not allowed: .fitted. of the"):
        fit.settings(["hip"], {"errors": {"bands": [odd]}})


def test_slack_that_no_scenario_takes_is_none():
    """Below a billionth of a radian, however small its error is."""
    one = Parameter(name="a", unit="", spread=1.0, step=1.0, low=0.0, setting="slack")
    other = replace(one, setting="bands")
    make, own = (estimates([p], [4e-12], [1e-13]) for p in (one, other))
    fit = JointFit(("hip",), make, make, own, np.zeros(1), np.zeros(1))
    found = fit.settings(["hip"], {})
    assert (found["slack"][0], found["bands"][0]) == (0.0, [0.0])


@pytest.mark.parametrize(("mass", "place"), [(0.04, 0.5), (0.03, 2 / 3), (0.01, 2 / 3)])
def test_a_payload_weighs_thirty_grams_at_least(mass, place):
    """Of which it is known where it is, since its moment shows."""
    value = [1.0, mass, 0.02, 0.0, 0.0, 0.0, 0.0]
    found = estimates(BODY, value, np.full(7, 1e-6))
    payload, _ = PoseFit(found, 0.0, 0.0).settings["payload"]
    assert payload[:2] == pytest.approx([max(mass, 0.03), place])


def test_parameters_may_have_any_value_and_are_no_logarithms_unless_it_is_said():
    plain = Parameter(name="a", unit="m", spread=1.0, step=0.1)
    assert plain.low == -np.inf
    assert not plain.logarithm


@pytest.mark.parametrize(
    ("part", "said"), [(0.24, "a does not show"), (0.26, "more a with more b would")]
)
def test_parameters_take_part_in_a_direction_from_a_quarter_on(part, said):
    direction = np.array([np.sqrt(1 - part**2), part])
    assert _in_words(["a", "b"], direction).startswith(said)


@pytest.mark.parametrize(("begin", "count"), [(0, 0), (20, 12)])
def test_a_joint_that_a_log_hardly_measured_is_refused(begin, count, tmp_path, capsys):
    """Of 200 rows, whose first 20 are not fitted."""
    classroom_log(tmp_path / "log.csv")
    head, *rows = (tmp_path / "log.csv").read_text().splitlines()
    gone = [row.rpartition(",")[0] + "," for row in rows]
    gone[begin : begin + 12] = rows[begin : begin + 12]
    (tmp_path / "log.csv").write_text("\n".join([head, *gone]))
    assert main(["fit", "hexapod-classroom", str(tmp_path / "log.csv")]) == 2
    assert f"error: {count} measured angles of joint " in capsys.readouterr().err


def test_a_log_that_begins_in_motion_tells_as_much_as_others():
    """How far joints were behind their commands then is not in it."""
    robot, rng = load("hexapod-classroom"), np.random.default_rng(4)
    setup = prepare(load_scenario("line", {"robot": robot.name}), robot)
    joints = robot.card.joints[:4]
    rest = [robot.standing_angle(joint) for joint in joints]
    log = Log(np.arange(600) / 100, joints, moves(4, rng, step=0.01) + rest)
    truth = servos(np.full(4, 9.0), np.full(4, 0.5))
    truth[:, [2, 4, 5]] = 0.01, 0.02, 0.02
    seen = on_stand(setup, log).answers(truth[None], log.time)[0]
    seen += rng.normal(0, NOISE, seen.shape)
    rows = slice(115, None)  # in the middle of a move
    time = log.time[rows] - log.time[rows][0]
    cut = Log(time, joints, log.commanded[rows], measured=seen[rows])
    each = fit_joints(setup, [cut], walking=False).each
    assert (np.abs(each.value - truth) < 3.5 * each.error).all()
    assert each.error[:, 2].max() < 1e-3  # 3e-4 seen, and 8e-3 with the beginning


@pytest.mark.physics
@pytest.mark.parametrize("step", [0.0015, 0.01])
def test_loads_are_as_far_apart_as_the_steps_of_physics_allow(step):
    """The law's own step need not be a number of them, nor longer than one."""
    setup = prepare(load_scenario("line", {"robot": "hexapod-classroom"}))
    joints = setup.robot.card.joints
    log = Log(np.linspace(0, 1, 51), joints, np.zeros((51, len(joints))))
    (model := copy(setup.as_planned.model)).opt.timestep = step
    found = on_floor(setup, model, log, servos(*known_servos(setup, log)))
    far = (len(found.angle) - 1) * found.step
    assert far == pytest.approx(log.duration, abs=found.step)
