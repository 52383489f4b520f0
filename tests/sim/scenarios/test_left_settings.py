"""A card's [fitted] and `imperfect` set what nobody names, be it the default or not."""

from dataclasses import replace

import pytest

from models import load
from sim.errors import UsageError
from sim.scenarios.file import dumps, load_scenario, scenario_from
from sim.scenarios.scenario import drawn
from sim.scenarios.settings import SETTINGS
from sim.sweeps.file import read_sweep
from sim.sweeps.folder import Shard
from sim.sweeps.ledger import digest
from sim.sweeps.sweeping import points_of

FITTED = "\n[fitted]\nfriction = 0.3\nbacklash = 0.01\n"


@pytest.fixture
def fitted(tmp_path):
    robot = load("hexapod")
    (tmp_path / "mine.xml").write_text(robot.read().to_xml())
    (tmp_path / "mine.toml").write_text(robot.card_text + FITTED)
    return load(str(tmp_path / "mine.xml"))


@pytest.mark.parametrize("servo", ["xl-330", "ideal", "MG90", "own", None])
@pytest.mark.parametrize("made", [{"servo": "MG90"}, {}], ids=["named", "earlier"])
def test_what_was_fitted_of_a_make_of_servo_is_of_no_other_make(servo, made):
    """Zeros, friction and the like are the robot's, whatever servos it has."""
    robot = load("hexapod-classroom")
    fit = {"servo_stiffness": 7.46, "backlash": 0.01, "friction": 0.3}
    robot = replace(robot, card=replace(robot.card, fitted=fit | made))
    found = drawn(load_scenario("line", {"servo": servo} if servo else {}), robot)
    own = servo not in ("xl-330", "ideal")
    assert found.servo_stiffness == (7.46 if own else None)
    assert found.backlash == (0.01 if own else 0.0)
    assert found.friction == 0.3
    bus = replace(robot.card.servo, made="xl-330", data={})
    other = replace(robot, card=replace(robot.card, servo=bus))
    changed = drawn(load_scenario("line"), other)  # what the card says since
    assert changed.servo_stiffness == (None if made else 7.46)


def test_what_was_fitted_of_servos_yields_to_a_data_sheet_that_is_named():
    """A servo without a name, `pulse`, is whatever its numbers say."""
    robot = load("hexapod-classroom")
    fit = {"servo_stiffness": 7.46, "friction": 0.3, "servo": "pulse"}
    servo = replace(
        robot.card.servo, made="pulse", data={"stall_torque": 0.2, "no_load_speed": 9.0}
    )
    robot = replace(robot, card=replace(robot.card, fitted=fit, servo=servo))
    for given, kept in (({}, 7.46), ({"servo_data.stall_torque": 1.0}, None)):
        found = drawn(load_scenario("line", given), robot)
        assert (found.servo_stiffness, found.friction) == (kept, 0.3)


@pytest.mark.parametrize("odd", ["mg91", 3, ["mg90"]])
def test_a_fit_of_a_make_that_there_is_not_is_refused(fitted, odd):
    card = replace(fitted.card, fitted={"servo": odd})
    with pytest.raises(UsageError, match="fitted.servo = .* is unknown"):
        drawn(load_scenario("line"), replace(fitted, card=card))


def test_a_fitted_number_yields_to_one_that_is_named_though_it_is_the_default(fitted):
    default = SETTINGS["friction"].default
    found = drawn(load_scenario("line", {"friction": default}), fitted)
    assert (found.friction, found.backlash) == (default, 0.01)
    left = drawn(load_scenario("line"), fitted)
    assert (left.friction, left.backlash) == (0.3, 0.01)


@pytest.mark.parametrize("order", [1, -1])
def test_what_was_fitted_is_of_the_joints_of_the_card(fitted, order):
    joints = [*fitted.card.joints][::order]
    card = replace(fitted.card, fitted={"friction": 0.3, "joints": joints})
    other = replace(fitted, card=card)
    if order == 1:
        assert drawn(load_scenario("line"), other).friction == 0.3
        return
    with pytest.raises(UsageError, match="or of these in another order: the card of"):
        drawn(load_scenario("line"), other)


def test_what_is_named_is_not_drawn_though_it_is_the_default():
    asked = {"imperfect": "hobby", "backlash": 0.0}
    found = drawn(load_scenario("line", asked), load("hexapod"))
    assert found.backlash == 0.0
    assert found.zero_offset > 0


def test_a_file_that_lists_every_setting_leaves_its_defaults_to_the_card(
    fitted, tmp_path
):
    """As `stratawalk scenarios line` prints it, for an owner to change."""
    (tmp_path / "mine.toml").write_text(dumps(load_scenario("line")))
    found = drawn(load_scenario(str(tmp_path / "mine.toml")), fitted)
    assert (found.friction, found.backlash) == (0.3, 0.01)


@pytest.mark.parametrize("given", ["friction = [0.3, 1.0]", "backlash = [0.0, 0.1]"])
def test_a_point_of_a_sweep_is_walked_as_it_was_asked_for(given, tmp_path):
    """Also by a worker that gets its table, and says what it has walked."""
    file = tmp_path / "mine.toml"
    file.write_text(f'scenario = "line"\n[grid]\n{given}\n')
    sweep = read_sweep(str(file))
    points = points_of(sweep, Shard())
    for point, task in enumerate(points.tasks({})):
        again = replace(
            scenario_from(task.table, {}, "the sweep"), given=frozenset(task.named)
        )
        assert again == sweep.at(point)
        assert again.given == sweep.at(point).given == {given.partition(" ")[0]}
        assert digest(again, ()) == task.digest
    left = load_scenario("line")
    assert digest(left, ()) not in points.digests.values()
