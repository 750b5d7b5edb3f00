"""Makes the runs of a sweep on the machines of a Dask cluster."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from types import TracebackType
from typing import Any, Self

from cspdiag.base.errors import CspdiagError, missing_package
from cspdiag.sweep.result import Result
from cspdiag.sweep.workers import Job, Maker, Worker

_LARGEST_CHUNK = 256
"""Runs of a task of the cluster."""
_TASKS_OF_EACH = 8
"""Tasks for each thread of the cluster, if there are enough runs: those of a machine that is lost are made again."""
_PATIENCE = 10
"""Seconds in which the scheduler has to answer."""

_LOST = "scheduler-connection-lost"
"""What Dask says of tasks whose scheduler is gone."""


class ClusterError(CspdiagError):
    """The cluster does not answer, or cannot make runs; the message is one line."""


class Cluster:
    """The cluster with the scheduler at an address, such as ``tcp://10.0.0.5:8786``; used as a context manager.

    Raises ClusterError if it does not answer, and MissingPackageError if the package ``distributed`` is missing.
    """

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise missing_package("distributed", "dask") from None
        self._address = address
        # What it logs of a lost connection is a traceback, and is raised as well.
        self._log = logging.getLogger("distributed.client")
        self._level = self._log.level
        try:
            connect: Any = Client
            self._client = connect(address, timeout=_PATIENCE, set_as_default=False)
        except (OSError, ValueError) as problem:
            reason = str(problem).partition("\n")[0] or type(problem).__name__
            raise ClusterError(f"no scheduler of Dask answers at {address}: {reason}") from None

    def results(self, job: Job, runs: Sequence[int]) -> Iterator[tuple[int, Result]]:
        """The results of the runs of one job, in any order. Raises ClusterError."""
        from distributed import as_completed

        threads = sum(self._client.nthreads().values()) or 1
        size = max(1, min(_LARGEST_CHUNK, len(runs) // (_TASKS_OF_EACH * threads)))
        # The program is the result of a task: if the machine that has it is lost, it is sent to another one.
        maker = self._client.submit(_itself, job.maker, pure=False)
        tasks = [
            self._client.submit(make_chunk, maker, [(run, job.task(run)) for run in runs[at : at + size]], pure=False)
            for at in range(0, len(runs), size)
        ]
        try:
            completed: Any = as_completed
            for found in completed(tasks, loop=self._client.loop):
                results: list[tuple[int, Result]] = found.result()
                yield from results
        except (GeneratorExit, KeyboardInterrupt):
            raise
        except Exception as problem:
            reason = str(problem).partition("\n")[0] or type(problem).__name__
            if _LOST in reason:
                raise ClusterError(f"the scheduler at {self._address} has gone away") from None
            raise ClusterError(f"the cluster cannot make the runs: {reason}") from problem
        finally:
            self._client.cancel(tasks)

    def __enter__(self) -> Self:
        self._log.setLevel(logging.CRITICAL + 1)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._client.close()
        self._log.setLevel(self._level)


def _itself(maker: Maker) -> Maker:
    return maker


def make_chunk(maker: Maker, tasks: Sequence[tuple[int, bytes]]) -> list[tuple[int, Result]]:
    """Some results, on a machine of the cluster."""
    known: dict[int, bytes] = dict(tasks)
    worker = Worker()
    try:
        return list(worker.results(Job(maker, maker.command(), known.__getitem__), list(known)))
    finally:
        worker.close()
        worker.end()
