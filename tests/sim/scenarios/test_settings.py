"""Declared settings: defaults that are allowed, and names that they had before."""

from dataclasses import MISSING
from typing import get_args

import pytest

from sim.errors import UsageError
from sim.scenarios.declaration import Effect
from sim.scenarios.file import announce, load_scenario
from sim.scenarios.settings import FORMER, SETTINGS


@pytest.mark.parametrize(("old", "new"), FORMER.items())
def test_a_former_name_of_a_setting_works_and_says_the_present_one(old, new, capsys):
    announce.cache_clear()
    value = {bool: True, float: 0.01}[type(SETTINGS[new].default)]
    scenarios = [load_scenario("line", {old: value}) for _ in range(2)]
    assert getattr(scenarios[0], new) == value
    assert scenarios[0] == load_scenario("line", {new: value})
    said = capsys.readouterr().err
    assert said == f"stratawalk: notice: {old} is now called {new}\n"


def test_a_setting_under_both_of_its_names_is_refused():
    with pytest.raises(UsageError, match="play and backlash are one setting: .*keep"):
        load_scenario("line", {"play": 0.01, "backlash": 0.02})


@pytest.mark.parametrize("name", SETTINGS)
def test_a_default_is_a_value_that_the_setting_may_have(name):
    declared = SETTINGS[name]
    if declared.default is not MISSING:
        assert declared.accept(declared.default, "here") == declared.default
    assert declared.affects <= set(get_args(Effect))
