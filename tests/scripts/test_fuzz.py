"""What the fuzz begins with is in order, so that what it changes is what is tried."""

import random

import pytest

from scripts import fuzz_foreign, fuzz_inputs
from scripts.fuzz import KINDS
from sim.cli import main


@pytest.fixture
def begun(monkeypatch, tmp_path):
    """Carries out a case in which nothing is changed."""
    for module in (fuzz_inputs, fuzz_foreign):
        monkeypatch.setattr(module, "mutated", lambda text, _: text)
    monkeypatch.chdir(tmp_path)

    def carry_out(kind, draw):
        words = KINDS[kind](tmp_path, random.Random(draw))
        return words[0], main(words)

    return carry_out


@pytest.mark.parametrize("kind", ["card", "mjcf", "system", "archive", "answers"])
def test_what_is_changed_is_in_order_before(begun, kind):
    assert begun(kind, 0)[1] == 0


@pytest.mark.parametrize(("draw", "command"), [(9, "fit"), (1, "play")])
def test_logs_are_played_and_fitted_before_they_are_changed(begun, draw, command):
    assert begun("log", draw) == (command, 0)


def test_a_sweep_is_read_as_far_as_its_folder(begun, capsys):
    assert begun("sweep", 0) == ("sweep", 2)
    assert "already exists: .; choose another folder" in capsys.readouterr().err


def test_a_run_that_is_changed_is_sealed_again(begun, monkeypatch):
    """Or no change would come farther than to the seals."""
    lines = iter(["flows.csv", ["cite"]])
    monkeypatch.setattr(random.Random, "choice", lambda self, choices: next(lines))
    monkeypatch.setattr(fuzz_foreign, "mutated", lambda text, _: text + "\n")
    assert begun("run", 1) == ("cite", 0)
    assert random.Random(1).random() < 0.8
