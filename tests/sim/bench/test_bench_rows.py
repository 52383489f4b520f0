"""How measured times become the rows of the bench, with a clock that the test sets."""

import subprocess
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from sim.bench import speed, sweep_speed
from sim.bench.sweep_speed import COSTLY, TINY
from sim.physics.recording import Recorder
from sim.preparation.setup import prepare
from sim.scenarios.file import load_scenario, scenario_from
from sim.sweeps.ledger import digest
from sim.sweeps.table import read_table

FRICTIONS = (0.5, 0.8)
LEDGER = 10_000  # points
TASKS = 24  # for every number of workers
VARIED = 40  # points, more than are shared of a kind
STRETCH = 4000  # steps of one record at most: a tenth of a second of work as a rule


@pytest.fixture
def clock(monkeypatch):
    """Do work, and say that it took the seconds that stand first in a list."""
    times = []

    def seconds(work):
        work()
        return times.pop(0)

    monkeypatch.setattr(speed, "seconds", seconds)
    monkeypatch.setattr(sweep_speed, "seconds", seconds)
    return times


def test_time_is_that_between_begin_and_end(monkeypatch):
    readings = iter([5.0, 7.5])
    monkeypatch.setattr(speed.time, "perf_counter", lambda: next(readings))
    assert speed.seconds(lambda: None) == 2.5


def test_median_is_of_as_many_repeats_as_are_wanted(clock):
    clock += [3.0, 1.0, 9.0]
    assert speed.median(lambda: None, repeats=3) == 3.0
    assert clock == []


def test_pairs_give_the_others_time_over_ours_and_ours(clock, monkeypatch):
    monkeypatch.setattr(speed, "REPEATS", 3)
    clock += [6.0, 2.0, 4.0, 4.0, 50.0, 10.0]  # other, ours, other, ...
    assert speed.paired(lambda: None, lambda: None) == (3.0, 4.0)


def test_times_of_plans_are_told_of_one_segment_and_of_growth(monkeypatch):
    """Each segment is as long, so that a longer plan leads farther."""
    planned = []

    def plan(extended, path, segments, execution):
        planned.append((segments, np.subtract(path(1.0), path(0.0))[:3]))

    def median(work, repeats=5):
        work()
        return {60: 0.003, 1000: 0.02, 10_000: 0.6}[planned[-1][0]]

    monkeypatch.setattr(speed, "plan", plan)
    monkeypatch.setattr(speed, "median", median)
    short, longest, growth = speed.plans(prepare(load_scenario("line")))
    for segments, way in planned:
        assert way == pytest.approx([0.004 * segments, 0.004 * segments, 0.0])
    assert (short.value, short.unit) == (pytest.approx(3.0), "ms")
    assert (longest.value, longest.unit) == (pytest.approx(60.0), "us")
    assert growth.value == pytest.approx(3.0)  # 60 us against 20 us


def test_a_system_has_microseconds_a_segment_and_rollouts_over_plans(
    clock, monkeypatch
):
    """The first plan is timed twice after a warm-up, and follows the path as it is."""
    counts = []
    real = speed.plan
    monkeypatch.setattr(
        speed, "plan", lambda *a, **k: counts.append(a[2]) or real(*a, **k)
    )
    monkeypatch.setattr(speed, "REPEATS", 1)
    clock += [0.001, 0.003, 0.5, 0.25]
    each, ratio = speed.segments("unicycle", most=20)
    assert counts[:3] == [20, 20, 20]
    assert set(counts[3:]) == {60}
    assert each.value == pytest.approx(1e6 * 0.002 / 20)
    assert ratio.value == 2.0


@pytest.mark.physics
def test_the_simulate_stage_plays_the_commands_of_the_bare_loop(clock, monkeypatch):
    """The ratio is above one where the stage is faster."""
    steps = 2 * STRETCH + 10
    monkeypatch.setattr(speed, "STEPS", steps)
    monkeypatch.setattr(speed, "REPEATS", 1)
    real, played = Recorder.play, []

    def play(recorder, blocks, *inspected):
        played.append(np.concatenate(list(blocks)))
        assert recorder.walk_starts == 0
        return real(recorder, iter([played[-1]]), *inspected)

    monkeypatch.setattr(Recorder, "play", play)
    setup = prepare(load_scenario("line"))
    clock += [4.0, 2.0]
    ratio, rate = speed.simulation(setup)
    assert ratio.value == 2.0
    assert rate.value == pytest.approx(len(played[0]) / 2.0)
    assert len(played[0]) >= steps


class Pool:
    """A pool that keeps what it is told to do."""

    def __init__(self):
        self.carried = []
        self.stood = []
        self.client = SimpleNamespace(map=self._map, gather=lambda times: times)

    def carry_out(self, tasks):
        """Give tasks back as if they were done."""
        self.carried.append(tasks)
        return iter(tasks)

    def _map(self, work, times, pure):
        assert work is sweep_speed.stand
        assert not pure  # or equal calls would be made once
        self.stood.append(times)
        return [2.0 + 3.0 * n for n in range(len(times))]


