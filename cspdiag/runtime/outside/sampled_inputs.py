"""Sampled inputs of the outermost process: a new value at each tick of a period.

Every process that reads one has an end of its own, with a session that begins when it first waits for a sample and
lasts until the process ends; within it, each sample must be taken before the next one arrives. A sample communicates
when a reader takes it.
"""

from __future__ import annotations

from collections.abc import Generator
from types import coroutine
from typing import TYPE_CHECKING, Any, Literal

from ..channels.latched import LatchedEnd, refuse_cancelled
from ..channels.ports import In, Owner, T
from ..channels.selector import Selector, lower_bits, raise_bits
from ..kernel.durations import ms, shown
from ..kernel.exceptions import Cancelled, ChannelMisuse, Timeout
from ..kernel.party import Party
from ..kernel.scheduler import Task, present
from .accepted import Accept
from .drivers import NO_SAMPLE, Driver, name_of
from .supply import Supply
from .ticks import Ticks

if TYPE_CHECKING:
    from ..channels.alternating import Alternating


_SILENT_TICKS = 10
_SILENT_TIME = 500 * ms
"""The number of ticks, and the time, without a sample after which the reader gets a Timeout."""


class _Pace:
    """The ends of one process with the same ticks, which the process *follows* from its first sample until it ends."""

    __slots__ = ("ends", "followed")

    def __init__(self) -> None:
        self.ends: list[SampledEnd[Any]] = []
        self.followed = False


