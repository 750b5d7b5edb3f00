"""What a run leaves open, and who decides it.

Without a policy the first ready process is next, ``[]`` is fair, and only observers are notified. A policy can decide
otherwise within what the language allows, or halt tasks before each of their steps, so that a run can be led through a
trace. It needs readable code (``-O0``), as optimized code communicates in place.
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
    """Something with which a task can continue; ``index`` distinguishes the guards of an alternative.

    ``ready`` is a guard that leaves the reading to the guarded process, ``wait`` a delay, ``after`` a time-out,
    ``skip`` a guard without a partner. ``duration``, in nanoseconds, belongs to ``wait`` and ``after``, ``value`` to
    ``write``.
    """

    action: Action
    channel: str = ""
    index: int = 0
    duration: int = 0
    value: Any = field(default=None, compare=False)


class Gate(Waitable, Protocol):
    """Where a task halts. ``chosen`` is what it then continues with; None: as in any run."""

    @property
    def chosen(self) -> Option | None: ...  # noqa: D102


class Interruption(Protocol):
    """An interrupt whose body is running, for a policy that decides when it happens."""

    @property
    def task(self) -> Party: ...  # noqa: D102

    @property
    def option(self) -> Option: ...  # noqa: D102

    def come(self, *, taken: bool) -> None:
        """Abandons the body at its next communication; the guard is then ``taken``, or has to wait for its turn."""
        ...


class Policy:
    """Decides what the language leaves open in a run, and is notified of what tasks do. These methods decide as in any
    run; subclasses override some.
    """

    leads_interrupts = False
    """Whether the policy, not the guards, decides when interrupts happen."""

    # What it decides

    def next(self, ready: Sequence[Party]) -> int:
        """Which of the parties that are ready on the highest level is next: an index. They are in the order in which
        they became ready.
        """
        return 0

    def choose(self, task: Party, ready: Sequence[Option], *, prioritized: bool) -> int:
        """Which of the ready guards an alternative takes: an index. The guards are in the fair order or, if
        ``prioritized``, in text order, of which only the first may be taken.
        """
        return 0

    def halt(self, task: Party, options: Sequence[Option], *, together: bool) -> Gate | None:
        """A task reaches a communication, a delay or an alternative: the gate at which it halts before that, or None.

        It will continue with one of the options, which are in text order, or with all of them in any order if they are
        ``together``.
        """
        return None

    # What it is notified of

    def arrives(self, task: Party) -> None:
        """A task has reached an alternative, and has not yet looked at its guards."""

    def did(self, task: Party, option: Option) -> None:
        """A task has taken ``option``: it has communicated, a delay has ended, or it has taken a guard."""

    def took_part(self, party: Party, action: Literal["read", "write", "miss"], channel: str) -> None:
        """One side of a communication, for which observers are notified of both sides together, or of the other side
        only: a write to a broadcast, a read from a buffer, a sample that was found overwritten.
        """

    def wrote(self, party: Party, channel: str, value: Any) -> None:
        """A value was written to an output of the outermost process."""

    def computes(self) -> None:
        """A control law computes, after it has read its inputs and before it writes: time may pass."""

    def interrupt_begins(self, interruption: Interruption) -> None:
        """The body of an interrupt begins; the policy decides when the interrupt happens."""

    def interrupt_ends(self, interruption: Interruption) -> None:
        """The body of such an interrupt has ended."""


def compute_first(policy: Policy, executed: Executed | None) -> None:
    """Before the first write of a control law, or at its end."""
    if executed is not None and not executed.has_computed:
        executed.has_computed = True  # type: ignore[misc]  # Those without this attribute have always computed.
        policy.computes()
