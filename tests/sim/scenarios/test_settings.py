"""Declared settings: defaults that are allowed, and names that they had before."""

import re
from dataclasses import MISSING
from typing import get_args

import pytest

from scripts.show_outputs import ROOT, SETTINGS_TABLE, settings_table
from sim.cli import main
from sim.errors import UsageError
from sim.scenarios.declaration import Effect, read
from sim.scenarios.file import announce, load_scenario
from sim.scenarios.settings import FORMER, IMPERFECTIONS, SETTINGS


@pytest.mark.parametrize(("old", "new"), FORMER.items())
def test_a_former_name_of_a_setting_works_and_says_the_present_one(old, new, capsys):
    announce.cache_clear()
    value = {bool: True, float: 0.01}[type(SETTINGS[new].default)]
    scenarios = [load_scenario("line", {old: value}) for _ in range(2)]
    assert getattr(scenarios[0], new) == value
    assert scenarios[0] == load_scenario("line", {new: value})
    said = capsys.readouterr().err
    assert said == f"stratawalk: notice: {old} is now called {new}\n"


@pytest.mark.parametrize("mark", "-_")
def test_words_of_settings_may_be_spelt_with_either_mark(mark):
    """One setting has the label of a prediction, the other its key."""
    called = f"quasi{mark}static"
    line = load_scenario("line", {"steer": called, "predictions": [called]})
    assert (line.steer, line.predictions) == ("quasi-static", ("quasi_static",))


def test_refused_values_are_told_the_unit_of_those_allowed():
    with pytest.raises(UsageError, match=r"give a number from .* to .* \[m\]$"):
        load_scenario("line", {"min_margin": "0.01m"})


def test_a_setting_under_both_of_its_names_is_refused():
    with pytest.raises(UsageError, match="play and backlash are one setting: .*keep"):
        load_scenario("line", {"play": 0.01, "backlash": 0.02})


@pytest.mark.parametrize("name", SETTINGS)
def test_what_a_setting_is_about_has_its_unit_if_it_has_one(name):
    declared = SETTINGS[name]
    assert declared.about.startswith(declared.meaning.partition(";")[0])
    assert ("[]" in declared.about, "[None]" in declared.about) == (False, False)
    assert (f"[{declared.unit}]" in declared.about) == bool(declared.unit)


@pytest.mark.parametrize("name", SETTINGS)
def test_a_default_is_a_value_that_the_setting_may_have(name):
    declared = SETTINGS[name]
    if declared.default is not MISSING:
        found = read(declared.default, declared.kind)
        assert (found, type(found)) == (declared.default, type(declared.default))
    assert declared.affects <= set(get_args(Effect))


def test_the_table_of_settings_in_the_documentation_is_the_declaration():
    page = (ROOT / "docs" / "scenarios.md").read_text()
    assert SETTINGS_TABLE.findall(page) == [settings_table()]


@pytest.mark.parametrize("command", ["run", "plan"])
def test_help_of_set_names_every_setting(command, capsys):
    main([command, "--help"])
    assert {*SETTINGS} <= set(re.findall(r"\w+", capsys.readouterr().out))


def test_defaults_are_those_that_people_count_on():
    """Left out, a setting changes nothing: one walk, perfect servos, a level floor."""
    defaults = {name: item.default for name, item in SETTINGS.items()}
    kept = {
        "robot": "hexapod", "fields": "lifted", "segments": 20, "words": "printed",
        "steer": "ideal", "optimise": "none", "correct": 1, "friction": 1.0,
        "timestep": 0.001, "draw": 0, "swing_speed": 0.5, "swing_acceleration": 5.0,
        "hold": 0.5, "plan_time": 300.0, "min_clearance": 0.002, "sample_every": 10,
        "seed": 0,
    }  # fmt: skip
    assert {name: defaults[name] for name in kept} == kept
    assert not any(defaults[name] for name in IMPERFECTIONS)  # None, 0 or False
