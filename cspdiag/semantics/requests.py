"""The requests of processes to the scheduler: everything that a process may wait for."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any, Protocol

from cspdiag.semantics.media import Offer, World
from cspdiag.semantics.outside import begin_sessions
from cspdiag.semantics.values import RaisedError


class CancelledError(RaisedError):
    """A sibling has failed, or an interrupt was triggered: the process ends here. «Cancellation»"""


Steps = Generator["Request", Any, Any]


class Run(Protocol):
    """The steps of a task, from one request to the next; raises StopIteration at its end. «Scheduling and traces»"""

    def send(self, answer: Any, /) -> Request:
        """Continue with the answer to the request; with None at first."""

    def throw(self, error: RaisedError, /) -> Request:
        """Continue with an exception in place of the answer."""


def no_steps() -> Steps:
    """No steps: for a task that only takes a turn in the ready queue. «Cancellation» 4, «Interrupt» 5"""
    yield from ()


class Parent(Protocol):
    """What is notified of the end of a branch. «Parallel», «Interrupt»"""

    def branch_ended(self, task: Task, error: RaisedError | None) -> None:
        """A branch has ended; by an exception if ``error`` is not None."""


class Task:
    """A branch of a parallel, the body of an interrupt, or the whole program, which runs or waits.

    «Scheduling and traces»
    """

    def __init__(self, steps: Run, priority: tuple[int, ...], parent: Parent | None) -> None:
        self.steps = steps
        self.priority = priority
        self.parent = parent
        self.request: Request | None = None
        self.cancelled = False
        self.doomed = False
        """Whether it was cancelled while it was running, and its canceller has not had its turn yet."""
        self.ended = False

    def rank(self) -> tuple[int, ...]:
        """The key of its priority: ranks are compared from the outermost ``||>`` inwards, as if zeros followed.
        «Priority»
        """
        rank = list(self.priority)
        while rank and rank[-1] == 0:
            rank.pop()
        return tuple(rank)


class Scheduling(World, Protocol):
    """The part of the scheduler that requests use. «Scheduling and traces»"""

    due: int
    """Delays and time-outs up to this instant are over."""
    begun: int
    """The number of requests that have begun."""
    ready: list[Task]

    def start(self, steps: Run, priority: tuple[int, ...], parent: Parent | None) -> Task:
        """A new task."""

    def make_ready(self, task: Task) -> None:
        """Put a task into the ready queue, unless it is there already."""

    def run_next(self, task: Task) -> None:
        """Put a task at the front of the ready queue: it runs in the present turn."""

    def cancel(self, task: Task) -> None:
        """Cancel a task: it ends at its next request, or at the one at which it waits. «Cancellation» 1 to 4"""

    def fair(self, ready: Sequence[int], last: int) -> int:
        """The guard that an alternative without priorities takes among those that are ready."""


class Request:
    """Something that a process waits for until it is ``done``, with a ``result`` or an ``error``. «Cancellation»"""

    task: Task
    world: Scheduling
    began: int
    """Requests are numbered in the order in which they began."""

    def __init__(self) -> None:
        self.done = False
        self.result: Any = None
        self.error: RaisedError | None = None

    @property
    def completed(self) -> bool:
        """Whether the request is done or has failed."""
        return self.done

    @property
    def branches_run(self) -> bool:
        """Whether the request has branches that have not ended."""
        return False

    @property
    def turn(self) -> tuple[int, int]:
        """The key of the order in which requests that one event wakes are served.

        Readers and writers, in the order in which they began, come before alternatives. «Parties, channels and guards»
        """
        return (0, self.began)

    def begin(self) -> None:
        """Called once, before the first attempt."""

    def attempt(self) -> None:
        """The process runs: continue as far as possible."""

    def can_continue(self) -> bool:
        """Whether something that the request waits for is there."""
        return False

    def wake(self) -> None:
        """Let the process continue."""
        self.world.make_ready(self.task)

    def abandon(self) -> None:
        """The process ends at this request: it enters the ready queue, and ends when it runs. «Cancellation» 1"""
        self.world.make_ready(self.task)

    def offers_now(self) -> Sequence[Offer]:
        """The offers of the request while it waits."""
        return ()

    def deadlines(self) -> Sequence[int]:
        """The instants at which it may continue."""
        return ()

    def offer_done(self, offer: Offer) -> None:
        """The communication of an offer has taken place."""

    def resolve(self, offer: Offer) -> None:
        """Another process has chosen to communicate with this guard."""
        raise AssertionError

    def bind(self, offer: Offer) -> None:
        """Another process is going to communicate with this output guard."""
        raise AssertionError

    def outcome(self) -> Any:
        """The answer to the process."""
        return self.result

    def finish(self, result: Any = None) -> None:
        """Mark the request as done."""
        self.done, self.result = True, result
        self.world.make_ready(self.task)


class Communicate(Request):
    """Reads and writes that are offered all at once; the result is their values. «Rendezvous»"""

    def __init__(self) -> None:
        super().__init__()
        self.offers: list[Offer] = []

    def begin(self) -> None:
        """Offer everything, in the order of the ports. «Parallel»"""
        begin_sessions(self.offers)
        for offer in self.offers:
            offer.medium.arrive(offer)
            self.world.notice()
        if not self.offers:
            self.finish([])

    def attempt(self) -> None:
        """Take what has arrived meanwhile: a submodel takes, in the order of its ports, all values that are there."""
        for offer in self.offers_now():
            offer.medium.retry(offer)

    def can_continue(self) -> bool:
        """Whether a sample or an event has arrived for one of the offers."""
        return any(offer.medium.wakes(offer) for offer in self.offers_now())

    def offers_now(self) -> Sequence[Offer]:
        """The offers that have not communicated yet."""
        return [offer for offer in self.offers if not offer.done]

    def offer_done(self, offer: Offer) -> None:
        """The request is done when all offers have communicated."""
        if not self.offers_now():
            self.finish([offer.value for offer in self.offers])

    def abandon(self) -> None:
        """Withdraw the offers that have not communicated. «Cancellation» 1"""
        for offer in self.offers_now():
            offer.medium.withdraw(offer)
        super().abandon()


class Wait(Request):
    """A delay, ``wait``; with None it never ends, ``stop``. «The composition diagram»"""

    def __init__(self, duration: int | None) -> None:
        super().__init__()
        self.duration = duration
        self.until = 0

    def begin(self) -> None:
        """A delay with a zero or negative duration is over at once. «Parties, channels and guards»"""
        if self.duration is not None:
            self.until = self.world.now + self.duration
            if self.duration <= 0:
                self.finish()

    def can_continue(self) -> bool:
        """Whether its instant has been reached. «An instant»"""
        return self.duration is not None and self.until <= self.world.due

    def wake(self) -> None:
        """The delay is over, and stays so: a cancellation finds the process after it. «Cancellation» 3"""
        self.finish()

    def deadlines(self) -> Sequence[int]:
        """The instant at which it is over."""
        return () if self.duration is None else (self.until,)


class Parallel(Request):
    """Parallel branches; done when the last one has ended, with the first exception as its error.

    «Parallel», «Exceptions»
    """

    def __init__(self, branches: Sequence[Run], prioritized: bool) -> None:
        super().__init__()
        self.branches = branches
        self.prioritized = prioritized
        self.tasks: list[Task] = []
        self.failure: RaisedError | None = None
        self.abandoned = False

    def begin(self) -> None:
        """The branches enter the ready queue in the order of the text; those of ``||>`` rank below their parent.

        «Parallel», «Priority»
        """
        for rank, steps in enumerate(self.branches):
            priority = (*self.task.priority, rank) if self.prioritized else self.task.priority
            self.tasks.append(self.world.start(steps, priority, self))
        for task in self.tasks:
            self.world.make_ready(task)

    @property
    def branches_run(self) -> bool:
        """Whether a branch has not ended."""
        return not all(task.ended for task in self.tasks)

    def branch_ended(self, task: Task, error: RaisedError | None) -> None:
        """A branch has ended; one that failed cancels the others. «Exceptions», «Cancellation» 2"""
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
        """The branches are cancelled in the order of the text. «Cancellation» 2"""
        for task in self.tasks:
            self.world.cancel(task)
