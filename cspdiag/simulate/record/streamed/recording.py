"""A recording while the run continues: values come from the run, and go to a file in blocks.

What is not yet written is bounded, however long the run is. A file that cannot be written any more does not end the
run: that would leave a plant alone for the sake of its record.
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from cspdiag.base.errors import CspdiagError
from cspdiag.runtime.kernel.signals import left_to_the_main_thread
from cspdiag.simulate.record.leaves import leaf, leaves
from cspdiag.simulate.record.streamed.blocks import Block, Pending, Writer, array_of, halved, in_pieces

if TYPE_CHECKING:
    import numpy

    from cspdiag.simulate.record.stored.described import RecordingHead

WALL_INTERVAL = 0.25
"""Seconds after which what a run has passed is in the file."""
_MOST_WAITING = 64
"""Blocks of a run against the clock that may wait for a slow disk."""


class TooSlowError(CspdiagError, OSError):
    """The file took longer to write than the run."""


class Listener(Protocol):
    """Who else is shown what is recorded, while it is."""

    def show(self, blocks: Sequence[Block]) -> None:
        """Values of some time; returns without waiting for anybody."""
        ...

    def close(self) -> None:
        """The run is over."""
        ...


class Recording:
    """What receives the values of one run, by the hierarchical names of its ports.

    ``writer`` is None if values are only shown to a listener. ``on_problem`` is called once, if a file cannot be
    written any more, with the problem and the instant in nanoseconds up to which it has everything. ``background``:
    files are written in a thread of their own, so that a slow disk does not delay a run against the clock.
    """

    def __init__(
        self,
        head: RecordingHead,
        writer: Writer | None,
        *,
        on_problem: Callable[[OSError, int], object],
        listener: Listener | None = None,
        background: bool = False,
    ) -> None:
        # Now, as the first values come while the run is against the clock, which this would stop for some 50 ms.
        import numpy  # noqa: F401

        self.head = head
        self.problem: OSError | None = None
        """Why the file is not whole; None if it is."""
        self.positions = {f"{head.process}.{port.name}": position for position, port in enumerate(head.ports)}
        """The positions of the ports by hierarchical name."""
        self._writer = writer
        self._listener = listener
        self._on_problem = on_problem
        self._pending = Pending(len(head.ports))
        self._written = 0
        self._thread = _Thread(self._write) if background else None

    def add(self, channel: str, time: numpy.ndarray, value: numpy.ndarray) -> None:
        """Values of a port, in order: instants in nanoseconds and an array of the type of the port."""
        self._pending.add(self.positions[channel], time, value)

    def add_noted(self, channel: str, time: Any, value: Any) -> None:
        """The same, from sequences in which they were noted."""
        import numpy

        kind = self.head.ports[self.positions[channel]].type
        self.add(channel, numpy.array(time, dtype=numpy.int64), array_of(value, kind))

    def add_parameters(self, time: int, value: object) -> None:
        """The values of all parameters of the program, from an instant on; not for recordings without them."""
        name = next(port.name for port in self.head.ports if port.direction == "parameter")
        self.add_noted(f"{self.head.process}.{name}", [time], [value])

    def pass_time(self, before: int | None) -> None:
        """All values before this instant have been added: write them. None: the run is over."""
        blocks = self._pending.before(before)
        if not blocks:
            return
        if self._thread is not None:
            try:
                self._thread.put(blocks)
            except queue.Full:
                self._fail(TooSlowError(None, "the disk is slower than the run"))
        else:
            self._write(blocks)

    def _write(self, blocks: Sequence[Block]) -> None:
        if self._listener is not None:
            self._listener.show(blocks)
        if self._writer is None or self.problem is not None:
            return
        try:
            for piece in in_pieces(blocks):
                self._write_most(self._writer, piece)
        except OSError as problem:
            self._fail(problem)

    def _write_most(self, writer: Writer, piece: Sequence[Block]) -> None:
        """Write a piece; if there is no room for it, as much of it as there is room for, and raise OSError."""
        try:
            writer.write(piece)
        except OSError:
            halves = halved(piece) if writer.can_retry else None
            if halves is None:
                raise
            for half in halves:
                self._write_most(writer, half)
        else:
            self._written = max(int(block.time[-1]) for block in piece)

    def _fail(self, problem: OSError) -> None:
        if self._writer is not None and self.problem is None:
            self.problem = problem
            self._on_problem(problem, self._written)

    def finish(self, ended: str, time: int, releases: Sequence[tuple[int, str, object]]) -> None:
        """The run ended at this instant; ``releases`` are the safe values that outputs were set to, which are recorded
        if they changed something.
        """
        for instant, channel, value in releases:
            position = self.positions.get(channel)
            last = None if position is None else self._pending.last.get(position)
            if position is None or last is None:
                continue
            kind = self.head.ports[position].type
            new = array_of([value], kind)
            if any(leaf(new[0], path) != leaf(last[0], path) for _, _, path in leaves("", kind)):
                self.add_noted(channel, [instant], [value])
        self.pass_time(None)
        if self._thread is not None:
            self._thread.end()
        if self._listener is not None:
            self._listener.close()
        if self._writer is None:
            return
        if self.problem is None:
            try:
                self._writer.close(ended, time)
                return
            except OSError as problem:
                self._fail(problem)
        self._leave()

    @property
    def is_empty(self) -> bool:
        """Whether no port has had a value: the parameters at the beginning of a run are none."""
        return all(self.head.ports[position].direction == "parameter" for position in self._pending.last)

    def discard(self) -> None:
        """There was no run: leave no file, and one that was there before as it was."""
        if self._thread is not None:
            self._thread.end()
        if self._listener is not None:
            self._listener.close()
        if self._writer is not None:
            self._writer.discard()

    def break_off(self) -> bool:
        """The run cannot say how it ended: leave what it has passed, and say whether that is anything."""
        if self.is_empty:
            self.discard()
            return False
        self.pass_time(None)
        if self._thread is not None:
            self._thread.end()
        if self._listener is not None:
            self._listener.close()
        self._leave()
        return self._writer is not None

    def abandon(self) -> None:
        """The end of the run was not waited for: leave what is there."""
        self._leave()

    def _leave(self) -> None:
        try:
            if self._writer is not None:
                self._writer.abandon()
        except OSError:
            return  # Why it cannot be written is known already.


class _Thread:
    """Writes blocks, one after the other."""

    def __init__(self, write: Callable[[Sequence[Block]], None]) -> None:
        self._write = write
        self._queue: queue.Queue[Sequence[Block] | None] = queue.Queue(_MOST_WAITING)
        self._thread = threading.Thread(target=self._work, name="recording", daemon=True)
        with left_to_the_main_thread():
            self._thread.start()

    def put(self, blocks: Sequence[Block]) -> None:
        """Write these later. Raises queue.Full."""
        self._queue.put_nowait(blocks)

    def end(self) -> None:
        """Wait until all is written."""
        self._queue.put(None)
        self._thread.join()

    def _work(self) -> None:
        while (blocks := self._queue.get()) is not None:
            self._write(blocks)
