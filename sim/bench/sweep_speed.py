"""Sweeps: throughput against a bare batch, workers against one another, memory."""

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import cycle
from pathlib import Path

import numpy as np
from mujoco import batch

from sim.bench.speed import Row, paired, seconds
from sim.physics.engine import STRETCH
from sim.preparation.setup import prepare
from sim.preparation.shared import Shared
from sim.scenarios.file import load_scenario, to_table
from sim.scenarios.predictions import COSTLY
from sim.scenarios.scenario import Scenario
from sim.simulation import simulate
from sim.sweeps.file import Sweep
from sim.sweeps.folder import Shard, SweepFolder
from sim.sweeps.ledger import OK, Outcome, digest, opened, software
from sim.sweeps.sweeping import carry_on, points_of
from sim.sweeps.worker_pool import Task, numbers, open_pool

SHORT = {"path.goal": [0.02, 0.02, 0.0], "segments": 4}
TINY = SHORT | {"segments": 1, "path.goal": [0.004, 0.004, 0.0]}
TASKS = 24  # for every number of workers
LEDGER = 10_000  # points
VARIED = 40  # points, more than are shared of a kind


def measure() -> Iterator[Row]:
    """All measurements of sweeps, one after another."""
    yield from throughput(load_scenario("line", SHORT))
    yield from workers(load_scenario("line", TINY))
    yield Row(f"memory of the ledger of {LEDGER} points", _peak("keep_books"), "MB")
    yield Row(f"memory of a worker after {VARIED} points", _peak("work"), "MB", "< 700")


def throughput(scenario: Scenario) -> Iterator[Row]:
    """Points at two frictions in turn against the same commands on the same models."""
    shared = Shared()
    points = [replace(scenario, friction=friction) for friction in (0.5, 0.8)]
    done = [simulate(point, without=COSTLY, shared=shared) for point in points]
    walks = [one.walk for one in done]
    played = [(w.setup.model, np.concatenate(list(w.commands()))) for w in walks]
    ours_next, bare_next = cycle(points), cycle(played)

    def ours() -> None:
        fresh = replace(next(ours_next), name="again")
        _ = simulate(fresh, without=COSTLY, shared=shared).summary

    def bare() -> None:
        model, ctrl = next(bare_next)
        engine = batch.Batch(model, nsim=1, nthread=1)
        engine.reset(keyframe=model.key("start").id)
        for rows in np.split(ctrl, range(STRETCH, len(ctrl), STRETCH)):
            engine.rollout(len(rows), control=rows[None])

    ratio, took = paired(bare, ours)
    what = "speed of a sweep, evaluation included, over a bare batch"
    yield Row(what, ratio, "", ">= 0.85")
    yield Row(f"points of {len(played[0][1])} steps in a second", 1 / took, "1/s")


def workers(scenario: Scenario) -> Iterator[Row]:
    """Two worker processes against one, started and warm; all points differ."""
    one, two = (_times_of(scenario, count) for count in (1, 2))
    ratio = one[0] / two[0]
    yield Row("speed of a sweep, two workers over one", ratio, "", ">= 1.8, if idle")
    yield Row("speed of bare batches, two at once over one", one[1] / two[1], "")
    yield Row("short points in a second, two workers", TASKS / two[0], "1/s")


def _times_of(scenario: Scenario, count: int) -> tuple[float, float]:
    """Time of a sweep by some workers, and of their bare batches instead [s]."""

    def tasks(start: float, number: int) -> list[Task]:
        points = (replace(scenario, friction=start + 0.01 * n) for n in range(number))
        return [Task(digest(p, COSTLY), to_table(p), COSTLY, p.given) for p in points]

    with open_pool(count, None) as pool:
        list(pool.carry_out(tasks(0.5, 2 * count)))
        ours = seconds(lambda: list(pool.carry_out(tasks(0.7, TASKS))))
        bare = pool.client.map(stand, [TASKS // count] * count, pure=False)
        return ours, max(pool.client.gather(bare))


def stand(times: int) -> float:
    """Time [s] of stepping a standing robot in a bare batch for so many stretches."""
    model = prepare(load_scenario("line", TINY)).model
    engine = batch.Batch(model, nsim=1, nthread=1)
    engine.reset(keyframe=model.key("start").id)
    return seconds(lambda: [engine.rollout(STRETCH) for _ in range(times)])


def _peak(work: str) -> float:
    """Most memory that one of the functions below takes in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        run = f"import resource; from sim.bench.sweep_speed import {work}"
        peak = "resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024"
        program = f"{run}; {work}({folder!r}); print({peak})"
        return float(subprocess.check_output([sys.executable, "-c", program]))


def keep_books(folder: str) -> None:
    """Read a ledger of many points, and write their table."""
    scenario = load_scenario("line", TINY)
    given = dict(numbers(simulate(scenario, without=COSTLY).summary))
    blocks = ((("friction",), [(0.5 + 1e-5 * n,) for n in range(LEDGER)]),)
    sweep = Sweep("many", to_table(scenario), {}, blocks, COSTLY)
    points, home, own = points_of(sweep, Shard()), SweepFolder(Path(folder)), software()
    with opened(home.ledger) as ledger:
        ledger.add(Outcome(code, OK, given, own) for code in points.digests.values())
    carry_on(points, home)


def work(folder: str) -> None:
    """Walk points, which leave nothing, in worlds and with plans that all differ."""
    for number in range(VARIED):
        aside = 0.004 + 1e-5 * number
        changes = {"path.goal": [0.004, aside, 0.0], "friction": 0.5 + 0.01 * number}
        table = to_table(load_scenario("line", TINY | changes))
        Task(str(number), table, COSTLY).carry_out()
