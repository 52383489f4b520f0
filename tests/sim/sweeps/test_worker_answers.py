"""What a pool makes of workers' answers, of errors, of deaths and of its own end."""

from concurrent.futures import CancelledError
from dataclasses import dataclass
from types import SimpleNamespace

import pytest
from distributed import KilledWorker
from distributed.scheduler import NoWorkerError

from sim.errors import SweepError, UsageError
from sim.sweeps.ledger import Outcome
from sim.sweeps.worker_pool import Task, WorkerPool

TRIES = 2  # of a point whose worker dies

KILLED = KilledWorker("a", None, 3), NoWorkerError("a", 1.0)
WRONG = UsageError("no such name", "the sweep", "give another")
SAID = "no such name: the sweep; give another"


@dataclass(eq=False)
class _Answer:
    """A future of some status, which waits for ever for an error that it lacks."""

    status: str
    error: Exception | None = None

    def exception(self):
        assert self.status == "error", "it waits for ever"
        return self.error

    def cancel(self):
        self.status = "cancelled"


@pytest.mark.parametrize("gone", [*map(_Answer, ("lost", "cancelled")), *(
    _Answer("error", error) for error in KILLED
)])  # fmt: skip
def test_a_worker_that_is_gone_is_asked_anew_by_its_successor(gone):
    pool = WorkerPool(None, asked={"it": gone, "other": None})
    pool._judge("it", gone)
    assert pool.asked == {"other": None}
    assert not pool.refused


def test_a_worker_that_cannot_tell_its_software_is_refused():
    broken = _Answer("error", WRONG)
    pool = WorkerPool(None, asked={"it": broken})
    pool._judge("it", broken)
    assert pool.refused == {"it": SAID}
    assert pool.asked == {"it": broken}


def settled(answer, client="running", deaths=0):
    task = Task("digest", {})
    pool = WorkerPool(SimpleNamespace(status=client), running={answer: (task, "it")})
    pool.deaths[task.digest] = deaths
    told, outcome = pool._settle(answer)
    assert told is task
    assert not pool.running
    return outcome, pool.deaths[task.digest] - deaths


def test_a_point_whose_worker_dies_is_tried_twice_and_one_that_fails_once():
    for error in KILLED:
        assert settled(_Answer("error", error)) == (None, 1)
        assert settled(_Answer("lost")) == settled(_Answer("cancelled")) == (None, 1)
        given_up, died = settled(_Answer("error", error), deaths=TRIES - 1)
        assert given_up.died
        assert died == 1
    for client in ("running", "closed"):
        failed, died = settled(_Answer("error", WRONG), client)
        assert (failed.digest, failed.status, died) == ("digest", SAID, 0)


def test_a_worker_with_other_files_of_the_robot_ends_the_sweep(monkeypatch):
    walked = Outcome("other", "ok")
    monkeypatch.setattr(WorkerPool, "_fetched", lambda *_: walked)
    with pytest.raises(SweepError, match="files are not those that the sweep began"):
        settled(_Answer("finished"))


@pytest.mark.parametrize("status", ["cancelled", "lost"])
def test_what_a_closed_pool_has_dropped_is_no_death(status):
    with pytest.raises(CancelledError):
        settled(_Answer(status), "closed")
