"""Workers of a sweep: processes of a Dask cluster, here or on many machines.

A worker makes the settings of a point its numbers, or the reason of its failure, and
keeps what many points have in common between them.
Every worker has one point at a time, so that the death of a worker tells which point it
died of. Such a point is tried once more, and then given up.
"""

import asyncio
import atexit
import logging
import os
import signal
import tempfile
import time
from collections import Counter, deque
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

from sim.errors import SweepError, UsageError, one_line
from sim.interruption import deaf
from sim.preparation.shared import Shared
from sim.runs.seals import TOLD
from sim.scenarios.file import scenario_from
from sim.simulation import simulate
from sim.sweeps import ledger
from sim.sweeps.ledger import OK, Outcome, software

try:
    import cryptography  # noqa: F401 (of which Security says too late that it lacks)
    import dask
    from distributed import Client, Future, KilledWorker, LocalCluster, wait
    from distributed.comm import connect
    from distributed.deploy.spec import close_clusters
    from distributed.scheduler import NoValidWorkerError, NoWorkerError
    from distributed.security import Security
    from distributed.utils import get_mp_context
except ValueError as refusal:  # of a file of settings in Dask's own folders
    what, remedy = str(refusal), "correct the file, or unset DASK_CONFIG"
    raise UsageError(what, "settings of Dask", remedy) from None

NO_WORKER_TIMEOUT = 120.0  # [s] without any worker, before that is an error
ANSWER = 15.0  # [s] for the scheduler to come forward
TRIES = 2  # of a point whose worker dies
# A search for a plan keeps the rest of its process waiting, on a busy machine for
# minutes; that is no death. Processes that do die close their connections.
QUIET: Mapping[str, object] = {
    "distributed.logging.distributed": "critical",
    "distributed.scheduler.http.routes": [],  # no pages
    "distributed.scheduler.worker-ttl": None,
    "distributed.comm.timeouts.tcp": "600s",
    "distributed.deploy.lost-worker-timeout": "1h",  # its successor may start slowly
    "distributed.worker.multiprocessing-method": "forkserver",  # which loads all once
}
SOFTWARE = "__import__('sim.sweeps.ledger', fromlist=['*']).software()"
"""A question that a worker can take in, and answer, without this package."""
GONE = (KilledWorker, NoValidWorkerError, NoWorkerError)  # as Dask tells of the dead


@dataclass(frozen=True, slots=True)
class Task:
    """A point to be walked."""

    digest: str
    table: Mapping[str, object]  # of its scenario, in plain values
    without: Sequence[str] = ()
    named: Collection[str] = ()  # settings that the sweep gives

    def carry_out(self) -> Outcome:
        """Walk the point; whatever goes wrong with it becomes its status."""
        code, left_out = self.digest, self.without
        try:
            scenario = scenario_from(self.table, {}, "the sweep")
            scenario = replace(scenario, given=frozenset(self.named))
            shared = _shared(ledger.files_of(scenario))
            code = ledger.digest(scenario, left_out)
            summary = simulate(scenario, without=left_out, shared=shared).summary
        except Exception as error:  # any failure of a point is one of its results
            return Outcome(code, one_line(error), software=software())
        return Outcome(code, OK, dict(numbers(summary)), software())


@lru_cache(maxsize=8)
def _shared(files: tuple[tuple[str, str], ...]) -> Shared:
    """What this process keeps from point to point, while its files are these."""
    return Shared()


def numbers(summary: object, name: str = "") -> Iterator[tuple[str, object]]:
    """Numbers and words of a summary by their dotted names."""
    if isinstance(summary, list | tuple):
        summary = {str(place): value for place, value in enumerate(summary)}
    if not isinstance(summary, Mapping):
        yield name, summary
        return
    for key, value in summary.items():
        if name or key not in TOLD:  # the time differs from run to run
            yield from numbers(value, f"{name}.{key}" if name else key)


