"""Processes that make runs, one after the other, and what happens when one of them dies."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from typing import IO, Protocol

from cspdiag.base.record import record
from cspdiag.runtime.kernel.signals import name_of_signal
from cspdiag.sweep.result import Result, without_measures

_LARGEST_BATCH = 1 << 15
"""In bytes: a pipe holds that much, so writing tasks never waits for a process that waits for its reader."""


class Maker(Protocol):
    """What makes the runs of a variant: a program and its language. It can be pickled, for other machines."""

    @property
    def runs_once(self) -> bool:
        """Whether each run needs a process of its own."""

    @property
    def measures(self) -> int:
        """The number of measures."""

    @property
    def head(self) -> bytes:
        """What a process is given once."""

    def command(self) -> tuple[str, ...]:
        """The command of the process, which is built if need be. A further argument is the descriptor of a pipe: the
        process ends when the other end is closed.
        """

    def read(self, stream: IO[bytes]) -> Result | None:
        """The next result of a process; None if it has ended before that."""


@record
class Job:
    """How the runs of a variant are made; ``task`` is what a process is given for a run."""

    maker: Maker
    command: tuple[str, ...]
    task: Callable[[int], bytes]


class Worker:
    """A process that makes runs, which is started again when it dies, for another job, or after each run if need be."""

    def __init__(self) -> None:
        self._job: Job | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._lifeline = -1
        """The end of a pipe that nothing is written to. The process ends when it is closed, if only by the death of
        this one.
        """
        self._closed = False

    def results(self, job: Job, runs: Sequence[int]) -> Iterator[tuple[int, Result]]:
        """The results of runs, as they are known. A run in which a process dies is made once more in another one."""
        pending, suspect = list(runs), -1
        while pending and not self._closed:
            count = 1 if job.maker.runs_once or suspect == pending[0] else len(pending)
            done = 0
            for run, result in self._batch(job, pending[:count]):
                yield run, result
                done += 1
            if self._closed:
                return
            if done < count:
                how = self.end()
                if pending[done] == suspect:
                    yield suspect, without_measures("crashed", how, job.maker.measures)
                    done += 1
                    suspect = -1
                else:
                    suspect = pending[done]
            elif job.maker.runs_once:
                self.end()
            del pending[:done]

    def _batch(self, job: Job, runs: Sequence[int]) -> Iterator[tuple[int, Result]]:
        """The results up to the end of the process."""
        process = self._started(job)
        assert process.stdin is not None
        assert process.stdout is not None
        waiting = list(runs)
        while waiting:
            size, tasks = 0, list[bytes]()
            for run in waiting:
                task = job.task(run)
                size += len(task)
                if tasks and size > _LARGEST_BATCH:
                    break
                tasks.append(task)
            with suppress(OSError, ValueError):  # It has died, as the missing result shows.
                process.stdin.write(b"".join(tasks))
                process.stdin.flush()
            for _ in tasks:
                result = job.maker.read(process.stdout)
                if result is None:
                    return
                yield waiting.pop(0), result

    def _started(self, job: Job) -> subprocess.Popen[bytes]:
        if self._process is None or self._job is not job:
            self.end()
            self._job = job
            reading, self._lifeline = os.pipe()
            try:
                # In a session of its own: Ctrl-C is for this process, which ends it.
                self._process = subprocess.Popen(
                    [*job.command, str(reading)],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    start_new_session=True,
                    pass_fds=[reading],
                )
            except BaseException:
                self._release()
                raise
            finally:
                os.close(reading)
            assert self._process.stdin is not None
            with suppress(OSError):
                self._process.stdin.write(job.maker.head)
        return self._process

    def end(self) -> str:
        """End the process; how it had ended, if it had died."""
        process, self._process = self._process, None
        if process is None:
            return ""
        with suppress(OSError):
            if process.stdin is not None:
                process.stdin.close()
        if process.stdout is not None:
            process.stdout.close()
        code = process.wait()
        self._release()
        return f"the process {f'was ended by {name_of_signal(-code)}' if code < 0 else f'ended with code {code}'}"

    def _release(self) -> None:
        descriptor, self._lifeline = self._lifeline, -1
        if descriptor >= 0:
            os.close(descriptor)

    def close(self) -> None:
        """End the process at once; from any thread."""
        self._closed = True
        process = self._process
        if process is not None:
            process.kill()
