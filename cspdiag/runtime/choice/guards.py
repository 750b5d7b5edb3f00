"""Guards, and waiting for one of several to become ready.

``Choice`` is what alternatives and interrupts have in common: it registers its guards at their ends, waits, and
communicates by the guard that is chosen, either by itself or by an alternative on the other side of a channel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import Any, TypeAlias, assert_never

from ..channels.converting import Converting
from ..channels.ports import AnyIn, AnyOut
from ..channels.selector import Selector, raise_bits
from ..channels.variable import Constant, Discard, Variable
from ..kernel.durations import shown
from ..kernel.executed import Executed
from ..kernel.party import Entry, Party, ReadyQueue
from ..kernel.policy import Option
from ..kernel.scheduler import Task, present

_BEGUN = count(1)


class Ready:
    """Ready when the end has something to read, which the guarded process then begins by reading."""

    __slots__ = ("end",)

    def __init__(self, end: AnyIn) -> None:
        self.end = end

    def __str__(self) -> str:
        return self.end.name


class Input:
    """Reads the end; the value is then the ``value`` of the alternative, or of this guard if it is that of an
    interrupt.
    """

    __slots__ = ("end", "value")

    def __init__(self, end: AnyIn) -> None:
        self.end = end
        self.value: Any = None

    def __str__(self) -> str:
        return f"{self.end.name} ?"


class Output:
    """Writes the value that ``select`` was given for this guard, or else ``value``."""

    __slots__ = ("converted", "end", "value")

    def __init__(self, end: AnyOut, value: Any = None) -> None:
        self.end = end.end if isinstance(end, Converting) else end
        self.converted: Callable[[Any], Any] | None = end.converted if isinstance(end, Converting) else None
        self.value = value

    def value_among(self, values: Mapping[int, Any], index: int) -> Any:
        """What it writes as guard ``index``, if ``select`` was given ``values``."""
        value = values.get(index, self.value)
        return value if self.converted is None else self.converted(value)

    def __str__(self) -> str:
        return f"{self.end.name} !"


class After:
    """A time-out: ready when ``duration`` has passed since the alternative began."""

    __slots__ = ("duration",)

    def __init__(self, duration: int = 0) -> None:
        self.duration = duration

    def __str__(self) -> str:
        return f"after {shown(self.duration)}"


class Skip:
    """Always ready."""

    __slots__ = ()

    def __str__(self) -> str:
        return "skip"


Guard: TypeAlias = Ready | Input | Output | After | Skip


def waits_of_guard(guard: Guard) -> tuple[str, Any]:
    """An entry of ``Waits``."""
    match guard:
        case Ready(end=end) | Input(end=end):
            return "to read", end
        case Output(end=end):
            return "to write", end
        case After() | Skip():
            return str(guard), None
        case _:
            assert_never(guard)


def option_of(guard: Guard, index: int, values: Mapping[int, Any], delays: Mapping[int, int]) -> Option:
    """A guard as policies see it, with what ``select`` was given; at ends that never wait there is no partner."""
    match guard:
        case Input(end=Variable() | Constant()) | Ready(end=Variable() | Constant()) | Skip():
            return Option("skip", index=index)
        case Output(end=Variable() | Discard()):
            return Option("skip", index=index)
        case Input(end=end):
            return Option("read", end.name, index)
        case Ready(end=end):
            return Option("ready", end.name, index)
        case Output(end=end):
            return Option("write", end.name, index, value=guard.value_among(values, index))
        case After():
            return Option("after", index=index, duration=delays.get(index, guard.duration))


class _TimeOut:
    """The timer of an ``After``."""

    __slots__ = ("_bit", "_selector", "instant")

    def __init__(self, selector: Selector, bit: int, instant: int) -> None:
        self._selector = selector
        self._bit = bit
        self.instant = instant

    def due(self) -> None:
        raise_bits(((self._selector, self._bit),))


class _Pledge:
    """A writing alternative that was chosen by a ``Ready`` guard: its choice is made, but its value has not been taken
    yet.
    """

    __slots__ = ("_choice", "end", "received")

    def __init__(self, choice: Choice, end: AnyOut) -> None:
        self._choice = choice
        self.end = end
        self.received: Any = None

    @property
    def process(self) -> Executed | None:
        return self._choice.task.process

    @property
    def ready_queue(self) -> ReadyQueue:
        return self._choice.task.ready_queue

    @property
    def entry(self) -> Entry:
        return self

    def resume(self, _: None) -> None:
        self._choice.pledged = None
        self._choice.redeem()

    def __next__(self) -> None:
        self.resume(None)


class Choice:
    """Guards that wait together.

    Bits and indexes number the guards in text order. ``chosen`` is the index of the guard that the other side has
    chosen, or -1; ``mask`` are the guards that it waits with; ``value`` is what the last input guard read.
    """

    value: Any
    task: Task

    def __init__(self, guards: Sequence[Guard]) -> None:
        self.guards = tuple(guards)
        self.selector = Selector()
        self.value = None
        self.chosen = -1
        self.pledged: _Pledge | None = None
        self.woken = False
        self._values: Mapping[int, Any] = {}
        self.mask = 0
        self.began = 0
        """The alternatives that wait are numbered in the order in which they began to."""
        self._enrolled = 0
        self._time_outs: list[_TimeOut] = []
        self.after_guards = tuple((index, guard) for index, guard in enumerate(guards) if isinstance(guard, After))
        self._communicate = tuple(self._communication_of(guard) for guard in self.guards)
        for index, guard in enumerate(self.guards):
            self._watch(guard, 1 << index)

    @staticmethod
    def _communication_of(guard: Guard) -> Callable[[], Any] | None:
        match guard:
            case Input(end=end):
                return end.take
            case Ready(end=end):
                return end.settle_input
            case Output() | After() | Skip():
                return None
            case _:
                assert_never(guard)

    def _watch(self, guard: Guard, bit: int) -> None:
        match guard:
            case Input(end=end) | Ready(end=end):
                end.watch_input(self.selector, bit)
            case Output(end=end):
                end.watch_output(self.selector, bit)
            case Skip():
                self.selector.ready |= bit
            case After():
                pass

    def __del__(self) -> None:
        self.give_up()

    def give_up(self) -> None:
        """Releases the ends; the choice cannot be used again."""
        for guard in self.guards:
            match guard:
                case Input(end=end) | Ready(end=end):
                    end.unwatch_input(self.selector)
                case Output(end=end):
                    end.unwatch_output(self.selector)
                case _:  # The ends of the others are not notified.
                    pass

    def time_outs_passed(self, mask: int, delays: Mapping[int, int]) -> int:
        """The enabled time-outs that have passed before they begin."""
        passed = 0
        for index, guard in self.after_guards:
            if delays.get(index, guard.duration) <= 0:
                passed |= 1 << index
        return passed & mask

    def begin_waiting(self, task: Task, mask: int, values: Mapping[int, Any], delays: Mapping[int, int]) -> None:
        """From now on the first enabled guard that becomes ready wakes the choice."""
        selector = self.selector
        for index, guard in self.after_guards:
            if mask >> index & 1:
                scheduler = task.scheduler
                time_out = _TimeOut(selector, 1 << index, scheduler.now + delays.get(index, guard.duration))
                scheduler.timers.begin(time_out.instant, time_out)
                self._time_outs.append(time_out)
        self.begin_waiting_alone(task, mask, values)
        attended = self._enrolled = selector.attend & mask
        while attended:
            bit = attended & -attended
            attended ^= bit
            self._enroll(bit.bit_length() - 1)

    def begin_waiting_alone(self, task: Task, mask: int, values: Mapping[int, Any]) -> None:
        """``begin_waiting`` for guards none of which is a time-out and whose ends need not be notified."""
        self.task = task
        self.mask = mask
        self.chosen = -1
        self.began = next(_BEGUN)
        self._values = values
        selector = self.selector
        selector.waiting = self
        selector.armed = mask

    def enroll_late(self, bit: int) -> None:
        """The process at the other side of a guard begins to alternate while this choice already waits."""
        if self.mask & bit & ~self._enrolled:
            self._enrolled |= bit
            self._enroll(bit.bit_length() - 1)

    def _enroll(self, index: int) -> None:
        match self.guards[index]:
            case Input(end=end) | Ready(end=end):
                end.enroll_input(self, index)
            case Output(end=end):
                end.enroll_output(self, index)
            case _:  # The ends of the others are not notified.
                pass

    def end_waiting(self) -> None:
        """Removes the choice from all its ends."""
        selector = self.selector
        selector.waiting = None
        selector.armed = 0
        if not self._enrolled and not self.after_guards:
            return
        for time_out in self._time_outs:
            self.task.scheduler.timers.stop(time_out.instant, time_out)
        self._time_outs.clear()
        for index, _ in self.after_guards:
            selector.ready &= ~(1 << index)
        enrolled = self._enrolled
        self._enrolled = 0
        while enrolled:
            bit = enrolled & -enrolled
            enrolled ^= bit
            match self.guards[bit.bit_length() - 1]:
                case Input(end=end) | Ready(end=end):
                    end.dismiss_input(self)
                case Output(end=end):
                    end.dismiss_output(self)
                case _:  # The ends of the others are not notified.
                    pass

    def wake(self) -> None:
        """A first guard has become ready, or the other side has chosen."""
        if not self.woken:
            self.woken = True
            self.task.ready_queue.append(self.task.entry)

    def communicate(self, index: int, values: Mapping[int, Any]) -> bool:
        """Communicates by a guard that is ready; False if the task still has to wait in the channel."""
        guard = self.guards[index]
        if isinstance(guard, Output):
            task = present().current
            task.waiting = guard.end
            return guard.end.choose_output(task, guard.value_among(values, index))
        communicate = self._communicate[index]
        if communicate is not None:
            self.value = communicate()
        return True

    def value_offered(self, index: int) -> Any:
        """The value of an output guard, for the other side."""
        guard = self.guards[index]
        assert isinstance(guard, Output)
        return guard.value_among(self._values, index)

    def only_promises(self, index: int) -> bool:
        """Whether choosing the guard leaves the communication to the guarded process."""
        return isinstance(self.guards[index], Ready)

    def resolve(self, index: int, value: Any) -> None:
        """The other side has chosen guard ``index`` and has communicated."""
        self.end_waiting()
        self.chosen = index
        self.value = value
        self.wake()

    def redeem(self) -> None:
        """The value that was promised has been read: the task continues."""
        self.task.scheduler.current = self.task
        next(self.task.entry)

    def pledge(self, index: int) -> Party:
        """The other side has chosen output guard ``index`` and will read later; the party waits for that."""
        self.end_waiting()
        self.chosen = index
        guard = self.guards[index]
        assert isinstance(guard, Output)
        self.pledged = _Pledge(self, guard.end)
        return self.pledged
