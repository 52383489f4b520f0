"""How often a scenario is walked, what is kept of it, and what a film adds."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import pytest

from sim import run_folder, simulation
from sim.errors import SimulationError, UsageError
from sim.folder import RunFolder
from sim.pictures import run_film


@pytest.fixture
def walks(monkeypatch):
    """Walk scenarios without physics; gives how many, and what was witnessed."""

    def walk(correct, *, motion=None, fails=0):
        scenario = SimpleNamespace(
            correct=correct, plan_time=9.0, path=SimpleNamespace(goal=(0.1, 0.0, 0.0))
        )
        done, seen = [], []
        setup = SimpleNamespace(motion=motion, walk_cache=lambda shared: None)
        problem = SimpleNamespace(scenario=scenario, beside=lambda offset: problem)

        def carry_out(walker, plan):
            done.append(walker)
            if len(done) == fails:
                raise SimulationError("it fell", "t = 1 s", "walk slower")
            return SimpleNamespace(seconds={"plan": 1.0, "simulate": 2.0})

        ready = SimpleNamespace(ready=lambda *_: problem)
        made = SimpleNamespace(setup=setup, plan=None)
        walker = SimpleNamespace(setup=setup, pose=[0.07, 0.04, 0.0])
        for name, stub in (
            ("prepare", lambda *_: setup), ("ScenarioProblem", ready),
            ("_prepared", lambda *_: made), ("Walker", lambda *_: walker),
            ("carry_out", carry_out), ("evaluate", lambda *_: "evaluated"),
            ("_further", lambda *_: (0.0, 0.0, 0.0)),
        ):  # fmt: skip
            monkeypatch.setattr(simulation, name, stub)
        witness = SimpleNamespace(
            prepared=lambda _: seen.append("prepared"),
            walked=lambda _: seen.append(len(done)),
        )
        try:
            found = simulation.simulate(scenario, witness=witness)
        except SimulationError:
            return len(done), seen, None
        return len(done), seen, found

    return walk


@pytest.mark.parametrize("correct", [1, 3])
def test_a_scenario_is_walked_as_often_as_it_is_corrected_and_the_last_is_kept(
    walks, correct
):
    count, seen, found = walks(correct)
    assert count == correct
    assert seen == ["prepared", correct]
    assert found.missed == pytest.approx([0.05] * correct)
    assert found.timing["simulate"] == pytest.approx(2.0 * correct)


def test_a_walk_that_fails_is_kept_though_others_were_to_follow(walks):
    assert walks(3, fails=2)[:2] == (2, ["prepared", 2])


def test_a_motion_is_played_once(walks):
    count, seen, found = walks(3, motion="given")
    assert (count, seen, found.missed) == (1, ["prepared", 1], ())


@dataclass(frozen=True)
class Told:
    """A summary that tells its timing, and of which settings it is, alone."""

    timing: dict = field(default_factory=dict)
    settings: str = ""

    def to_json(self):
        """As plain values."""
        return {"timing": self.timing, "settings": self.settings}


def test_the_time_of_a_film_is_told_besides_that_of_the_walk(monkeypatch, tmp_path):
    clock, kept = iter([100.0, 107.5]), []
    done = SimpleNamespace(summary=Told(), timing={"plan": 1.0}, evaluation=None)

    def finished(evaluation, summary):
        return SimpleNamespace(summary=replace(summary, settings="of the file"))

    writer = SimpleNamespace(finished=finished)
    monkeypatch.setattr(run_folder, "simulate", lambda *_, **__: done)
    monkeypatch.setattr(run_folder, "Writer", lambda _: writer)
    monkeypatch.setattr(run_film, "film_folder", lambda *_, **__: None)
    timer = SimpleNamespace(perf_counter=lambda: next(clock))
    monkeypatch.setattr(run_folder, "time", timer)
    folder = SimpleNamespace(
        path=tmp_path, write_json=lambda name, value: kept.append((name, value))
    )
    timing = {"plan": 1.0, "render": 7.5}
    assert run_folder.run(None, folder, look="paper").timing == timing
    assert kept == [("summary.json", {"timing": timing, "settings": "of the file"})]
    assert run_folder.run(None, folder).timing == timing | {"render": 0.0}


def test_a_walk_that_is_refused_before_it_begins_leaves_no_folder(
    monkeypatch, tmp_path
):
    folder = RunFolder(tmp_path / "walk")
    folder.path.mkdir()

    def simulate(*_, **__):
        (folder.path / "scenario.toml").touch()
        raise error

    monkeypatch.setattr(run_folder, "simulate", simulate)
    error = SimulationError("it fell", "t = 1 s", "walk slower")
    with pytest.raises(SimulationError, match="walk slower; walk again"):
        run_folder.run(None, folder)
    assert folder.path.is_dir()
    error = UsageError("too slow", "servos", "turn them faster")
    with pytest.raises(UsageError):  # what lies there may be anybody's
        run_folder.run(None, folder)
    assert folder.path.is_dir()
    (folder.path / "scenario.toml").unlink()
    with pytest.raises(UsageError):
        run_folder.run(None, folder)
    assert not folder.path.exists()
