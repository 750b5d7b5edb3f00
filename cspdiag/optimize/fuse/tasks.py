"""Tasks as they are followed at compile time, and what they may wait for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from cspdiag.optimize.fuse.code import Raise
from cspdiag.optimize.fuse.media import Offer, SampledInput

if TYPE_CHECKING:
    from cspdiag.optimize.fuse.follow import Following

Key = tuple[int, ...]


class Task:
    """A branch of a parallel, or the program; ``position`` is the instruction that it is at."""

    def __init__(self, key: Key, position: int, priority: Key, parent: Branches | None) -> None:
        self.key = key
        self.position = position
        self.priority = priority
        self.parent = parent
        self.request: Request | None = None
        self.cancelled = False
        self.ended = False

    def rank(self) -> Key:
        """Priorities are compared from the outermost ``||>`` inwards, as if zeros followed."""
        rank = self.priority
        while rank and rank[-1] == 0:
            rank = rank[:-1]
        return rank

    def state(self) -> tuple[object, ...]:
        """What its future depends on."""
        return (self.key, self.position, self.cancelled, None if self.request is None else self.request.state())


class Request:
    """What a task waits for."""

    def __init__(self, world: Following, task: Task) -> None:
        self.world = world
        self.task = task
        self.done = False

    def state(self) -> tuple[object, ...]:
        """What the future depends on."""
        return (self.done,)

    def attempt(self) -> None:
        """The task runs: go on as far as possible."""

    def may_go_on(self) -> bool:
        """Whether something that it waits for is there."""
        return False

    def abandon(self) -> None:
        """The task ends here."""
        self.world.make_ready(self.task)

    def deadlines(self) -> Sequence[int]:
        """Instants at which it may go on."""
        return ()

    def finish(self) -> None:
        """It is done."""
        self.done = True
        self.world.make_ready(self.task)


class Exchange(Request):
    """Readers and writers, offered all at once."""

    def __init__(self, world: Following, task: Task) -> None:
        super().__init__(world, task)
        self.offers: list[Offer] = []

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        return (self.done, *(offer.done for offer in self.offers))

    def begin(self) -> None:
        """Offer everything."""
        begin_sessions(self.offers)
        for offer in self.offers:
            offer.medium.arrive(offer)
            self.world.notice()
        if not self.offers:
            self.finish()

    def attempt(self) -> None:
        """See ``Request.attempt``."""
        for offer in [o for o in self.offers if not o.done]:
            if isinstance(offer.medium, SampledInput):
                offer.medium.retry(offer)

    def may_go_on(self) -> bool:
        """See ``Request.may_go_on``."""
        return any(not o.done and o.medium.outside and o.medium.ready(o) for o in self.offers)

    def offer_done(self, offer: Offer) -> None:
        """The communication of an offer has been made."""
        if all(o.done for o in self.offers):
            self.finish()

    def resolve(self, offer: Offer) -> None:
        """Only guards are resolved."""
        raise AssertionError("only guards are resolved")

    def bind(self, offer: Offer) -> None:
        """Only guards are bound."""
        raise AssertionError("only guards are bound")

    def abandon(self) -> None:
        """See ``Request.abandon``."""
        for offer in self.offers:
            if not offer.done:
                offer.medium.withdraw(offer)
        super().abandon()


class Selection(Request):
    """An alternative; ``chosen`` is the branch, once there is one."""

    def __init__(self, world: Following, task: Task, name: str, prioritized: bool) -> None:
        super().__init__(world, task)
        self.name = name
        self.prioritized = prioritized
        self.offers: dict[int, Offer] = {}
        self.timeouts: dict[int, int] = {}
        self.always: set[int] = set()
        self.chosen: int | None = None
        self.parked = False

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        timeouts = tuple((index, deadline - self.world.now) for index, deadline in self.timeouts.items())
        done = tuple(offer.done for offer in self.offers.values())
        return (self.done, self.chosen, self.parked, timeouts, tuple(self.offers), done, tuple(sorted(self.always)))

    def _ready_guards(self) -> list[int]:
        ready = set(self.always)
        ready.update(index for index, offer in self.offers.items() if offer.medium.ready(offer))
        ready.update(index for index, deadline in self.timeouts.items() if deadline <= self.world.due)
        return sorted(ready)

    def may_go_on(self) -> bool:
        """See ``Request.may_go_on``."""
        return self.chosen is None and bool(self._ready_guards())

    def attempt(self) -> None:
        """See ``Request.attempt``."""
        if self.chosen is not None:
            return
        ready = self._ready_guards()
        if not ready:
            self._park()
            return
        last = -1 if self.prioritized else self.world.memories.get(self.name, -1)
        index = next((i for i in ready if i > last), ready[0])
        self._settle(index)
        offer = self.offers.get(index)
        if offer is None:
            self.finish()
            return
        offer.medium.choose(offer)
        if offer.done:
            self.finish()

    def _park(self) -> None:
        if not self.parked:
            self.parked = True
            begin_sessions(list(self.offers.values()))
            for offer in self.offers.values():
                offer.medium.park(offer)
            self.world.notice()

    def _settle(self, index: int) -> None:
        self.chosen = index
        if not self.prioritized:
            self.world.memories[self.name] = index
        for offer in self.offers.values():
            offer.medium.withdraw(offer)

    def resolve(self, offer: Offer) -> None:
        """Somebody has chosen to communicate with this guard."""
        assert offer.guard is not None
        self._settle(offer.guard)
        if offer.only_ready:
            self.finish()

    def bind(self, offer: Offer) -> None:
        """Somebody is going to communicate with this output guard."""
        assert offer.guard is not None
        self._settle(offer.guard)
        offer.guard = None
        offer.medium.arrive(offer)

    def offer_done(self, offer: Offer) -> None:
        """The communication of the chosen guard has been made."""
        self.finish()

    def deadlines(self) -> Sequence[int]:
        """See ``Request.deadlines``."""
        return list(self.timeouts.values()) if self.chosen is None else ()

    def abandon(self) -> None:
        """See ``Request.abandon``."""
        for offer in self.offers.values():
            offer.medium.withdraw(offer)
        super().abandon()


class Waiting(Request):
    """A delay; None never ends."""

    def __init__(self, world: Following, task: Task, duration: int | None) -> None:
        super().__init__(world, task)
        self.until = None if duration is None else world.now + duration

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        return (self.done, None if self.until is None else self.until - self.world.now)

    def may_go_on(self) -> bool:
        """See ``Request.may_go_on``."""
        return self.until is not None and self.until <= self.world.due

    def deadlines(self) -> Sequence[int]:
        """See ``Request.deadlines``."""
        return () if self.until is None else (self.until,)

    def attempt(self) -> None:
        """See ``Request.attempt``."""
        self.done = self.done or self.may_go_on()


class Branches(Request):
    """A parallel; it has the first exception of a branch as its ``failure``."""

    def __init__(self, world: Following, task: Task, after: int) -> None:
        super().__init__(world, task)
        self.after = after
        self.tasks: list[Task] = []
        self.failure: Raise | None = None
        self.abandoned = False

    def state(self) -> tuple[object, ...]:
        """See ``Request.state``."""
        return (self.done, id(self.failure), self.abandoned, tuple(task.ended for task in self.tasks))

    def branch_ended(self, failure: Raise | None, cancelled: bool) -> None:
        """A branch has ended."""
        if cancelled:
            self.abandoned = True
        elif failure is not None and self.failure is None:
            self.failure = failure
            for sibling in self.tasks:
                self.world.cancel(sibling)
        if all(branch.ended for branch in self.tasks):
            self.finish()

    def abandon(self) -> None:
        """See ``Request.abandon``."""
        for task in self.tasks:
            self.world.cancel(task)


def begin_sessions(offers: list[Offer]) -> None:
    """First reads, all that a process begins to wait for together."""
    new = [(o, o.medium) for o in offers if isinstance(o.medium, SampledInput) and o.end not in o.medium.sessions]
    found = [(o, medium, medium.ready(o)) for o, medium in new]
    for offer, medium, available in found:
        medium.begin(offer, available)