def test_two_workers_are_measured_against_one_warm_and_on_points_of_their_own(
    clock, monkeypatch
):
    pools = {}

    @contextmanager
    def open_pool(count, scheduler):
        assert scheduler is None
        yield pools.setdefault(count, Pool())

    monkeypatch.setattr(sweep_speed, "open_pool", open_pool)
    clock += [30.0, 12.0]
    ours, bare, rate = sweep_speed.workers(load_scenario("line", TINY))
    assert ours.value == 2.5
    assert bare.value == pytest.approx(2.0 / 5.0)  # the slower of two
    assert rate.value == TASKS / 12.0
    assert sorted(pools) == [1, 2]
    for count, pool in pools.items():
        warm, timed = pool.carried
        assert (len(warm), len(timed)) == (2 * count, TASKS)
        assert len({task.digest for task in [*warm, *timed]}) == 2 * count + TASKS
        assert pool.stood == [[TASKS // count] * count]
        for task in warm:  # as workers find it, or they would refuse it
            point = scenario_from(task.table, {}, "the sweep")
            assert task.digest == digest(point, task.without)


@pytest.mark.physics
def test_a_standing_robot_is_stepped_for_as_many_stretches_as_a_task_walks(monkeypatch):
    rolled = []

    class Engine:
        def __init__(self, model, nsim, nthread):
            assert (nsim, nthread) == (1, 1)

        def reset(self, keyframe):
            assert keyframe >= 0

        def rollout(self, steps):
            rolled.append(steps)

    monkeypatch.setattr(sweep_speed.batch, "Batch", Engine)
    assert sweep_speed.stand(3) >= 0
    assert rolled == [STRETCH] * 3


@pytest.mark.physics
def test_a_bare_batch_steps_the_commands_of_the_points_in_turn(clock, monkeypatch):
    """All rows of commands are played, those of a stretch at once."""
    rolled, begun = [], []
    scenario = load_scenario("line", TINY | {"timestep": 0.002})
    points = [replace(scenario, friction=friction) for friction in FRICTIONS]
    walked = [sweep_speed.simulate(p, without=COSTLY) for p in points]

    class Engine:
        def __init__(self, model, nsim, nthread):
            assert (nsim, nthread) == (1, 1)
            begun.append(model)

        def reset(self, keyframe):
            assert keyframe >= 0
            rolled.append([])

        def rollout(self, steps, control):
            assert control.shape[:2] == (1, steps)
            rolled[-1].append(steps)

    monkeypatch.setattr(sweep_speed, "simulate", lambda *_, **__: next(walks))
    monkeypatch.setattr(sweep_speed.batch, "Batch", Engine)
    monkeypatch.setattr(speed, "REPEATS", 2)
    clock += [1.0, 2.0, 1.0, 2.0]
    walks = iter([*walked, *walked])
    ratio, rate = sweep_speed.throughput(scenario)
    assert begun == [one.walk.setup.model for one in walked]
    assert ratio.value == 0.5
    for steps in rolled:
        assert steps[:-1] == [STRETCH] * (len(steps) - 1)
        assert 0 < steps[-1] <= STRETCH
        assert f" {sum(steps)} steps " in rate.what
    assert rate.value == 0.5


@pytest.mark.physics
def test_books_are_kept_of_points_that_all_differ(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_speed, "LEDGER", 5)
    sweep_speed.keep_books(str(tmp_path))
    columns, _ = read_table(tmp_path / "table.parquet")
    assert len(set(columns["friction"])) == 5
    assert min(columns["friction"]) == 0.5
    assert max(columns["friction"]) < 0.51
    assert list(columns["status"]) == ["ok"] * 5


def test_a_worker_is_weighed_over_worlds_and_plans_that_all_differ(monkeypatch):
    tables = []

    class Task:
        def __init__(self, digest, table, without):
            self.table = table

        def carry_out(self):
            tables.append(self.table)

    monkeypatch.setattr(sweep_speed, "Task", Task)
    sweep_speed.work("nowhere")
    assert len(tables) == VARIED
    assert len({table["friction"] for table in tables}) == VARIED
    assert len({tuple(table["path"]["goal"]) for table in tables}) == VARIED
    assert all(0.5 <= table["friction"] < 1.0 for table in tables)
    assert all(0.004 <= table["path"]["goal"][1] < 0.005 for table in tables)


def test_memory_is_asked_of_a_process_of_its_own_for_the_ledger_and_a_worker(
    monkeypatch,
):
    asked = []

    def check_output(words):
        asked.append(words[-1])
        return b"12.5\n"

    monkeypatch.setattr(subprocess, "check_output", check_output)
    for name in ("throughput", "workers"):
        monkeypatch.setattr(sweep_speed, name, lambda scenario: iter(()))
    ledger, worker = sweep_speed.measure()
    assert (ledger.value, ledger.unit) == (12.5, "MB")
    assert str(LEDGER) in ledger.what
    assert str(VARIED) in worker.what
    assert "import keep_books;" in asked[0]
    assert "import work;" in asked[1]
    assert all("ru_maxrss / 1024" in program for program in asked)  # KiB on Linux
    assert not Path("nowhere").exists()
