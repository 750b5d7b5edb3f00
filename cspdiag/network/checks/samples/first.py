"""The beginning of the outermost process, executed as long as it is deterministic: there the instants of samples are
known.

It starts at time 0. A first read waits for the next sample, unless the process already follows that period; a process
that reads two periods after the last sample that it took has missed one. As soon as anything else matters (data,
events, partners, parallel parts) nothing more is reported.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.model.sampling import Sampling
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.possible import decided
from cspdiag.network.infer.waiting import known_duration, samples_of
from cspdiag.network.ir import actions as ir
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key

_STEPS = 200
"""The largest number of steps that are executed, in loops too."""


@record
class Late:
    """A missed sample of ``port``: the nanoseconds since its last read, and the cause of most of them, waiting for
    ``slower`` if that was a read.
    """

    port: Key
    earlier: Span
    read: Span
    waits: int
    cause: Span
    slower: Key | None


@record
class _Step:
    """A step that took time."""

    waits: int
    span: Span
    port: Key | None


class _UndecidedError(Exception):
    """The next step is not known."""


class _CutOffError(Exception):
    """A time-out has occurred."""


class _MissedError(Exception):
    def __init__(self, late: Late) -> None:
        super().__init__()
        self.late = late


def first_late(placed: Placed, body: ir.CoreAction) -> Late | None:
    """The first sample that every run of an outermost process misses, as far as that is known without data."""
    try:
        _KnownBeginning(placed).do(body)
    except _MissedError as missed:
        return missed.late
    except (_UndecidedError, _CutOffError):
        pass
    return None


class _KnownBeginning:
    def __init__(self, placed: Placed) -> None:
        self.placed = placed
        self.now = 0
        self.left = _STEPS
        self.ends: tuple[int, ...] = ()
        """The instants of the time-outs that end the present actions."""
        self.opened: dict[Sampling, int] = {}
        """The instant at which the first session was opened, by sample instants."""
        self.taken: dict[Key, tuple[int, int, Span, int]] = {}
        """For each input the tick of the sample that was taken last, when and where that was, and the number of steps
        then.
        """
        self.steps: list[_Step] = []

    def do(self, action: ir.CoreAction) -> None:
        self.left -= 1
        if not self.left:
            raise _UndecidedError
        match action:
            case ir.ReadValue():
                self._read(end_key(action.source), action.span)
            case ir.WaitStep():
                waits = known_duration(self.placed, action.duration)
                if not waits:
                    raise _UndecidedError
                self._pass(waits, action.span, None)
            case ir.SkipStep():
                pass
            case ir.SequentialSteps():
                self._all(action.steps)
            case ir.Group():
                self.do(action.body)
            case ir.CountedLoop():
                for _ in range(action.iterations):
                    self.do(action.body)
            case ir.Repeat():
                while True:
                    self.do(action.body)
                    if action.until is None:
                        continue
                    ends = decided(self.placed, action.until)
                    if ends is None:
                        raise _UndecidedError
                    if ends:
                        return
            case ir.InterruptOn():
                self._interrupt(action)
            case _:
                raise _UndecidedError

    def _all(self, steps: Sequence[ir.CoreAction]) -> None:
        for step in steps:
            self.do(step)

    def _interrupt(self, action: ir.InterruptOn[ir.CoreAction]) -> None:
        event = action.branch.event
        waits = known_duration(self.placed, event.duration) if isinstance(event, ir.AfterEvent) else 0
        if not waits or not decided(self.placed, action.branch.condition) or self.ends:
            raise _UndecidedError
        self.ends = (self.now + waits,)
        try:
            self.do(action.body)
        except _CutOffError:
            self.ends = ()
            self.do(action.branch.body)
        self.ends = ()

    def _pass(self, waits: int, span: Span, port: Key | None) -> None:
        then = self.now + waits
        for end in self.ends:
            if then == end:
                raise _UndecidedError
            if then > end:
                self.steps.append(_Step(end - self.now, span, port))
                self.now = end
                raise _CutOffError
        self.now = then
        self.steps.append(_Step(waits, span, port))

    def _read(self, key: Key, span: Span) -> None:
        samples = samples_of(self.placed, key)
        if samples is None:
            raise _UndecidedError
        period = samples.period
        present = samples.latest_tick(self.now)
        if key not in self.taken:
            opened = self.opened.setdefault(samples, self.now)
            if present == samples.latest_tick(opened):
                present += period
                if any(end <= present for end in self.ends):
                    raise _UndecidedError
        else:
            last, when, earlier, steps = self.taken[key]
            if present > last + period:
                longest = max(self.steps[steps:], key=lambda step: step.waits)
                raise _MissedError(
                    Late(
                        key, earlier, span, self.now - when, longest.span, longest.port if longest.port != key else None
                    )
                )
            present = last + period
        if present > self.now:
            self._pass(present - self.now, span, key)
        self.taken[key] = present, self.now, span, len(self.steps)
