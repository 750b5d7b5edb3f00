"""What a run leaves open, and who decides it.

Without a policy the first ready process is next, ``[]`` is fair, and nobody is told more than observers are. A policy
decides otherwise within what the language allows, or lets tasks halt before what they do, so that a run can be led
through a trace. It needs the readable code (``-O0``): optimized code communicates in place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, TypeAlias

from .executed import Executed
from .party import Party, Waitable

Action: TypeAlias = Literal["read", "write", "ready", "wait", "after", "skip"]


@dataclass(frozen=True)
class Option:
    """Something that a task can go on with; ``index`` tells the guards of an alternative apart.

    ``ready`` is a guard that leaves the reading to the guarded process, ``wait`` a delay, ``after`` a time-out,
    ``skip`` a guard in which nobody else takes part. ``duration``, in nanoseconds, belongs to ``wait`` and ``after``,
    ``value`` to ``write``.
    """

    action: Action
    channel: str = ""
    index: int = 0
    duration: int = 0
    value: Any = field(default=None, compare=False)


class Gate(Waitable, Protocol):
    """Where a task halts. ``chosen`` is what it then goes on with, None: as in any run."""

    @property
    def chosen(self) -> Option | None: ...  # noqa: D102


class Interruption(Protocol):
    """An interrupt whose body runs, for a policy that decides when it comes."""

    @property
    def task(self) -> Party: ...  # noqa: D102

    @property
    def option(self) -> Option: ...  # noqa: D102

    def come(self, *, taken: bool) -> None:
        """Abandons the body at its next communication; the guard is ``taken`` with that, or else has to wait for its
        turn.
        """
        ...


class Policy:
    """Decides what a run leaves open, and is told what tasks do. These are the decisions of every run; subclasses
    override some.
    """

    leads_interrupts = False
    """Whether the policy decides when interrupts come, and not their guards."""

    # What it decides

    def next(self, ready: Sequence[Party]) -> int:
        """Who of those that are ready on the highest level is next: a position; they stand in the order in which they
        came.
        """
        return 0

    def choose(self, task: Party, ready: Sequence[Option], *, prioritized: bool) -> int:
        """Which of the guards that are ready an alternative takes: a position. They stand in the order that is fair, or
        if ``prioritized`` in that of the text, where only the first may be taken.
        """
        return 0

    def halt(self, task: Party, options: Sequence[Option], *, together: bool) -> Gate | None:
        """A task comes to a communication, a delay or an alternative: where it halts before that, None if it does not.

        It will go on with one of the options, which are in text order; with all of them in any order if they belong
        ``together``.
        """
        return None

    # What it is told

    def arrives(self, task: Party) -> None:
        """A task comes to an alternative, and has not looked at its guards."""

    def did(self, task: Party, option: Option) -> None:
        """A task has gone on with this: a communication, the end of a delay, a guard."""

    def took_part(self, party: Party, action: Literal["read", "write", "miss"], channel: str) -> None:
        """One side of what observers are told of as a whole, or of the other side alone: a write to a broadcast, a read
        from a buffer, a sample that was found overwritten.
        """

    def wrote(self, party: Party, channel: str, value: Any) -> None:
        """A value was written to an output of the outermost process."""

    def computes(self) -> None:
        """A control law computes, after it has read its inputs and before it writes: time may pass."""

    def interrupt_begins(self, interruption: Interruption) -> None:
        """The body of an interrupt begins that comes when the policy says so."""

    def interrupt_ends(self, interruption: Interruption) -> None:
        """The body of such an interrupt has ended."""


def compute_first(policy: Policy, executed: Executed | None) -> None:
    """Before the first write of a control law, or at its end."""
    if executed is not None and not executed.has_computed:
        executed.has_computed = True  # type: ignore[misc]  # Those without a place for it have always computed.
        policy.computes()
