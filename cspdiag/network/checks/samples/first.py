"""The beginning of the outermost process, stepped through as far as nothing in it is left open: there it is known when
each sample comes.

It starts at time 0. A first read waits for the next sample, unless the process follows that period already; a process
that comes two periods after the sample that was read last has missed one. Where anything else decides (data, events,
partners, parallel parts) nothing more is reported.
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
"""How many steps are looked at, in loops too."""


@record
class Late:
    """A sample of ``port`` that is missed: nanoseconds since its last read, and what took most of them, waiting for
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
    """What took time."""

    waits: int
    span: Span
    port: Key | None


class _LeftOpenError(Exception):
    """What comes next is not known."""


class _CutOffError(Exception):
    """A time-out has come."""


class _MissedError(Exception):
    def __init__(self, late: Late) -> None:
        super().__init__()
        self.late = late


def first_late(placed: Placed, body: ir.CoreAction) -> Late | None:
    """The first sample that every run of an outermost process misses, as far as that is known without data."""
    try:
        _Beginning(placed).do(body)
    except _MissedError as missed:
        return missed.late
    except (_LeftOpenError, _CutOffError):
        pass
    return None


class _Beginning:
    def __init__(self, placed: Placed) -> None:
        self.placed = placed
        self.now = 0
        self.left = _STEPS
        self.ends: tuple[int, ...] = ()
        """When the time-outs come that end what is done now."""
        self.opened: dict[Sampling, int] = {}
        """By their sample instants, when the first books were opened."""
        self.taken: dict[Key, tuple[int, int, Span, int]] = {}
        """Of each input the tick of the sample that was taken last, when, where, and how many steps there were."""
        self.steps: list[_Step] = []

    def do(self, action: ir.CoreAction) -> None:
        self.left -= 1
        if not self.left:
            raise _LeftOpenError
        match action:
            case ir.ReadValue():
                self._read(end_key(action.source), action.span)
            case ir.WaitStep():
                waits = known_duration(self.placed, action.duration)
                if not waits:
                    raise _LeftOpenError
                self._pass(waits, action.span, None)
            case ir.SkipStep():
                pass
            case ir.SequentialSteps():
                self._all(action.steps)
            case ir.Group():
                self.do(action.body)
            case ir.CountedLoop():
                for _ in range(action.turns):
                    self.do(action.body)
            case ir.Repeat():
                while True:
                    self.do(action.body)
                    if action.until is None:
                        continue
                    ends = decided(self.placed, action.until)
                    if ends is None:
                        raise _LeftOpenError
                    if ends:
                        return
            case ir.InterruptOn():
                self._interrupt(action)
            case _:
                raise _LeftOpenError

    def _all(self, steps: Sequence[ir.CoreAction]) -> None:
        for step in steps:
            self.do(step)

    def _interrupt(self, action: ir.InterruptOn[ir.CoreAction]) -> None:
        event = action.branch.event
        waits = known_duration(self.placed, event.duration) if isinstance(event, ir.AfterEvent) else 0
        if not waits or not decided(self.placed, action.branch.condition) or self.ends:
            raise _LeftOpenError
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
                raise _LeftOpenError
            if then > end:
                self.steps.append(_Step(end - self.now, span, port))
                self.now = end
                raise _CutOffError
        self.now = then
        self.steps.append(_Step(waits, span, port))

    def _read(self, key: Key, span: Span) -> None:
        samples = samples_of(self.placed, key)
        if samples is None:
            raise _LeftOpenError
        period = samples.period
        present = samples.latest_tick(self.now)
        if key not in self.taken:
            opened = self.opened.setdefault(samples, self.now)
            if present == samples.latest_tick(opened):
                present += period
                if any(end <= present for end in self.ends):
                    raise _LeftOpenError
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
