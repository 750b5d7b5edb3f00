"""The verdicts of proof methods, and their limits."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from cspdiag.base.record import record

Method: TypeAlias = Literal["rules", "sat", "invariants", "stubborn", "minimization", "breadth-first", "spin"]


@record
class Move:
    """One step of a trace: the event (an index, or INTERNAL), and the components that take part, each with the state
    that it goes to.
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
    """The property fails: ``trace``, the shortest found, leads from the initial state to the failure.

    ``stuck`` are the components that never continue (deadlock and knots). For livelock ``cycle`` repeats forever after
    the trace. For refinement ``reason`` says which forbidden event or refusal was found.
    """

    method: Method
    trace: tuple[Move, ...]
    stuck: tuple[int, ...] = ()
    cycle: tuple[Move, ...] = ()
    states: int | None = None
    reason: str = ""


@record
class Unknown:
    """The property is neither proved nor refuted. ``candidate`` is a global state that could not be excluded, ``stuck``
    the components that may be stuck in it.
    """

    method: Method
    reason: str
    candidate: tuple[int, ...] | None = None
    stuck: tuple[int, ...] = ()


Verdict: TypeAlias = Proved | Refuted | Unknown


class LimitError(BaseException):
    """The allowed time or memory is used up.

    It may be raised anywhere; as a BaseException it is not caught by libraries as a failure of the code that they call.
    """


@dataclass
class Limits:
    """The time (seconds from now) and memory (bytes of the state store) that a method may use; the method calls
    ``check`` regularly.
    """

    seconds: float = 60.0
    memory: int = 2_000_000_000
    clock: Callable[[], float] = lambda: time.monotonic()
    """The clock; processor time (``time.process_time``) if an answer must not depend on the load of the machine."""
    started: float = field(init=False)

    def __post_init__(self) -> None:
        self.started = self.clock()

    @property
    def remaining(self) -> float:
        """Seconds that are left; negative when the time is up."""
        return self.seconds - (self.clock() - self.started)

    def part(self, seconds: float) -> Limits:
        """Limits for a part of the work, by the same clock."""
        return Limits(min(seconds, self.remaining), self.memory, self.clock)

    def time_is_up(self) -> LimitError:
        """The exception for the time limit."""
        return LimitError(f"the time limit of {self.seconds:.3g} s was reached")

    def check(self, used: int = 0) -> None:
        """Raises LimitError if the time is up, or if ``used`` bytes are more than the allowed memory."""
        if self.clock() - self.started > self.seconds:
            raise self.time_is_up()
        if used > self.memory:
            raise LimitError(f"the memory limit of {self.memory / 1e6:g} MB was reached")


def reachable_states(count: int) -> str:
    """All reachable states, with their number."""
    return "the only reachable state" if count == 1 else f"the {count} reachable states"


def among_reachable_states(count: int) -> str:
    """Where a search looks."""
    return f"{'at' if count == 1 else 'among'} {reachable_states(count)}"


def no_reachable_state_is(count: int) -> str:
    """The beginning of a sentence on what was not found."""
    return f"{reachable_states(count)} is not" if count == 1 else f"none of {reachable_states(count)} is"
