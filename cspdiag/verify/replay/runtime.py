"""The runtime of a replay: the same channels and alternatives, with a gate before each use of them, and an environment
that offers what the trace says.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Generator, Mapping, Sequence
from types import ModuleType, coroutine
from typing import Any, assert_never

import cspdiag.runtime as runtime
from cspdiag.runtime.channels.any_channel import AnyChannel
from cspdiag.runtime.channels.broadcast import Broadcast, BroadcastEnd
from cspdiag.runtime.channels.buffers import Buffer, Overwriting
from cspdiag.runtime.channels.channel import Channel
from cspdiag.runtime.channels.ports import In, Out, Owner, T
from cspdiag.runtime.channels.selector import Selector
from cspdiag.runtime.channels.variable import Constant, Discard, Variable
from cspdiag.runtime.choice.alternative import Alternative
from cspdiag.runtime.choice.guards import After, Guard, Input, Output, Ready, Skip
from cspdiag.runtime.choice.together import read_all, write_all
from cspdiag.runtime.composition import Branches
from cspdiag.runtime.kernel.exceptions import Cancelled
from cspdiag.runtime.kernel.scheduler import Party, scheduler
from cspdiag.runtime.process import Process
from cspdiag.verify.replay.gates import Interruption, Option, conductor

__package__ = Process.__module__.rpartition(".")[0]
"""That of the runtime: places of processes are looked for outside of it."""

_NOTHING: Mapping[int, Any] = {}


class _GatedIn:
    """An end that is read through a gate."""

    name: str

    @coroutine
    def read(self) -> Generator[None, None, Any]:
        """See ``In.read``."""
        yield from conductor.hold(Option("read", self.name))
        return (yield from self.read_now())

    def read_now(self) -> Generator[None, None, Any]:
        """The read itself."""
        value = yield from super().read()  # type: ignore[misc]
        conductor.done.append(("read", self.name))
        return value


class _GatedOut:
    """An end that is written through a gate."""

    name: str

    @coroutine
    def write(self, value: Any, /) -> Generator[None, None, None]:
        """See ``Out.write``."""
        yield from conductor.hold(Option("write", self.name, value=value))
        yield from self.write_now(value)

    def write_now(self, value: Any) -> Generator[None, None, None]:
        """The write itself."""
        yield from super().write(value)  # type: ignore[misc]
        conductor.done.append(("write", self.name))


class _Channel(_GatedIn, _GatedOut, Channel[T]):
    pass


class _AnyChannel(_GatedIn, _GatedOut, AnyChannel[T]):
    pass


class _Buffer(_GatedIn, _GatedOut, Buffer[T]):
    pass


class _Overwriting(_GatedIn, _GatedOut, Overwriting[T]):
    pass


class _BroadcastEnd(_GatedIn, BroadcastEnd[T]):
    pass


class _Broadcast(_GatedOut, Broadcast[T]):
    def reader(self, owner: Owner | None = None) -> BroadcastEnd[T]:
        end: _BroadcastEnd[T] = _BroadcastEnd(self, "" if owner is None else owner.name)
        self._ends.append(end)
        self.readers_changed()
        return end if owner is None else owner.owns(end)


class _OfferedInput(_GatedIn, In[T]):
    """An input of the outermost process: has what the conductor supplies."""

    def __init__(self, name: str, **_: Any) -> None:
        self.name = name

    def read_now(self) -> Generator[None, None, Any]:
        if conductor.free:
            scheduler.current.waiting = self
            yield
        return self.take()

    def request(self, party: Party) -> bool:
        if not conductor.free:
            party.received = self.take()
        return not conductor.free

    def withdraw(self, party: Party) -> bool:
        return True

    def take(self) -> Any:
        conductor.done.append(("read", self.name))
        value = conductor.took(scheduler.current, self.name)
        if isinstance(value, BaseException):
            raise value
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, None, scheduler.current)
        return value

    def watch_input(self, selector: Selector, bit: int) -> None:
        selector.ready |= bit
        conductor.ready_bits.append((selector, bit))

    def unwatch_input(self, selector: Selector) -> None:
        pass


class _TakingOutput(_GatedOut, Out[T]):
    """An output of the outermost process: the environment takes everything."""

    def __init__(self, name: str, **_: Any) -> None:
        self.name = name

    def offer(self, party: Party, value: Any, /) -> bool:
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, party, None)
        return True

    def withdraw(self, party: Party) -> bool:
        return False

    def watch_output(self, selector: Selector, bit: int) -> None:
        selector.ready |= bit

    def unwatch_output(self, selector: Selector) -> None:
        pass


class _Alternative(Alternative):
    @coroutine
    def select(
        self,
        enabled: Sequence[bool] | None = None,
        *,
        values: Mapping[int, Any] = _NOTHING,
        delays: Mapping[int, int] = _NOTHING,
    ) -> Generator[None, None, int]:
        options = [
            _option(guard, index, values.get(index))
            if index not in delays
            else Option("after", "", index, delays[index])
            for index, guard in enumerate(self.guards)
            if enabled is None or enabled[index]
        ]
        chosen = yield from conductor.hold(*options)
        if chosen is None:
            return (yield from Alternative.select(self, enabled, values=values, delays=delays))
        only = [index == chosen.index for index in range(len(self.guards))]
        index = yield from Alternative.select(self, only, values=values, delays={**delays, chosen.index: 0})
        conductor.done.append((chosen.action, chosen.channel))
        return index


def _option(guard: Guard, index: int, value: Any = None) -> Option:
    match guard:
        case (
            Input(end=Constant() | Variable()) | Ready(end=Constant() | Variable()) | Output(end=Discard() | Variable())
        ):
            return Option("skip", "", index)
        case Input(end=end):
            return Option("read", end.name, index)
        case Ready(end=end):
            return Option("ready", end.name, index)
        case Output(end=end):
            return Option("write", end.name, index, value=value)
        case After(duration=duration):
            return Option("after", "", index, duration)
        case Skip():
            return Option("skip", "", index)
        case _:
            assert_never(guard)


@coroutine
def _interrupt(
    body: Awaitable[object], guard: Guard, handler: Callable[[], Awaitable[object]]
) -> Generator[None, None, None]:
    task = scheduler.current
    if task.cancelled:
        raise Cancelled
    branches = Branches(task)
    branches.start((body,))
    fired = noted = False

    def abandon() -> None:
        nonlocal fired
        fired = True
        branches.tasks[0].cancel()

    def fire() -> None:
        nonlocal noted
        noted = True
        conductor.note(task, interruption.options[0])
        abandon()

    interruption = Interruption(task, (_option(guard, 0),), fire, abandon)
    conductor.interruptions.append(interruption)
    try:
        yield from branches.wait()
    finally:
        conductor.interruptions.remove(interruption)
    if not fired:
        return
    if isinstance(guard, Input | Output):
        # An abandoned body leaves a guard that waits for its turn as any other does.
        alternative = Alternative(guard) if noted else _Alternative(guard)
        yield from alternative.select()
        if isinstance(guard, Input):
            guard.value = alternative.value
    if noted:
        conductor.done.append((interruption.options[0].action, interruption.options[0].channel))
    yield from handler().__await__()


@coroutine
def _wait(duration: int) -> Generator[None, None, None]:
    yield from conductor.hold(Option("wait", duration=duration))
    if conductor.free and duration > 0:
        yield
    conductor.done.append(("wait", ""))


@coroutine
def _read_all(*ends: In[Any]) -> Generator[None, None, tuple[Any, ...]]:
    """As ``read_all``, in the order that the trace has."""
    values: dict[int, Any] = {}
    pending = dict(enumerate(ends))
    for position, end in enumerate(ends):
        if not isinstance(end, _GatedIn):
            values[position] = yield from pending.pop(position).read()
    while pending:
        options = [Option("read", end.name, position) for position, end in pending.items()]
        chosen = yield from conductor.hold(*options, together=True)
        if chosen is None:
            rest = yield from read_all(*pending.values())
            values.update(zip(pending, rest, strict=True))
            break
        end = pending.pop(chosen.index)
        assert isinstance(end, _GatedIn)
        values[chosen.index] = yield from end.read_now()
    return tuple(values[position] for position in range(len(ends)))


@coroutine
def _write_all(*outputs: tuple[Out[Any], Any]) -> Generator[None, None, None]:
    """As ``write_all``, in the order that the trace has."""
    pending = dict(enumerate(outputs))
    for position, (end, value) in enumerate(outputs):
        if not isinstance(end, _GatedOut):
            del pending[position]
            yield from end.write(value)
    while pending:
        options = [Option("write", end.name, position, value=value) for position, (end, value) in pending.items()]
        chosen = yield from conductor.hold(*options, together=True)
        if chosen is None:
            yield from write_all(*pending.values())
            break
        end, value = pending.pop(chosen.index)
        assert isinstance(end, _GatedOut)
        yield from end.write_now(value)


class _Input(_OfferedInput[T]):
    def reader(self, owner: Any = None) -> In[T]:
        return _OfferedInput(self.name)


def replaying_runtime() -> ModuleType:
    """A module that stands for ``cspdiag.runtime`` in the package that is replayed."""
    module = ModuleType("cspdiag.simulate.replaying_runtime")
    module.__dict__.update(
        {name: getattr(runtime, name) for name in runtime.__all__},
        Alternative=_Alternative,
        AnyChannel=_AnyChannel,
        Broadcast=_Broadcast,
        Buffer=_Buffer,
        Channel=_Channel,
        EventInput=_Input,
        EventOutput=_TakingOutput,
        Overwriting=_Overwriting,
        SampledInput=_Input,
        SampledOutput=_TakingOutput,
        interrupt=_interrupt,
        read_all=_read_all,
        wait=_wait,
        write_all=_write_all,
    )
    return module