class SampledEnd(LatchedEnd[T]):
    """The end of one reader of a sampled input.

    Its session begins when the reader first waits for a sample. Before that, while its process follows the ticks
    through another end, it holds the sample of the present tick, so that a first read belongs to the same instant as
    other reads of that tick.
    """

    __slots__ = ("_lacks", "_port", "begun", "overdue", "pace", "steady", "waiter")

    def __init__(self, port: SampledInput[T], pace: _Pace) -> None:
        super().__init__(port.name)
        self._port = port
        self.pace = pace
        self.begun = False
        self.overdue = False
        self.steady = False
        """Whether the next sample, and the next read, only hand a value over: its session has begun, its process
        follows the ticks, and it is not ``overdue``.
        """
        self._lacks = ""
        self.waiter: Party | None = None
        pace.ends.append(self)

    @property
    def listens(self) -> bool:
        """Whether it wants the next sample: its session has begun, or its process follows the ticks."""
        return self.begun or self.pace.followed

    def sample(self, value: T) -> None:
        """The tick: a new sample, for an end that listens."""
        if not self.begun:
            self._hold(value)
            return
        if not self.pace.followed:
            self.pace.followed = True
            for end in self.pace.ends:
                if not end.begun and end._port.latest is not NO_SAMPLE:
                    end._hold(end._port.latest)
                end._settle()
        if self.fresh:
            self.miss()
        self.value = value
        self._lacks = ""
        self._arrived()

    def _settle(self) -> None:
        """What ``steady`` and ``listens`` depend on may have changed."""
        self.steady = self.begun and self.pace.followed and not self.overdue
        self._port.sessions_changed()

    def miss(self) -> None:
        """A sample was not taken, and will not be."""
        self._port.missed += 1
        self.overdue = self._port.on_miss == "timeout"
        self._settle()

    def _arrived(self) -> None:
        self.fresh = True
        if self.waiter is not None:
            self.waiter.ready_queue.append(self.waiter.entry)
            self.waiter = None
        if self.inputs:
            raise_bits(self.inputs)

    def fall_silent(self, account: str) -> None:
        """No sample has arrived for too long: the reader gets a Timeout."""
        if not self.fresh:
            self.overdue = True
            self._settle()
            self._lacks = account
            self._arrived()

    def _hold(self, value: T) -> None:
        """Keeps the sample of the present tick for a first read; overwriting it is not a miss."""
        self.value = value
        self.fresh = True
        raise_bits(self.inputs)

    @coroutine
    def read(self) -> Generator[None, None, T]:
        """See ``In.read``: the same in fewer steps, as every sample is read by one."""
        scheduler = present()
        if scheduler.policy is not None:
            return (yield from super().read())
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        while not self.fresh:
            self.wait(task)
            yield
            scheduler.current = task
            if task.cancelled:
                raise Cancelled
        if not self.steady:
            return self.taken(task)
        self.fresh = False
        if self.inputs:
            lower_bits(self.inputs)
        value: T = self.value
        if scheduler.observe is not None:
            scheduler.observe(self.name, value, None, task)
        return value

    def request(self, party: Party) -> bool:
        """See ``In.request``. Raises Timeout if a sample was overwritten since the last read."""
        if self.fresh:
            party.received = self.taken(party)
            return True
        if self.waiter is not None:
            raise ChannelMisuse(f"one end of {self.name} is read by two processes at the same time")
        self.waiter = party
        if not self.begun:
            self._begin()
        return False

    def wait(self, task: Task) -> None:
        """For optimized code that found no sample: ``task`` waits for the next one."""
        task.waiting = self
        if self.waiter is not None:
            raise ChannelMisuse(f"one end of {self.name} is read by two processes at the same time")
        self.waiter = task
        if not self.begun:
            self._begin()

    def collect(self, party: Party) -> bool:
        """See ``In.collect``."""
        refuse_cancelled()
        return self.request(party)

    def taken(self, reader: Party) -> T:
        """The sample, which ``reader`` takes. Raises Timeout if one was overwritten before it."""
        if self.overdue:
            self.overdue = False
            self._settle()
            policy = present().policy
            if policy is not None:
                policy.took_part(reader, "miss", self.name)
            self._raise_silence()
            raise Timeout(f"a sample of {self.name} was overwritten before it had been taken")
        if not self.begun:
            self._begin()
        return self._communicated(reader)

    def _raise_silence(self) -> None:
        if self._lacks:
            account, self._lacks = self._lacks, ""
            self.fresh = False
            if self.inputs:
                lower_bits(self.inputs)
            raise Timeout(account)

    def _begin(self) -> None:
        self.begun = True
        self._settle()
        for selector, bit in self.inputs:
            selector.attend &= ~bit

    def close(self) -> None:
        """The session is over: the next read waits for the next tick again."""
        self.begun = self.fresh = self.overdue = self.pace.followed = False
        self._lacks = ""
        for end in self.pace.ends:
            end._settle()
        for selector, bit in self.inputs:
            selector.attend |= bit
            selector.ready &= ~bit

    def withdraw(self, party: Party) -> bool:
        """See ``In.withdraw``."""
        if self.waiter is not party:
            return False
        self.waiter = None
        return True

    def watch_input(self, selector: Selector, bit: int) -> None:
        """See ``In.watch_input``."""
        super().watch_input(selector, bit)
        if not self.begun:
            selector.attend |= bit

    def enroll_input(self, choice: Alternating, index: int) -> None:
        """An alternative waits for the first sample: the session begins."""
        if not self.begun:
            self._begin()


