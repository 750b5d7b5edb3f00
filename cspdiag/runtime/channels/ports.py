"""What processes see of channels: the end to read from and the end to write to.

``read`` and ``write`` are for processes. The other operations belong to the runtime: through them alternatives,
submodels and interrupts work with ends of every kind.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from types import coroutine
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from ..kernel.exceptions import Cancelled
from ..kernel.party import Party, Waits
from ..kernel.policy import Option, compute_first
from ..kernel.scheduler import hold, present

if TYPE_CHECKING:
    from .alternating import Alternating
    from .selector import Selector

T = TypeVar("T")
E = TypeVar("E", bound="AnyIn")
T_co = TypeVar("T_co", covariant=True)
T_contra = TypeVar("T_contra", contravariant=True)


class Owner(Protocol):
    """What reading ends need from their process."""

    name: str

    @property
    def ends(self) -> Sequence[AnyIn]:
        """Its reading ends, closed when it ends."""
        ...

    def owns(self, end: E) -> E:
        """Registers ``end`` to be closed when this process ends."""
        ...


class In(Generic[T_co]):
    """An end to read from."""

    __slots__ = ()

    name: str

    @property
    def collectable(self) -> bool:
        """Whether there is something for a waiting party of which it has not been notified yet."""
        return False

    @coroutine
    def read(self) -> Generator[None, None, T_co]:
        """One communication: waits for a value and takes it."""
        scheduler = present()
        policy = scheduler.policy
        if policy is not None:
            yield from hold(policy, Option("read", self.name))
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        if not self.request(task):
            task.waiting = self
            yield
            scheduler.current = task
            while not self.collect(task):
                yield
                scheduler.current = task
        if policy is not None:
            policy.did(task, Option("read", self.name))
        return task.received  # type: ignore[no-any-return]

    def reader(self, owner: Owner | None = None) -> In[T_co]:
        """The end that ``owner`` reads from; it is closed when ``owner`` ends.

        Ends of broadcasts and of external ports keep state for their reader, so every process makes its own.
        """
        return self

    def close(self) -> None:
        """The process that owns this end has ended."""

    def request(self, party: Party) -> bool:
        """A plain read: True if ``party.received`` is the value; False if the party waits for it."""
        raise NotImplementedError

    def collect(self, party: Party) -> bool:
        """For a party that was readied: True if ``party.received`` is the value; False if it waits again."""
        return True

    def withdraw(self, party: Party) -> bool:
        """Removes a waiting party; False if it no longer waits here."""
        raise NotImplementedError

    def waits_for(self, party: Party) -> Waits:
        """What a waiting party waits for."""
        return (("to read", self),)

    def watch_input(self, selector: Selector, bit: int) -> None:
        """Keeps ``bit`` of the selector set while a guard on this end is ready."""
        raise NotImplementedError

    def unwatch_input(self, selector: Selector) -> None:
        """Ends what ``watch_input`` began."""
        raise NotImplementedError

    def take(self) -> T_co:
        """An input guard on this end was chosen: the value."""
        raise NotImplementedError

    def settle_input(self) -> None:
        """A ``Ready`` guard on this end was chosen: the process is going to read."""

    def enroll_input(self, choice: Alternating, index: int) -> None:
        """An alternative begins to wait with a guard on this end."""

    def dismiss_input(self, choice: Alternating) -> None:
        """The alternative no longer waits."""


class Out(Generic[T_contra]):
    """An end to write to."""

    __slots__ = ()

    name: str

    @coroutine
    def write(self, value: T_contra, /) -> Generator[None, None, None]:
        """One communication: continues when the value has been taken."""
        scheduler = present()
        policy = scheduler.policy
        if policy is not None:
            compute_first(policy, scheduler.current.process)
            yield from hold(policy, Option("write", self.name, value=value))
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        if not self.offer(task, value):
            task.waiting = self
            yield
        if policy is not None:
            policy.did(task, Option("write", self.name, value=value))

    def offer(self, party: Party, value: T_contra, /) -> bool:
        """A plain write: True if the writer may continue; False if the party waits."""
        raise NotImplementedError

    def withdraw(self, party: Party) -> bool:
        """Removes a waiting party; False if it no longer waits here."""
        raise NotImplementedError

    def waits_for(self, party: Party) -> Waits:
        """What a waiting party waits for."""
        return (("to write", self),)

    def watch_output(self, selector: Selector, bit: int) -> None:
        """Keeps ``bit`` of the selector set while an output guard on this end is ready."""
        raise NotImplementedError

    def unwatch_output(self, selector: Selector) -> None:
        """Ends what ``watch_output`` began."""
        raise NotImplementedError

    def choose_output(self, party: Party, value: T_contra, /) -> bool:
        """An output guard was chosen: like ``offer``, but the partner may also be an alternative."""
        return self.offer(party, value)

    def enroll_output(self, choice: Alternating, index: int) -> None:
        """An alternative begins to wait with an output guard on this end."""

    def dismiss_output(self, choice: Alternating) -> None:
        """The alternative no longer waits."""


AnyIn = In[Any]
AnyOut = Out[Any]
