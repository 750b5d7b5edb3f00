"""What a process asks of the scheduler: everything at which it may wait."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import TYPE_CHECKING, Any

from cspdiag.semantics.media import Offer, begin_sessions

if TYPE_CHECKING:
    from cspdiag.semantics.scheduler import Scheduler, Task


class CancelledError(Exception):
    """A sibling has failed, or an interrupt has come: the process ends here."""


Steps = Generator["Request", Any, Any]


class Request:
    """``done`` with a ``result`` or an ``error``, or waiting."""

    task: Task
    world: Scheduler
    began: int
    """Requests are numbered in the order in which they began."""

    def __init__(self) -> None:
        self.done = False
        self.result: Any = None
        self.error: Exception | None = None

    @property
    def completed(self) -> bool:
        """Whether what was asked for has happened, or failed."""
        return self.done

    @property
    def branches_run(self) -> bool:
        """Whether it has branches that have not ended."""
        return False

    @property
    def turn(self) -> tuple[int, int]:
        """Who is served first of those that one event wakes: readers and writers in the order in which they began come before alternatives."""
        return (0, self.began)

    def begin(self) -> None:
        """Done once, before the first attempt."""

    def attempt(self) -> None:
        """The process runs: go on as far as possible."""

    def may_go_on(self) -> bool:
        """Whether something that it waits for is there."""
        return False

    def wake(self) -> None:
        """It may go on."""
        self.world.make_ready(self.task)

    def abandon(self) -> None:
        """The process ends at this request."""
        self.world.make_ready(self.task)

    def offers_now(self) -> Sequence[Offer]:
        """What is offered while it waits."""
        return ()

    def deadlines(self) -> Sequence[int]:
        """Instants at which it may go on."""
        return ()

    def offer_done(self, offer: Offer) -> None:
        """Somebody has made the communication of an offer."""

    def resolve(self, offer: Offer) -> None:
        """Somebody has chosen to communicate with this guard."""
        raise AssertionError

    def bind(self, offer: Offer) -> None:
        """Somebody is going to communicate with this output guard."""
        raise AssertionError

    def outcome(self) -> Any:
        """What the process is told."""
        return self.result

    def finish(self, result: Any = None) -> None:
        """It is done."""
        self.done, self.result = True, result
        self.world.make_ready(self.task)


class Communicate(Request):
    """Readers and writers, offered all at once; the result is their values."""

    def __init__(self) -> None:
        super().__init__()
        self.offers: list[Offer] = []

    def begin(self) -> None:
        begin_sessions(self.offers)
        for offer in self.offers:
            offer.medium.arrive(offer)
            self.world.notice()
        if not self.offers:
            self.finish([])

    def attempt(self) -> None:
        for offer in self.offers_now():
            offer.medium.retry(offer)

    def may_go_on(self) -> bool:
        return any(offer.medium.wakes(offer) for offer in self.offers_now())

    def offers_now(self) -> Sequence[Offer]:
        return [offer for offer in self.offers if not offer.done]

    def offer_done(self, offer: Offer) -> None:
        if not self.offers_now():
            self.finish([offer.value for offer in self.offers])

    def abandon(self) -> None:
        for offer in self.offers_now():
            offer.medium.withdraw(offer)
        super().abandon()


class Choose(Request):
    """An alternative: ``offers`` by guard, ``deadlines_`` of time-outs, ``always`` ready guards. The result is a guard and its value.

    ``memory`` keeps the guard that was chosen last; ``place`` counts the alternatives in the order in which they stand in the program.
    """

    def __init__(self, prioritized: bool, memory: dict[str, int], place: int) -> None:
        super().__init__()
        self.prioritized = prioritized
        self.memory = memory
        self.place = place
        self.offers: dict[int, Offer] = {}
        self.timeouts: dict[int, int] = {}
        self.always: set[int] = set()
        self.chosen: int | None = None
        self.parked = False
        self.bound = False
        """Whether its value waits as that of a writer, for somebody who is going to read it."""
        self.promised = False
        """Whether that value was taken."""
        self.interrupt: Interrupt | None = None

    @property
    def turn(self) -> tuple[int, int]:
        """See ``Request.turn``."""
        return (1, self.place)

    def ready_guards(self) -> list[int]:
        """The guards that are ready now, in text order."""
        ready = set(self.always)
        ready.update(index for index, offer in self.offers.items() if offer.medium.ready(offer))
        ready.update(index for index, deadline in self.timeouts.items() if deadline <= self.world.due)
        return sorted(ready)

    def may_go_on(self) -> bool:
        return self.chosen is None and bool(self.ready_guards())

    def attempt(self) -> None:
        if self.chosen is not None:
            return
        ready = self.ready_guards()
        if not ready:
            self.park()
            return
        index = ready[0] if self.prioritized else self.world.fair(ready, self.memory.get("last", -1))
        self._settle(index)
        offer = self.offers.get(index)
        if offer is None:
            self.finish((index, None))
            return
        offer.medium.choose(offer)
        if offer.done:
            self.finish((index, offer.value))

    def park(self) -> None:
        """Begin to wait."""
        if not self.parked:
            self.parked = True
            begin_sessions(list(self.offers.values()))
            for offer in self.offers.values():
                offer.medium.park(offer)
            self.world.notice()

    def _settle(self, index: int) -> None:
        self.chosen = index
        if self.interrupt is not None and not self.interrupt.body.ended:
            self.interrupt.trigger()
        self.memory["last"] = index
        for offer in self.offers.values():
            offer.medium.withdraw(offer)

    def resolve(self, offer: Offer) -> None:
        assert offer.guard is not None
        self._settle(offer.guard)
        if offer.only_ready:
            self.finish((self.chosen, None))

    def bind(self, offer: Offer) -> None:
        assert offer.guard is not None
        self._settle(offer.guard)
        offer.guard = None
        offer.medium.arrive(offer)
        self.bound = True

    def offer_done(self, offer: Offer) -> None:
        if self.interrupt is not None and self.bound:
            self.promised = True
            self.world.make_ready(self.world.start(iter(()), self.task.priority, Promise(self.interrupt)))
        else:
            self.finish((self.chosen, offer.value))

    def finish(self, result: Any = None) -> None:
        if self.interrupt is None or self.interrupt.body.ended:
            super().finish(result)
        else:
            self.done, self.result = True, result

    def offers_now(self) -> Sequence[Offer]:
        if self.chosen is None:
            return list(self.offers.values())
        return [offer for index, offer in self.offers.items() if index == self.chosen and not offer.done]

    def deadlines(self) -> Sequence[int]:
        return list(self.timeouts.values()) if self.chosen is None else ()

    def abandon(self) -> None:
        for offer in self.offers.values():
            offer.medium.withdraw(offer)
        super().abandon()


class Wait(Request):
    """A delay; None never ends."""

    def __init__(self, duration: int | None) -> None:
        super().__init__()
        self.duration = duration
        self.until = 0

    def begin(self) -> None:
        if self.duration is not None:
            self.until = self.world.now + self.duration
            if self.duration <= 0:
                self.finish()

    def may_go_on(self) -> bool:
        return self.duration is not None and self.until <= self.world.due

    def wake(self) -> None:
        self.finish()

    def deadlines(self) -> Sequence[int]:
        return () if self.duration is None else (self.until,)


class Parallel(Request):
    """Branches; it is done when the last has ended, and has the first exception as its error."""

    def __init__(self, branches: Sequence[Steps], prioritized: bool) -> None:
        super().__init__()
        self.branches = branches
        self.prioritized = prioritized
        self.tasks: list[Task] = []
        self.failure: Exception | None = None
        self.abandoned = False

    def begin(self) -> None:
        for rank, steps in enumerate(self.branches):
            priority = (*self.task.priority, rank) if self.prioritized else self.task.priority
            self.tasks.append(self.world.start(steps, priority, self))
        for task in self.tasks:
            self.world.make_ready(task)

    @property
    def branches_run(self) -> bool:
        return not all(task.ended for task in self.tasks)

    def branch_ended(self, task: Task, error: Exception | None) -> None:
        """A branch has ended."""
        if isinstance(error, CancelledError):
            self.abandoned = True
        elif error is not None and self.failure is None:
            self.failure = error
            for sibling in self.tasks:
                self.world.cancel(sibling)
        if all(branch.ended for branch in self.tasks):
            self.error = self.failure or (CancelledError() if self.abandoned else None)
            self.finish()

    def abandon(self) -> None:
        for task in self.tasks:
            self.world.cancel(task)


class Promise:
    """The writer of a value that was promised to a reader before the process of an interrupt ran again: it has a turn of its own."""

    def __init__(self, interrupt: Interrupt) -> None:
        self.interrupt = interrupt

    def branch_ended(self, task: Task, error: Exception | None) -> None:
        """Its turn: the process goes on, if it waits for nothing else."""
        guard, process = self.interrupt.guard, self.interrupt.task
        guard.done, guard.result = True, (guard.chosen, None)
        if self.interrupt.body.ended and not process.ended and process not in self.interrupt.world.ready:
            self.interrupt.world.run_next(process)


class Interrupt(Request):
    """A body that is abandoned once ``guard`` is ready; the result is that of the guard, or None if the body has ended by itself.

    The guard waits beside the body as an alternative does: another alternative may choose to communicate with it.
    """

    def __init__(self, body: Steps, guard: Choose) -> None:
        super().__init__()
        self.body_steps = body
        self.guard = guard
        self.triggered = False
        self.alone = False
        """Whether the body has been abandoned, and the process goes on as an alternative of the guard that begins then."""

    @property
    def turn(self) -> tuple[int, int]:
        """See ``Request.turn``: guards of interrupts come last, in the order in which they began."""
        return (2, self.began)

    def begin(self) -> None:
        self.guard.task, self.guard.world, self.guard.began = self.task, self.world, self.began
        self.guard.interrupt = self
        self.body = self.world.start(self.body_steps, self.task.priority, self)
        self.world.make_ready(self.body)
        self.guard.park()

    @property
    def completed(self) -> bool:
        return self.done or (self.guard.done and self.body.ended)

    @property
    def branches_run(self) -> bool:
        return not self.body.ended or (self.guard.promised and not self.guard.done)

    def may_go_on(self) -> bool:
        return (self.body.ended or not self.triggered) and self.guard.may_go_on()

    def wake(self) -> None:
        if self.body.ended:
            super().wake()
        else:
            self.trigger()

    def trigger(self) -> None:
        """The guard is ready, or was chosen by the other side."""
        self.triggered = True
        self.world.cancel(self.body)

    def branch_ended(self, task: Task, error: Exception | None) -> None:
        """The body has ended."""
        abandoned = isinstance(error, CancelledError)
        if (self.guard.chosen is not None and (error is None or abandoned)) or (
            abandoned and self.triggered and not self.task.cancelled
        ):
            self.world.make_ready(self.task)
        else:
            self._withdraw_guard()
            self.error = error
            self.finish()

    def _withdraw_guard(self) -> None:
        for offer in self.guard.offers.values():
            offer.medium.withdraw(offer)

    def attempt(self) -> None:
        if not self.body.ended or self.done or self.guard.chosen is not None:
            return
        if self.guard.parked and not self.alone:
            self.alone, self.guard.parked = True, False
            self._withdraw_guard()
            self.world.begun += 1
            self.began = self.guard.began = self.world.begun
        self.guard.attempt()

    def outcome(self) -> Any:
        return self.guard.result if self.guard.done else None

    def offers_now(self) -> Sequence[Offer]:
        return self.guard.offers_now()

    def deadlines(self) -> Sequence[int]:
        return () if self.triggered and not self.body.ended else self.guard.deadlines()

    def abandon(self) -> None:
        self._withdraw_guard()
        if self.body.ended:
            super().abandon()
        else:
            self.world.cancel(self.body)
