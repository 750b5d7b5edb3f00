"""What a run of a program is, for all implementations of the language: its trace, and how it ended."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Communication(NamedTuple):
    """A value that passed through an external port or a channel at ``time`` (nanoseconds). «Traces»

    ``writer`` and ``reader`` are the paths of the processes where an implementation knows them; traces are equal
    whatever they are.
    """

    time: int
    channel: str
    value: object
    writer: str = ""
    reader: str = ""


class Ending(NamedTuple):
    """How a run ended (``terminated``, ``deadlock``, ``time limit``, ``failed``), when, and the exception's name.

    «Scheduling and traces»

    ``message`` is what the exception says, with its place; None where an implementation says nothing.
    """

    ended: str
    time: int
    error: str | None = None
    message: str | None = None

    def agrees_with(self, other: Ending) -> bool:
        """Whether it is the same end, as far as both sides know."""
        both_known = None not in (self.message, other.message)
        return self[:3] == other[:3] and (not both_known or self.message == other.message)

    def __str__(self) -> str:
        error = "" if self.error is None else f" with {self.error}"
        message = "" if self.message is None else f": {self.message}"
        return f"{self.ended} at {self.time / 1e6:.6f} ms{error}{message}"


class Execution(NamedTuple):
    """What an implementation did with a program. «Traces»

    ``released`` are the safe values that outputs were handed at the end, in order; None where an implementation hands
    over none.
    """

    trace: Sequence[Communication]
    ending: Ending
    released: Sequence[tuple[str, object]] | None = None
    missed: Sequence[tuple[str, int]] = ()
    """For each sampled input how many samples were overwritten before somebody had taken them."""
    reason: str = ""
    """What made it fail, for people."""
    failure: Exception | None = None
    """The exception itself."""
