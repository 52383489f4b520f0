"""A card's [fitted] and `imperfect` set what nobody names, be it the default or not."""

import pytest

from models import load
from sim.scenarios.file import as_given, load_scenario, scenario_from
from sim.scenarios.scenario import LEFT, drawn
from sim.scenarios.settings import SETTINGS

FITTED = "\n[fitted]\nfriction = 0.3\nbacklash = 0.01\n"


@pytest.fixture
def fitted(tmp_path):
    robot = load("hexapod")
    (tmp_path / "mine.xml").write_text(robot.read().to_xml())
    (tmp_path / "mine.toml").write_text(robot.card_text + FITTED)
    return load(str(tmp_path / "mine.xml"))


def test_a_fitted_number_yields_to_one_that_is_named_though_it_is_the_default(fitted):
    default = SETTINGS["friction"].default
    found = drawn(load_scenario("line", {"friction": default}), fitted)
    assert (found.friction, found.backlash) == (default, 0.01)
    left = drawn(load_scenario("line"), fitted)
    assert (left.friction, left.backlash) == (0.3, 0.01)


def test_what_is_named_is_not_drawn_though_it_is_the_default():
    asked = {"imperfect": "hobby", "backlash": 0.0}
    found = drawn(load_scenario("line", asked), load("hexapod"))
    assert found.backlash == 0.0
    assert found.zero_offset > 0


@pytest.mark.parametrize("named", [{}, {"friction": 1.0}, {"backlash": 0.0}])
def test_a_table_as_it_was_given_is_read_as_the_same_scenario(named):
    """So that the point of a sweep is walked by a worker as it was asked for."""
    asked = load_scenario("line", named)
    table = as_given(asked)
    assert LEFT & table.keys() == named.keys()
    again = scenario_from(table, {}, "the sweep")
    assert again == asked
    assert LEFT & again.given == named.keys()