@dataclass(frozen=True)
class WorkerPool:
    """The workers that there are at the moment, and what each of them does."""

    client: Client
    running: dict[Future, tuple[Task, str]] = field(default_factory=dict)
    asked: dict[str, Future] = field(default_factory=dict)
    accepted: set[str] = field(default_factory=set)
    refused: dict[str, str] = field(default_factory=dict)
    deaths: Counter[str] = field(default_factory=Counter)

    def carry_out(self, tasks: Iterable[Task]) -> Iterator[Outcome]:
        """Outcomes of tasks as they come; SweepError without workers or scheduler."""
        try:
            yield from self._carried_out(tasks)
        except (OSError, CancelledError) as error:
            where, why = self.client.scheduler.address, type(error).__name__
            raise SweepError.of("scheduler_gone", where, why=why) from error

    def _carried_out(self, tasks: Iterable[Task]) -> Iterator[Outcome]:
        waiting, seen = deque(tasks), time.monotonic()
        done: list[Outcome] = []
        while waiting or self.running:
            for worker in self._free()[: len(waiting)]:
                task = waiting.popleft()
                self.running[self._submit(worker, Task.carry_out, task)] = task, worker
            yield from done  # while the workers are busy with the next ones
            done = []
            if self.running:
                seen = time.monotonic()
                for task, outcome in self._finished():
                    if outcome is None:
                        waiting.appendleft(task)
                    else:
                        done.append(outcome)
            elif waiting:
                seen = self._be_patient(seen)
        yield from done

    def _free(self) -> list[str]:
        """Addresses of workers that may take part and have nothing to do."""
        there = self._there()
        for worker in there:
            if worker not in self.asked:
                self.asked[worker] = self._submit(worker, eval, SOFTWARE)
        for worker, answer in list(self.asked.items()):
            if worker not in self.accepted | self.refused.keys() and answer.done():
                self._judge(worker, answer)
        busy = {worker for _, worker in self.running.values()}
        return [worker for worker in there if worker in self.accepted - busy]

    def _there(self) -> Mapping[str, object]:
        """Workers that the scheduler has, by address.

        The client's own `scheduler_info` may give the answer to another question, which
        lists no workers at all: whoever trusts it takes the living for dead.
        """
        return self.client.sync(self.client.scheduler.identity, n_workers=-1)["workers"]

    def _judge(self, worker: str, answer: Future) -> None:
        """Let a worker take part if it computes with what we compute with."""
        if answer.status != "finished":
            error = answer.exception() if answer.status == "error" else None
            if error is None or isinstance(error, GONE):
                del self.asked[worker]  # its successor is asked anew
            else:
                self.refused[worker] = one_line(error)
            return
        if (found := self._fetched(worker, answer)) is None:
            del self.asked[worker]
        elif differ := ledger.differences(*ledger.alike(software(), found)):
            self.refused[worker] = ", ".join(differ).replace("now", "there")
        else:
            self.accepted.add(worker)

    def _fetched(self, worker: str, future: Future) -> Any:
        """The result that a worker has; None if it died before it handed it over.

        Dask would wait for it for ever: no other worker may do the work again.
        """
        while True:
            try:
                return future.result(1)
            except GONE:
                return None
            except TimeoutError:
                if worker not in self._there():
                    return None

    def _submit(self, worker: str, work: object, *given: object) -> Future:
        there = {"workers": [worker], "allow_other_workers": False}
        return self.client.submit(work, *given, **there, pure=False)

    def _finished(self) -> list[tuple[Task, Outcome | None]]:
        """Tasks that have come back; None for one that is to be tried again."""
        done = set[Future]()
        with suppress(TimeoutError):
            done = wait(list(self.running), 1, return_when="FIRST_COMPLETED").done
        there = self._there() if not done else {}
        lost = {f for f, (_, w) in self.running.items() if not done and w not in there}
        return [self._settle(future) for future in done | lost]

    def _settle(self, future: Future) -> tuple[Task, Outcome | None]:
        task, worker = self.running.pop(future)
        if future.status == "finished" and (found := self._fetched(worker, future)):
            if found.digest != task.digest:
                raise SweepError.of("other_files", worker)
            return task, found
        if future.status in ("cancelled", "lost") and self.client.status != "running":
            raise CancelledError
        error = future.exception() if future.status == "error" else None
        future.cancel()
        if error is not None and not isinstance(error, GONE):
            return task, Outcome(task.digest, one_line(error), software=software())
        self.deaths[task.digest] += 1
        if self.deaths[task.digest] < TRIES:
            return task, None
        why = f"{TRIES} times: it was killed, or out of memory"
        reason = f"{ledger.DIED}, {why}; --resume walks the point again"
        return task, Outcome(task.digest, reason, software=software())

    def _be_patient(self, since: float) -> float:
        """Wait a little for a worker; when there was hope of one last [s]."""
        unlike = {w: why for w, why in self.refused.items() if w in self.asked}
        there = self._there()
        if there and there.keys() <= unlike.keys():
            worker, why = next(iter(unlike.items()))
            raise SweepError.of("software", worker, why=why)
        if there.keys() - unlike.keys():  # it is loading what it is asked about
            since = time.monotonic()
        if time.monotonic() - since > NO_WORKER_TIMEOUT:
            where = self.client.scheduler.address
            raise SweepError.of("no_worker", where, seconds=NO_WORKER_TIMEOUT)
        time.sleep(0.05)
        return since


@contextmanager
def open_pool(workers: int, scheduler: str | None) -> Iterator[WorkerPool]:
    """Workers while the block runs, of this machine or of a scheduler's address."""
    for name in ("asyncio", "distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    logging.getLogger("distributed").handlers[:] = [logging.NullHandler()]
    dask.config.set(QUIET)
    get_mp_context().set_forkserver_preload(["sim.sweeps.muted", __name__])
    with ExitStack() as stack:
        local = _local(stack, workers) if scheduler is None else None
        at = scheduler if local is None else local
        try:
            if scheduler is not None:
                asyncio.run(_greet(scheduler))
            client = stack.enter_context(Client(at, timeout=ANSWER))
        except Exception as error:  # a library may raise anything of an address
            why = " ".join(str(error).split()) or type(error).__name__
            raise SweepError.of("no_answer", at, why=why) from error
        try:
            yield WorkerPool(client)
        except KeyboardInterrupt:
            for nanny in () if local is None else local.workers.values():
                nanny.close_gracefully()  # it starts no other worker
                if nanny.pid is not None:
                    with suppress(ProcessLookupError):
                        os.kill(nanny.pid, signal.SIGKILL)  # nor is its point finished
            raise


async def _greet(scheduler: str) -> None:
    """Raise an error unless a scheduler says hello, for which Dask waits for ever."""
    async with asyncio.timeout(1.5 * ANSWER):
        (await connect(scheduler, timeout=ANSWER)).abort()


def _local(stack: ExitStack, workers: int) -> LocalCluster:
    """A scheduler in this process, and workers that obey nobody else on the machine."""
    os.getcwd()  # an error of its own where it is gone; no worker would start there
    folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
    try:
        with deaf([signal.SIGXCPU, signal.SIGHUP]):  # which end it, no point
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                host="127.0.0.1",
                dashboard_address=None,
                security=Security.temporary(),
                memory_limit=0,
                local_directory=stack.enter_context(folder),
                silence_logs=logging.CRITICAL,
            )
    except KeyboardInterrupt:
        atexit.unregister(close_clusters)  # which cannot close one half started
        raise
    except (RuntimeError, OSError) as error:
        raise SweepError.of("died", f"{workers} here") from error
    return stack.enter_context(cluster)
