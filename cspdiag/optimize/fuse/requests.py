"""What tasks wait for at media: communications that are offered all at once, and alternatives."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.optimize.fuse.media import Offer, SampledInput
from cspdiag.optimize.fuse.tasks import Request, Task, TaskScheduler


class Exchange(Request):
    """Readers and writers, offered all at once."""

    def __init__(self, world: TaskScheduler, task: Task) -> None:
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

    def __init__(self, world: TaskScheduler, task: Task, name: str, prioritized: bool) -> None:
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


def begin_sessions(offers: list[Offer]) -> None:
    """First reads, all that a process begins to wait for together."""
    new = [(o, o.medium) for o in offers if isinstance(o.medium, SampledInput) and o.end not in o.medium.sessions]
    found = [(o, medium, medium.ready(o)) for o, medium in new]
    for offer, medium, available in found:
        medium.begin(offer, available)
