"""The runtime of a guided run: that of every run, where a guide is told what tasks do and asked what is left open.

Left open are which of the guards of ``[]`` that are ready is taken, and how long a submodel computes.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Generator, Mapping, Sequence
from types import ModuleType, coroutine
from typing import Any, Protocol, assert_never

import cspdiag.runtime as runtime
from cspdiag.runtime.channels.broadcast import Broadcast
from cspdiag.runtime.channels.buffers import Buffer, Overwriting
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.channels.ports import Out, T
from cspdiag.runtime.channels.variable import Constant, Discard, Variable
from cspdiag.runtime.choice.alternative import Alternative
from cspdiag.runtime.choice.guards import After, Guard, Input, Output, Ready, Skip
from cspdiag.runtime.choice.interrupt import interrupt
from cspdiag.runtime.choice.together import write_all
from cspdiag.runtime.composition import wait
from cspdiag.runtime.kernel.exceptions import Cancelled, Timeout
from cspdiag.runtime.kernel.scheduler import Party, scheduler
from cspdiag.runtime.outside.external import EventOutput, SampledOutput
from cspdiag.runtime.outside.inputs import EventEnd, EventInput, SampledEnd, SampledInput, _Pace
from cspdiag.runtime.process import Process, Submodel

__package__ = Process.__module__.rpartition(".")[0]
"""That of the runtime: places of processes are looked for outside of it."""

_NOTHING: Mapping[int, Any] = {}
_SILENT_ENDS = Constant, Variable, Discard


class Guide(Protocol):
    """What knows where a run is to lead."""

    def did(self, party: Party, action: str, channel: str = "", index: int = 0, duration: int = 0) -> None:
        """A task has communicated, or come to the end of a delay, or taken a guard that nobody else takes part in."""
        ...

    def wrote(self, channel: str, value: Any, writer: Party) -> None:
        """A value was written to an output of the outermost process."""
        ...

    def pick(self, guards: Sequence[tuple[int, str, str]]) -> int:
        """Which of the guards that are ready the current task takes: index, action and channel of each, in the order
        that is fair.
        """
        ...

    def preferred(self, chosen: tuple[int, str, str], ready: Sequence[tuple[int, str, str]]) -> None:
        """The current task takes the first of the guards that are ready, in the order of the text."""
        ...

    def arrives(self) -> None:
        """The current task comes to an alternative: what it wants from outside may be there just before."""
        ...

    def compute(self) -> None:
        """The current task computes: time may pass."""
        ...


class _Guidance:
    """The guide of the one run that there is at a time."""

    guide: Guide


guidance = _Guidance()


class _Alternative(Alternative):
    @coroutine
    def select(
        self,
        enabled: Sequence[bool] | None = None,
        *,
        values: Mapping[int, Any] = _NOTHING,
        delays: Mapping[int, int] = _NOTHING,
    ) -> Generator[None, None, int]:
        if scheduler.current.cancelled:
            raise Cancelled
        guidance.guide.arrives()
        mask = self._all if enabled is None else sum(1 << index for index, holds in enumerate(enabled) if holds)
        ready = self.selector.ready & mask
        if self.after_guards:
            ready |= self.time_outs_passed(mask, delays)
        if not ready:
            ready = yield from self.wait(mask, values, delays)
            if not ready:
                return self.chosen
        index = self._chosen(ready, delays)
        if not self.communicate(index, values):
            yield
        return index

    def _chosen(self, ready: int, delays: Mapping[int, int]) -> int:
        found = [described(guard, index) for index, guard in enumerate(self.guards) if ready >> index & 1]
        if self._prioritized:
            index, action, channel = found[0]
            guidance.guide.preferred(found[0], found)
        else:
            later = [entry for entry in found if self.after_last >> entry[0] & 1]
            index = guidance.guide.pick(later + [entry for entry in found if entry not in later])
            _, action, channel = next(entry for entry in found if entry[0] == index)
            self.after_last = -1 << (index + 1)
        if not channel:
            duration = delays.get(index, duration_of(self.guards[index]))
            guidance.guide.did(scheduler.current, action, "", index, duration)
        return index


def described(guard: Guard, index: int) -> tuple[int, str, str]:
    """A guard as index, action and channel; without a channel nobody else takes part."""
    match guard:
        case After():
            return index, "after", ""
        case Input(end=end) | Ready(end=end) if not isinstance(end, _SILENT_ENDS):
            return index, "read", end.name
        case Output(end=end) if not isinstance(end, _SILENT_ENDS):
            return index, "write", end.name
        case Input() | Ready() | Output() | Skip():
            return index, "skip", ""
        case _:
            assert_never(guard)


def duration_of(guard: Guard) -> int:
    """How long a time-out lasts; 0 for other guards."""
    return guard.duration if isinstance(guard, After) else 0


class _Computed:
    """An end before whose write a submodel has computed."""

    __slots__ = ()

    @coroutine
    def write(self, value: Any, /) -> Generator[None, None, None]:
        """See ``Out.write``."""
        _compute_first()
        yield from super().write(value)  # type: ignore[misc]


def _compute_first() -> None:
    process = scheduler.current.process
    if isinstance(process, _Submodel) and not process.has_computed:
        process.has_computed = True
        guidance.guide.compute()


class _Submodel(Submodel):
    has_computed = False

    async def execute(self) -> None:
        self.has_computed = False
        await super().execute()
        if not self.has_computed:
            guidance.guide.compute()


class _Channel(_Computed, Channel[T]):
    pass


class _AnyChannel(_Computed, runtime.AnyChannel[T]):
    pass


class _Buffer(_Computed, Buffer[T]):
    def take(self) -> T:
        guidance.guide.did(scheduler.current, "read", self.name)
        return super().take()

    def _enter(self, value: T, writer: Party) -> None:
        reader = self._reader
        super()._enter(value, writer)
        if reader is not None:
            guidance.guide.did(reader, "read", self.name)


class _Overwriting(_Buffer[T], Overwriting[T]):
    pass


class _Broadcast(_Computed, Broadcast[T]):
    def offer(self, party: Party, value: T, /) -> bool:
        guidance.guide.did(party, "write", self.name)
        return super().offer(party, value)


class _EventOutput(_Computed, EventOutput[T]):
    def offer(self, party: Party, value: T, /) -> bool:
        super().offer(party, value)
        guidance.guide.wrote(self.name, value, party)
        return True


class _SampledOutput(_Computed, SampledOutput[T]):
    def offer(self, party: Party, value: T, /) -> bool:
        super().offer(party, value)
        guidance.guide.wrote(self.name, value, party)
        return True


class _SampledEnd(SampledEnd[T]):
    def taken(self, reader: Party) -> T:
        try:
            return super().taken(reader)
        except Timeout:
            guidance.guide.did(reader, "miss", self.name)
            raise


class _SampledInput(SampledInput[T]):
    def reader(self, owner: Any = None) -> SampledEnd[T]:
        end: SampledEnd[T] = _SampledEnd(self, _Pace() if owner is None else self._pace_of(owner))
        self.ends.append(end)
        return end if owner is None else owner.owns(end)


class _EventInput(EventInput[T]):
    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self.owners: list[str] = []

    def reader(self, owner: Any = None) -> EventEnd[T]:
        end = super().reader(owner)
        self.owners.append("" if owner is None else owner.name)
        return end

    def end_of(self, path: str) -> EventEnd[T]:
        """The end at which a process inside ``path``, or that process, reads."""
        if self.kind != "broadcast":
            return self.ends[-1]
        fitting = [number for number, owner in enumerate(self.owners) if f"{path}.".startswith(f"{owner}.")]
        return self.ends[max(fitting, key=lambda number: len(self.owners[number]), default=-1)]


@coroutine
def _wait(duration: int) -> Generator[None, None, None]:
    task = scheduler.current
    yield from wait(duration)
    guidance.guide.did(task, "wait", duration=duration)


@coroutine
def _write_all(*outputs: tuple[Out[Any], Any]) -> Generator[None, None, None]:
    _compute_first()
    yield from write_all(*outputs)


@coroutine
def _interrupt(
    body: Awaitable[object], guard: Guard, handler: Callable[[], Awaitable[object]]
) -> Generator[None, None, None]:
    task = scheduler.current
    _, action, channel = described(guard, 0)

    def handled() -> Awaitable[object]:
        if not channel:
            guidance.guide.did(task, action, duration=duration_of(guard))
        return handler()

    yield from interrupt(body, guard, handled)


def guided_runtime() -> ModuleType:
    """A module that stands for ``cspdiag.runtime`` in the package that is run."""
    module = ModuleType("cspdiag.verify.guided.runtime")
    module.__dict__.update(
        {name: getattr(runtime, name) for name in runtime.__all__},
        Alternative=_Alternative,
        AnyChannel=_AnyChannel,
        Broadcast=_Broadcast,
        Buffer=_Buffer,
        Channel=_Channel,
        EventInput=_EventInput,
        EventOutput=_EventOutput,
        Overwriting=_Overwriting,
        SampledInput=_SampledInput,
        SampledOutput=_SampledOutput,
        Submodel=_Submodel,
        interrupt=_interrupt,
        wait=_wait,
        write_all=_write_all,
    )
    return module
