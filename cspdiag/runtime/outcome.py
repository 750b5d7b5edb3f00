"""How a run ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, assert_never

from .deadlock.reports import DeadlockReport
from .kernel.exceptions import Deadlock
from .kernel.signals import exit_code_of
from .real_time.jitter import Jitter

Ending = Literal["terminated", "deadlock", "time limit", "stopped", "failed"]


@dataclass
class Outcome:
    """How a run ended.

    ``time`` is the instant in nanoseconds, ``wall_time`` the seconds it took. ``missed`` counts, for every sampled
    input, the samples that were overwritten before they were taken; ``jitter`` has the lateness of the ticks of each
    period (real time only).
    """

    ended: Ending
    time: int
    error: BaseException | None = None
    deadlock: DeadlockReport | None = None
    missed: dict[str, int] = field(default_factory=dict)
    jitter: dict[int, Jitter] = field(default_factory=dict)
    wall_time: float = 0.0
    signal: int = 0
    """The signal that stopped it."""
    real_time: bool = False
    """Whether it ran against the clock."""
    preference: str = ""
    """What the operating system granted to a run against the clock: the scheduling class, and locked memory."""
    links: list[str] = field(default_factory=list)
    """What was measured of the links to other hosts, a line for each."""
    release_errors: list[BaseException] = field(default_factory=list)
    """The errors of drivers that failed during the release of their outputs or while they were closed."""

    @property
    def exit_code(self) -> int:
        """For a command that consists of the run: 0, 1 or, for a run stopped by a signal, 128 plus its number. 1 takes
        precedence if an output was not released.
        """
        if self.release_errors:
            return 1
        match self.ended:
            case "terminated" | "time limit":
                return 0
            case "stopped":
                return exit_code_of(self.signal)
            case "deadlock" | "failed":
                return 1
            case _:
                assert_never(self.ended)

    def raise_if_unsuccessful(self) -> None:
        """Raises the error of a run that failed, or Deadlock with the report."""
        if self.error is not None:
            raise self.error
        if self.deadlock is not None:
            raise Deadlock(self.deadlock.text)
