"""Makes the runs of a sweep, on all processors of this machine."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from functools import partial
from queue import SimpleQueue
from typing import TYPE_CHECKING, Protocol

from cspdiag.base.record import replaced
from cspdiag.sweep.result import Result, without_measures
from cspdiag.sweep.workers import Job, Worker

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.pipeline import Reader
    from cspdiag.sweep.cluster import Cluster
    from cspdiag.sweep.plan import Plan, Variant

_LARGEST_CHUNK = 32
"""Runs that a process is given at a time; towards the end it is fewer, so all processes end together."""


def processors() -> int:
    """How many processors this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:
        return os.cpu_count() or 1


class Jobs:
    """The jobs of the variants of a plan, each made when it is first needed; variants with equal networks share one."""

    def __init__(self, plan: Plan, reader: Reader, target: str) -> None:
        self._plan = plan
        self._reader = reader
        self._target = target
        self._known: dict[int, Job | str] = {}
        self._of_network: dict[CoreNetwork, Job] = {}
        self.seconds = 0.0
        """The time that was spent on compiling."""
        self.reason = ""
        """Why runs are made in Python; empty if they are not."""

    @property
    def compiled(self) -> bool:
        """Whether runs are made by native programs."""
        return bool(self.seconds) and self._target != "python" and not self.reason

    @property
    def made(self) -> str:
        """How runs are made, in a few words."""
        if self._target == "python":
            return "in Python"
        return f"in Python: {self.reason}" if self.reason else "as a native program"

    def __getitem__(self, number: int) -> Job | str:
        """The job of a variant, or why there is none: the first error of its program. Raises TargetError and
        CompilerError for the target "c".
        """
        if number not in self._known:
            began = time.monotonic()
            variant = self._plan.variant(number)
            self._known[number] = variant.error if variant.network is None else self._shared(variant, variant.network)
            self.seconds += time.monotonic() - began
        return self._known[number]

    def _shared(self, variant: Variant, network: CoreNetwork) -> Job:
        if network not in self._of_network:
            self._of_network[network] = self._job(variant)
        return self._of_network[network]

    def _job(self, variant: Variant) -> Job:
        from cspdiag.codegen import target_errors
        from cspdiag.simulate.native.build import CompilerError

        if self._target != "python" and not self.reason:
            try:
                return native_job(self._plan, variant, self._reader)
            except (CompilerError, target_errors()) as problem:
                if self._target == "c":
                    raise
                self.reason = str(problem).partition("\n")[0]
        from cspdiag.sweep.in_python import python_maker, task_of

        python = python_maker(self._plan)
        return Job(python, python.command(), partial(task_of, self._plan))


def native_job(plan: Plan, variant: Variant, reader: Reader) -> Job:
    """The job of native processes. Raises TargetError and CompilerError."""
    from cspdiag.sweep.native import ParameterWriter, native_maker

    assert variant.network is not None
    maker = native_maker(plan, variant, reader)
    return Job(maker, maker.command(), ParameterWriter(plan, variant.network).task)


class Source(Protocol):
    """Where runs are made."""

    def results(self, job: Job, runs: Sequence[int]) -> Iterator[tuple[int, Result]]:
        """The results of the runs of one job, in any order."""


class Pool:
    """Workers, one in each of several threads; used as a context manager, whose end ends them."""

    def __init__(self, count: int) -> None:
        self._workers = [Worker() for _ in range(count)]
        self._threads: list[threading.Thread] = []
        self._results: SimpleQueue[tuple[int, Result] | BaseException | None] = SimpleQueue()
        self._lock = threading.Lock()
        self._ended = False

    def results(self, job: Job, runs: Sequence[int]) -> Iterator[tuple[int, Result]]:
        """The results of the runs of one job, in any order."""
        waiting = list(reversed(runs))

        def next_chunk() -> list[int]:
            with self._lock:
                count = max(1, min(_LARGEST_CHUNK, len(waiting) // (4 * len(self._workers))))
                return [waiting.pop() for _ in range(min(count, len(waiting)))]

        def work(worker: Worker) -> None:
            try:
                while not self._ended and (chunk := next_chunk()):
                    for found in worker.results(job, chunk):
                        self._results.put(found)
            except BaseException as problem:
                self._results.put(problem)
            self._results.put(None)

        self._threads = [threading.Thread(target=work, args=(worker,), daemon=True) for worker in self._workers]
        for thread in self._threads:
            thread.start()
        working = len(self._threads)
        while working:
            found = self._results.get()
            if found is None:
                working -= 1
            elif isinstance(found, BaseException):
                raise found
            else:
                yield found

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self._ended = True
        for worker in self._workers:
            worker.close()
        for thread in self._threads:
            thread.join()
        for worker in self._workers:
            worker.end()


def source_of_runs(dask: str | None, workers: int) -> Pool | Cluster:
    """Where runs are made: on the cluster at an address, or in processes of this machine. Raises ClusterError."""
    if dask is None:
        return Pool(workers)
    from cspdiag.sweep.cluster import Cluster

    return Cluster(dask)


def make_runs(
    plan: Plan,
    runs: Sequence[int],
    jobs: Jobs,
    source: Source,
    *,
    on_build: Callable[[int], None] = lambda _: None,
) -> Generator[tuple[int, Result], None, None]:
    """The results of runs as they are known; ``on_build`` is called before the program of a variant is built."""
    by_variant: dict[int, list[int]] = {}
    for run in runs:
        by_variant.setdefault(plan.variant_of(run), []).append(run)
    for number, own in by_variant.items():
        on_build(number)
        job = jobs[number]
        if isinstance(job, str):
            for run in own:
                yield run, without_measures("refused", job, len(plan.measures.measures))
        else:
            for run, result in source.results(job, own):
                yield run, _with_reason(plan, run, result)


def _with_reason(plan: Plan, run: int, result: Result) -> Result:
    """The result with the reason why the program was refused, which a native process does not know."""
    if result.ended != "refused" or result.error:
        return result
    return replaced(result, error=plan.refusal(run) or "the program cannot have these values")
