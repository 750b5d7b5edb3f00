"""What an engine sends, made and written by a thread of its own: a program in real time waits for neither."""

from __future__ import annotations

import time
from collections.abc import Callable
from queue import SimpleQueue
from threading import Condition, Thread
from typing import TextIO, TypeAlias

Text: TypeAlias = Callable[[], str]

PATIENCE = 3.0
"""Seconds for which nobody may read, before a program in real time is considered abandoned."""


class Output:
    """Makes lines and writes them to a stream, in their order."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._lines: SimpleQueue[Text] = SimpleQueue()
        self._changed = Condition()
        self._unwritten = 0
        self._since = 0.0
        """Since when the present line is being written."""
        self._problem: OSError | None = None
        Thread(target=self._write, name="answers", daemon=True).start()

    def put(self, line: Text) -> None:
        """Write a line, soon. Raises BrokenPipeError if nobody reads any more."""
        with self._changed:
            if self._problem is not None:
                raise self._problem
            if not self._unwritten:
                self._since = time.monotonic()
            self._unwritten += 1
        self._lines.put(line)

    def wait(self, limit: float | None = None) -> None:
        """Wait until everything is written, or for ``limit`` seconds. Raises BrokenPipeError."""
        with self._changed:
            self._changed.wait_for(lambda: not self._unwritten or self._problem is not None, limit)
            if self._problem is not None:
                raise self._problem

    @property
    def is_stuck(self) -> bool:
        """Whether nobody has read for a while."""
        with self._changed:
            return bool(self._unwritten) and time.monotonic() - self._since > PATIENCE

    def _write(self) -> None:
        while True:
            line = self._lines.get()
            try:
                self._stream.write(line())
                self._stream.flush()
            except OSError as problem:
                with self._changed:
                    self._problem = problem
                    self._changed.notify_all()
                return
            with self._changed:
                self._unwritten -= 1
                self._since = time.monotonic()
                self._changed.notify_all()
