"""The result of a run, in all implementations of the language: the trace, and how the run ended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Communication(NamedTuple):
    """A value that passed through an external port or a channel at ``time`` (nanoseconds). «Traces»

    ``writer`` and ``reader`` are the paths of the processes, if an implementation knows them; traces are compared
    without them.
    """

    time: int
    channel: str
    value: object
    writer: str = ""
    reader: str = ""


class Ending(NamedTuple):
    """How a run ended (``terminated``, ``deadlock``, ``time limit``, ``failed``), when, and the exception's name.

    «Scheduling and traces»

    ``message`` is the message of the exception, with its place, or the report of the deadlock; None if an
    implementation gives none.
    """

    ended: str
    time: int
    error: str | None = None
    message: str | None = None

    def agrees_with(self, other: Ending) -> bool:
        """Whether both are the same ending, as far as both implementations report it."""
        both_known = None not in (self.message, other.message)
        return self[:3] == other[:3] and (not both_known or self.message == other.message)

    def __str__(self) -> str:
        error = "" if self.error is None else f" with {self.error}"
        message = "" if self.message is None else f": {self.message}"
        return f"{self.ended} at {self.time / 1e6:.6f} ms{error}{message}"


class Execution(NamedTuple):
    """The run of a program by one implementation. «Traces»

    ``released`` are the safe values that outputs were set to at the end, in order; None if an implementation does not
    release outputs.
    """

    trace: Sequence[Communication]
    ending: Ending
    released: Sequence[tuple[str, object]] | None = None
    missed: Sequence[tuple[str, int]] = ()
    """For each sampled input the number of samples that were overwritten before a process had taken them."""
    reason: str = ""
    """Why the run failed, in words."""
    failure: Exception | None = None
    """The exception itself."""