class SampledInput(In[T]):
    """A sampled input of the outermost process; ``missed`` counts samples that were overwritten before they were taken,
    or did not arrive.

    ``accepts`` converts what a driver returns to the type of the port, and refuses what it cannot convert; None: takes
    anything.
    """

    __slots__ = (
        "_silent", "accepts", "driver", "ends", "latest", "line", "listening", "missed", "name", "on_miss", "only",
        "ticks",
    )  # fmt: skip

    def __init__(
        self, name: str, *, period: int, offset: int = 0, driver: Driver | None = None, accepts: Accept | None = None
    ) -> None:
        self.name = name
        self.accepts = accepts
        self.ticks = Ticks(period, offset)
        self.driver = driver
        self.line: Any = driver
        self.ends: list[SampledEnd[T]] = []
        self.listening: list[SampledEnd[T]] | None = None
        self.only: SampledEnd[T] | None = None
        """The end that listens, if it is the only one and is ``steady``; None also if that has to be found out."""
        self._silent = 0
        """Ticks since the last sample."""
        self.missed = 0
        self.on_miss: Literal["timeout", "count"] = "timeout"
        self.latest: Any = NO_SAMPLE
        """The last sample, or NO_SAMPLE."""

    def begin(self, on_miss: Literal["timeout", "count"]) -> None:
        """A run begins."""
        self.on_miss = on_miss
        self.missed = self._silent = 0
        self.latest = NO_SAMPLE

    def reader(self, owner: Owner | None = None) -> SampledEnd[T]:
        """The end of a process, whose session lasts until the process ends."""
        if isinstance(self.driver, Supply):
            supplied: Any = self.driver.end_of(self.name)
            return supplied  # type: ignore[no-any-return]
        end: SampledEnd[T] = SampledEnd(self, _Pace() if owner is None else self._pace_of(owner))
        self.ends.append(end)
        return end if owner is None else owner.owns(end)

    def _pace_of(self, owner: Owner) -> _Pace:
        for end in owner.ends:
            if isinstance(end, SampledEnd) and end._port.ticks == self.ticks:
                return end.pace
        return _Pace()

    def sessions_changed(self) -> None:
        """Called when an end may have begun or ceased to listen or to be steady."""
        self.listening = self.only = None

    def listening_ends(self) -> list[SampledEnd[T]]:
        """The ends that listen, which it remembers in ``listening``."""
        listening = self.listening
        if listening is None:
            listening = self.listening = [end for end in self.ends if end.listens]
        return listening

    def sample(self) -> None:
        """The tick: takes the new sample for all readers."""
        if self.line is None:
            return
        value = self.line.read()
        if value is NO_SAMPLE:
            self._miss_silently()
            return
        self._silent = 0
        self.latest = value
        scheduler = present(None)
        if scheduler is not None and scheduler.port_logs:
            scheduler.note(self.name, value)
        elif scheduler is not None and scheduler.sample_log is not None:
            scheduler.sample_log.extend((scheduler.now, self.name, value))
        for end in self.listening_ends():
            end.sample(value)

    def hand_out(self, value: T) -> None:
        """Gives the sample of a simulated tick to all ends that listen."""
        for end in self.listening_ends():
            end.sample(value)
        listening = self.listening_ends()
        if len(listening) == 1 and listening[0].steady:
            (self.only,) = listening

    def skip(self) -> None:
        """A tick that has passed together with the next one: its sample is missed, and the driver is not called."""
        if self.line is not None:
            for end in self.ends:
                if end.begun:
                    end.miss()

    def _miss_silently(self) -> None:
        """A tick for which a blocking driver has brought nothing: its sample is missed, and after a while the readers
        that wait for one get a Timeout.
        """
        ends = [end for end in self.ends if end.begun]
        if not ends:
            return
        self.missed += 1
        self._silent += 1
        silence = self._silent * self.ticks.period
        if self.on_miss == "timeout" and self._silent >= _SILENT_TICKS and silence >= _SILENT_TIME:
            self._silent = 0
            for end in ends:
                end.fall_silent(
                    f"driver {name_of(self.driver)} has brought no sample of {self.name} for {shown(silence)}"
                )

    @property
    def can_have_effect(self) -> bool:
        """Whether a tick can make a process ready: a reader waits for the next sample."""
        if self.driver is None:
            return False
        for end in self.listening or self.listening_ends():
            if end.waiter is not None or (end.inputs and end.alternative_waits()):
                return True
        return False

    @property
    def awaited_end(self) -> SampledEnd[T] | None:
        """An end at which a reader or an alternative waits for a sample that will arrive, or None."""
        waiting = (end for end in self.listening_ends() if end.waiter is not None or end.alternative_waits())
        return None if self.driver is None else next(waiting, None)
