"""What a rendezvous channel knows about the alternatives at its two ends.

Created when the first alternative watches the channel; channels without alternatives have none and do not pay for it.

Invariants:

- A guard is ready while a party waits at the other end: a plain one, or an alternative that has enrolled.
- An alternative is enrolled with a channel exactly while it waits with an enabled guard on that channel and has not
  chosen yet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .selector import Selector, Watchers, attend, lower_bits, raise_bits, without

if TYPE_CHECKING:
    from .alternating import Alternating


class Meeting:
    """Alternatives that may read (``inputs``) and that may write (``outputs``), and which of them wait now."""

    __slots__ = ("inputs", "outputs", "reading", "writing")

    def __init__(self) -> None:
        self.inputs: Watchers = ()
        self.outputs: Watchers = ()
        self.reading: list[tuple[Alternating, int]] = []
        self.writing: list[tuple[Alternating, int]] = []

    @staticmethod
    def enter(waiting: list[tuple[Alternating, int]], choice: Alternating, index: int) -> None:
        """Enrols an alternative, in the order in which alternatives began to wait: it may enrol late, if the other side
        begins to alternate after it began to wait.
        """
        position = len(waiting)
        while position > 0 and waiting[position - 1][0].began > choice.began:
            position -= 1
        waiting.insert(position, (choice, index))

    def writer_arrived(self) -> None:
        """Input guards become ready."""
        raise_bits(self.inputs)

    def writer_left(self) -> None:
        """The last waiting writer has left."""
        lower_bits(self.inputs)

    def reader_arrived(self) -> None:
        """Output guards become ready."""
        raise_bits(self.outputs)

    def reader_left(self) -> None:
        """The last waiting reader has left."""
        lower_bits(self.outputs)

    def watch_input(self, selector: Selector, bit: int, writer_waits: bool) -> None:
        """Registers an alternative with an input guard on the channel."""
        self.inputs = (*self.inputs, (selector, bit))
        if writer_waits:
            selector.ready |= bit
        if self.outputs:
            selector.attend |= bit
            attend(self.outputs)

    def watch_output(self, selector: Selector, bit: int, reader_waits: bool) -> None:
        """Registers an alternative with an output guard on the channel."""
        self.outputs = (*self.outputs, (selector, bit))
        if reader_waits:
            selector.ready |= bit
        if self.inputs:
            selector.attend |= bit
            attend(self.inputs)

    def unwatch(self, selector: Selector) -> None:
        """Forgets an alternative."""
        self.inputs = without(self.inputs, selector)
        self.outputs = without(self.outputs, selector)
