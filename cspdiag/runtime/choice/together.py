"""Several communications offered at once: how a submodel reads its inputs and writes its outputs.

They begin in port order; the task continues when the last of them is done.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from types import coroutine
from typing import TYPE_CHECKING, Any, TypeVar, overload

from ..channels.ports import AnyIn, AnyOut, In, Out
from ..channels.variable import Constant, Discard, Variable
from ..compiled.rendezvous import Rendezvous
from ..kernel.exceptions import Cancelled
from ..kernel.executed import Executed
from ..kernel.party import Entry, Party, ReadyQueue, Waits
from ..kernel.policy import Option, Policy, compute_first
from ..kernel.scheduler import Task, hold, present

if TYPE_CHECKING:
    from collections.abc import Awaitable


A = TypeVar("A")
B = TypeVar("B")
C = TypeVar("C")
D = TypeVar("D")
E = TypeVar("E")
F = TypeVar("F")
R = TypeVar("R", covariant=True)


_NOTHING: Any = object()
"""What a parked reader has received before a partner hands a value over or it collects one."""


class _Offered:
    """One communication of several that a task offers at once; as long as none of them has to wait, one object serves
    all.
    """

    __slots__ = ("_together", "end", "position", "received", "task")

    _together: _Together
    end: AnyIn | AnyOut
    position: int

    def __init__(self, task: Task) -> None:
        self.task = task
        self.received: Any = None

    def waits(self, together: _Together, position: int, end: AnyIn | AnyOut, received: Any = None) -> None:
        """Notes that it was parked at ``end``."""
        self._together = together
        self.position = position
        self.end = end
        self.received = received
        together.waiting.append(self)

    @property
    def process(self) -> Executed | None:
        return self.task.process

    @property
    def ready_queue(self) -> ReadyQueue:
        return self.task.ready_queue

    @property
    def entry(self) -> Entry:
        return self

    def resume(self, _: None) -> None:
        """The communication is done, or there is something to collect; the last one resumes the task."""
        together = self._together
        if self not in together.waiting:
            return
        self.task.scheduler.current = self.task
        if self.received is _NOTHING and isinstance(self.end, Rendezvous):
            self.received = self.end.value
        if self.received is not _NOTHING:
            together.done(self)
            return
        try:
            together.collect(self)
        except (Exception, Cancelled) as error:
            together.fail(self, error)
        if not together.waiting:
            next(self.task.entry)

    def __next__(self) -> None:
        self.resume(None)


class _Together:
    """The communications that are not done yet; ``values`` has the values of all, by position."""

    __slots__ = ("error", "task", "values", "waiting")

    def __init__(self, task: Task, values: list[Any]) -> None:
        self.task = task
        self.values = values
        self.error: BaseException | None = None
        self.waiting: list[_Offered] = []

    def collect(self, readied: _Offered) -> None:
        """Called when the task was resumed for ``readied``: takes, in port order, what else has arrived by now."""
        still = []
        for offered in self.waiting:
            if offered.received is _NOTHING:
                assert isinstance(offered.end, In)
                there = offered is readied or offered.end.collectable
                if not there or not offered.end.collect(offered):
                    still.append(offered)
                    continue
            self.values[offered.position] = offered.received
        self.waiting = still

    def done(self, offered: _Offered) -> None:
        self.values[offered.position] = offered.received
        self.waiting.remove(offered)
        if not self.waiting:
            next(self.task.entry)

    def fail(self, offered: _Offered, error: BaseException) -> None:
        """Withdraws the others; the error is raised in the task."""
        self.error = error
        self.waiting.remove(offered)
        self.give_up()

    def give_up(self) -> None:
        for offered in self.waiting:
            offered.end.withdraw(offered)
        self.waiting = []

    def wait(self) -> Generator[None, None, None]:
        """Waits for the communications that are not done."""
        self.task.waiting = self
        yield
        if self.error is not None:
            raise self.error

    def withdraw(self, party: Party) -> bool:
        """See ``Waiting.withdraw``. If all communications are done, the task is ready."""
        withdrawn = [offered.end.withdraw(offered) for offered in self.waiting]
        if not any(withdrawn):
            return False
        self.waiting = []
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        return tuple([wait for offered in self.waiting for wait in offered.end.waits_for(offered)])


if TYPE_CHECKING:

    class Values(Awaitable[R], Generator[None, None, R]):
        """Waits for values: ``await`` and ``yield from`` get them."""

    @overload
    def read_all() -> Values[tuple[()]]: ...
    @overload
    def read_all(a: In[A], /) -> Values[tuple[A]]: ...
    @overload
    def read_all(a: In[A], b: In[B], /) -> Values[tuple[A, B]]: ...
    @overload
    def read_all(a: In[A], b: In[B], c: In[C], /) -> Values[tuple[A, B, C]]: ...
    @overload
    def read_all(a: In[A], b: In[B], c: In[C], d: In[D], /) -> Values[tuple[A, B, C, D]]: ...
    @overload
    def read_all(a: In[A], b: In[B], c: In[C], d: In[D], e: In[E], /) -> Values[tuple[A, B, C, D, E]]: ...
    @overload
    def read_all(a: In[A], b: In[B], c: In[C], d: In[D], e: In[E], f: In[F], /) -> Values[tuple[A, B, C, D, E, F]]: ...
    @overload
    def read_all(*ends: AnyIn) -> Values[tuple[Any, ...]]: ...
    def read_all(*ends: AnyIn) -> Values[tuple[Any, ...]]:
        """Reads all ends at once, beginning in the given order; returns a tuple of their values."""

else:

    def read_all(*ends: AnyIn) -> Generator[None, None, tuple[Any, ...]]:
        """Reads all ends at once, beginning in the given order; returns a tuple of their values."""
        policy = present().policy
        return _read_together(ends) if policy is None else _read_by(policy, ends)


@coroutine
def _read_together(ends: Sequence[AnyIn]) -> Generator[None, None, tuple[Any, ...]]:
    task = present().current
    if task.cancelled:
        raise Cancelled
    values: list[Any] = []
    together: _Together | None = None
    offered = _Offered(task)
    try:
        for end in ends:
            if end.request(offered):
                values.append(offered.received)
            else:
                together = together or _Together(task, values)
                offered.waits(together, len(values), end, _NOTHING)
                values.append(None)
                offered = _Offered(task)
    except BaseException:
        if together is not None:
            together.give_up()
        raise
    if together is not None:
        yield from together.wait()
    return tuple(values)


@coroutine
def _read_by(policy: Policy, ends: Sequence[AnyIn]) -> Generator[None, None, tuple[Any, ...]]:
    """Like ``read_all``, in the order that a policy chooses."""
    task = present().current
    if task.cancelled:
        raise Cancelled
    values: dict[int, Any] = {}
    pending = dict(enumerate(ends))
    for position, end in enumerate(ends):
        if isinstance(end, Variable | Constant):
            values[position] = yield from pending.pop(position).read()
    while pending:
        options = [Option("read", end.name, position) for position, end in pending.items()]
        wanted = yield from hold(policy, *options, together=True)
        chosen = list(pending) if wanted is None else [wanted.index]
        read = yield from _read_together([pending.pop(position) for position in chosen])
        values.update(zip(chosen, read, strict=True))
        for position in chosen:
            policy.did(task, Option("read", ends[position].name, position))
    return tuple(values[position] for position in range(len(ends)))


@coroutine
def _write_by(policy: Policy, outputs: Sequence[tuple[Out[Any], Any]]) -> Generator[None, None, None]:
    """Like ``write_all``, in the order that a policy chooses."""
    task = present().current
    if task.cancelled:
        raise Cancelled
    compute_first(policy, task.process)
    pending = dict(enumerate(outputs))
    for position, (end, value) in enumerate(outputs):
        if isinstance(end, Variable | Discard):
            del pending[position]
            yield from end.write(value)
    while pending:
        options = [Option("write", end.name, position, value=value) for position, (end, value) in pending.items()]
        wanted = yield from hold(policy, *options, together=True)
        chosen = list(pending) if wanted is None else [wanted.index]
        yield from _write_together([pending.pop(position) for position in chosen])
        for position in chosen:
            policy.did(task, Option("write", outputs[position][0].name, position))


if TYPE_CHECKING:

    def write_all(*outputs: tuple[Out[Any], Any]) -> Values[None]:
        """Takes pairs of an end and a value, and writes all values at once, beginning in the given order; ends when all
        were taken.
        """

else:

    def write_all(*outputs: tuple[Out[Any], Any]) -> Generator[None, None, None]:
        """Takes pairs of an end and a value, and writes all values at once, beginning in the given order; ends when all
        were taken.
        """
        policy = present().policy
        return _write_together(outputs) if policy is None else _write_by(policy, outputs)


@coroutine
def _write_together(outputs: Sequence[tuple[Out[Any], Any]]) -> Generator[None, None, None]:
    task = present().current
    if task.cancelled:
        raise Cancelled
    together: _Together | None = None
    offered = _Offered(task)
    try:
        for position, (end, value) in enumerate(outputs):
            if not end.offer(offered, value):
                together = together or _Together(task, [None] * len(outputs))
                offered.waits(together, position, end)
                offered = _Offered(task)
    except BaseException:
        if together is not None:
            together.give_up()
        raise
    if together is not None:
        yield from together.wait()
