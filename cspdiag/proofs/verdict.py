"""What a proof method answers."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from cspdiag.base.record import record

ONE_REACHABLE = "the only reachable state"


def counted(number: int, noun: str) -> str:
    """``one state``, ``3 states``."""
    return f"one {noun}" if number == 1 else f"{number} {noun}s"


Method: TypeAlias = Literal["rules", "sat", "invariants", "stubborn", "minimization", "breadth-first", "spin"]


@record
class Move:
    """One step of a trace: the event (an index, or INTERNAL) and the state that each component that takes part
    goes to.
    """

    event: int
    moves: tuple[tuple[int, int], ...]


@record
class Proved:
    """The property holds. ``reason`` is a sentence for people: which rule, how many states."""

    method: Method
    reason: str
    states: int | None = None


@record
class Refuted:
    """The property fails: ``trace`` leads from the initial state to where it does, the shortest found.

    ``stuck`` are the components that never go on (deadlock and knots). For livelock ``cycle`` is what repeats forever
    after the trace. For refinement ``reason`` says what the process did too much or refused.
    """

    method: Method
    trace: tuple[Move, ...]
    stuck: tuple[int, ...] = ()
    cycle: tuple[Move, ...] = ()
    states: int | None = None
    reason: str = ""


@record
class Unknown:
    """Neither. ``candidate`` is a state of every component that could not be excluded, with the components suspected to
    be stuck.
    """

    method: Method
    reason: str
    candidate: tuple[int, ...] | None = None
    stuck: tuple[int, ...] = ()


Verdict: TypeAlias = Proved | Refuted | Unknown


class LimitError(BaseException):
    """The time or the memory that was allowed is used up.

    It may be raised anywhere, and no library takes it for a failure of what it called.
    """


@dataclass
class Limits:
    """Time (seconds from now) and memory (bytes of the state store) that a method may use; it calls ``check`` now and
    then.
    """

    seconds: float = 60.0
    memory: int = 2_000_000_000
    clock: Callable[[], float] = lambda: time.monotonic()
    """The clock: that of the processor (``time.process_time``) where an answer must not depend on what else
    the machine does.
    """
    started: float = field(init=False)

    def __post_init__(self) -> None:
        self.started = self.clock()

    @property
    def remaining(self) -> float:
        """Seconds that are left; negative when the time is up."""
        return self.seconds - (self.clock() - self.started)

    def time_is_up(self) -> LimitError:
        """What is raised when the time is up."""
        return LimitError(f"the time limit of {self.seconds:.3g} s was reached")

    def check(self, used: int = 0) -> None:
        """Raise LimitError when the time, or the memory of which ``used`` bytes are taken, is up."""
        if self.clock() - self.started > self.seconds:
            raise self.time_is_up()
        if used > self.memory:
            raise LimitError(f"the memory limit of {self.memory / 1e6:g} MB was reached")
