"""The scheduler: which process runs next.

A *task* is a thread of control: the outermost process, or a branch of a parallel. What waits in a channel is a
*party*: a task, or one of several communications that a task has offered at once.

Invariants:

- At most one task of a run is running; ``scheduler.current`` is that task, or ``nobody``.
- A party is either registered with the thing it waits for, or its ``entry`` is in a ready queue, and at most one of
  the two. What removes it from the first puts it into the second; nothing resumes a task directly.
- Within a level of priority the ready queue is first come, first served. Level ``()`` is the highest; a task of a
  lower level runs only while no task of a higher level is ready.
- A task that is cancelled never registers anywhere, and never completes a communication.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Coroutine, Generator, Iterable, Iterator, Mapping
from contextvars import ContextVar, Token
from heapq import heappop
from itertools import islice
from typing import Any, Final, Protocol, TypeAlias

from .child import end_of_child
from .exceptions import Cancelled
from .executed import Executed
from .party import Entry, Party, ReadyQueue, Waitable, Waits
from .policy import Option, Policy
from .stopping import stopping
from .timers import Delay, Timers

Priority: TypeAlias = tuple[int, ...]
"""Ranks from the outermost prioritized parallel inwards; the smallest is the most urgent."""


class Task:
    """A thread of control, driven by sending None into its coroutine.

    ``waiting`` is what it waited for last; only that object knows whether it still does. ``process`` is the innermost
    process that it executes.
    """

    __slots__ = (
        "cancelled",
        "coroutine",
        "ended",
        "entry",
        "join",
        "priority",
        "process",
        "ready_queue",
        "received",
        "resume",
        "scheduler",
        "waiting",
    )

    def __init__(
        self, body: Coroutine[Any, Any, object] | Generator[None, None, None], join: Join, parent: Task | None
    ) -> None:
        self.coroutine = body
        self.resume: Callable[[None], object]
        self.entry: Entry
        self.join = join
        self.process: Executed | None
        self.priority: Priority
        self.ready_queue: ReadyQueue
        self.received: Any = None
        self.waiting: Waitable | None = None
        self.cancelled = False
        self.ended = False
        if parent is None:
            self.scheduler: Scheduler = present()
            self.process, self.priority, self.ready_queue = None, (), self.scheduler.queue
        else:
            self.scheduler = parent.scheduler
            self.process, self.priority, self.ready_queue = parent.process, parent.priority, parent.ready_queue
        self._is_resumed()

    def _is_resumed(self) -> None:
        """Decides how it is resumed."""
        self.resume = self.coroutine.send
        self.entry = self

    def __next__(self) -> object:
        """``resume``, for a scheduler that resumes directly."""
        self.scheduler.current = self
        return self.resume(None)

    def cancel(self) -> None:
        """Ends the task at its next communication: the one at which it waits, or else the next one that it begins."""
        if self.cancelled or self.ended:
            return
        self.cancelled = True
        if self is self.scheduler.current:
            self._cancel_running()
        elif self.withdraw():
            self.resume = self._abandon
            self.ready_queue.append(self)
        else:
            self._cancel_ready()

    def _cancel_ready(self) -> None:
        """Cancels a task that is in a ready queue, or waits for its branches, which were cancelled."""
        self.resume = self._run_until_communication

    def withdraw(self) -> bool:
        """Removes the task from where it waits; False if it does not wait."""
        return self.waiting is not None and self.waiting.withdraw(self)

    def waits(self) -> Waits:
        """What the task waits for."""
        return () if self.waiting is None else self.waiting.waits_for(self)

    def _cancel_running(self) -> None:
        """It has itself made the guard ready that interrupts it, and may be about to park in that very communication.

        The entry in the queue comes before any that a partner could make; by then the task has parked, or ended.
        """
        self.scheduler.heed_cancellation()
        self.resume = self._abandon_if_parked
        self.ready_queue.append(self)

    def _abandon_if_parked(self, _: None) -> None:
        self.resume = self._run_until_communication
        self.scheduler.forget_cancellation()
        if not self.ended and self.withdraw():
            self._abandon(None)

    def _abandon(self, _: None) -> None:
        self.resume = self._run_until_communication
        self.scheduler.heed_cancellation()
        try:
            self.coroutine.throw(Cancelled())
        finally:
            self.scheduler.forget_cancellation()

    def _run_until_communication(self, _: None) -> None:
        self.scheduler.heed_cancellation()
        try:
            self.coroutine.send(None)
        finally:
            self.scheduler.forget_cancellation()


class Watcher(Protocol):
    """What is notified when processes and groups start and end; see ``Observer``."""

    def process_started(self, time: int, path: str, class_name: str) -> None: ...  # noqa: D102
    def process_ended(self, time: int, path: str) -> None: ...  # noqa: D102
    def group_started(self, time: int, path: str) -> None: ...  # noqa: D102
    def group_ended(self, time: int, path: str) -> None: ...  # noqa: D102


class Join(Protocol):
    """What is notified when a branch ends."""

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """Called once for every branch."""
        ...


class Led(Exception):  # noqa: N818 - it says what is the case
    """A policy leads the run, and may want the task to halt before it communicates."""


class Scheduler:
    """The ready queues and the present instant of one run. While it is entered, ``present`` returns it in this thread.

    ``enqueue`` readies a party. ``ready`` does so on behalf of the running task, which ends there if it is cancelled;
    ``push`` also raises ``Led`` if a policy may want the task to halt first. ``careful``: whether a task must make
    checks before it waits, as it may be cancelled, a policy may want it to halt, or this is not the present run.
    """

    __slots__ = (
        "_entered",
        "_levels",
        "careful",
        "current",
        "enqueue",
        "now",
        "observe",
        "over",
        "policy",
        "port_logs",
        "push",
        "queue",
        "ready",
        "sample_log",
        "timers",
        "watcher",
    )

    current: Task

    def __init__(self, policy: Policy | None = None) -> None:
        self.now = 0
        self.over = False
        """Whether the program has ended or is in a deadlock; it is reported, and outputs are released, after that."""
        self.queue: list[Any] = []
        """The queue of the highest level; always the same list."""
        self._entered: list[Token[Scheduler]] = []
        self.current = nobody
        self._levels: list[tuple[Priority, deque[Any]]] = []
        self.enqueue: Callable[[Any], None] = self.queue.append
        self.timers = Timers()
        self.watcher: Watcher | None = None
        self.observe: Callable[[str, Any, Party | None, Party | None], None] | None = None
        self.sample_log: list[Any] | None = None
        self.port_logs: Mapping[str, tuple[Any, Any]] = {}
        """See ``Observer.port_logs``; empty if nothing is noted."""
        self.policy = policy
        self.push: Callable[[Any], None]
        self.ready: Callable[[Any], None]
        self.careful: bool
        self.forget_cancellation()

    def port_log(self, port: str) -> tuple[Any, Any]:
        """What adds to the instants and the values of an external port, whether they are noted or not."""
        times, values = self.port_logs.get(port, ([], []))
        return times.append, values.append

    def note(self, port: str, value: Any) -> None:
        """Notes what an external port shows now, if its values are noted."""
        log = self.port_logs.get(port)
        if log is not None:
            times, values = log
            times.append(self.now)
            values.append(value)

    def __enter__(self) -> Scheduler:
        self._entered.append(_present.set(self))
        return self

    def __exit__(self, *_: object) -> None:
        _present.reset(self._entered.pop())

    def end(self) -> None:
        """The run is over: channels that are used again look up the present run."""
        self.over = True
        self.observe = self.watcher = None
        self.current = nobody
        self.careful = True
        self.push = _refuse

    def heed_cancellation(self) -> None:
        """A cancelled task runs from now on, or one that was cancelled may be about to wait."""
        self.careful = True
        self.push = self.ready = self._ready_unless_cancelled

    def forget_cancellation(self) -> None:
        """It runs no longer."""
        self.careful = self.policy is not None
        self.ready = self.enqueue
        self.push = _refuse if self.careful else self.enqueue

    def _ready_unless_cancelled(self, entry: Entry) -> None:
        """Replaces ``ready`` while a cancelled task runs.

        Channels ready the partner before they change anything: this ends the task with the communication undone.
        """
        if self.current.cancelled:
            raise Cancelled
        self.enqueue(entry)

    def cancel(self, tasks: Iterable[Task]) -> None:
        """Cancels several tasks."""
        for task in tasks:
            task.cancel()

    def forget(self, task: Task) -> None:
        """A task will not be resumed any more, although it has not ended."""

    def leave(self) -> None:
        """Called in a forked child: whatever would be resumed next, in any loop over the queue, ends the child."""
        self.queue[:] = [end_of_child] * (len(self.queue) + 1)

    def set_priority(self, task: Task, priority: Priority) -> None:
        """Gives a task that is not in a queue its level.

        Levels compare as if padded with zeros: the first branch of a prioritized parallel stays at the level of its
        parent.
        """
        task.priority = priority
        while priority and priority[-1] == 0:
            priority = priority[:-1]
        task.ready_queue = self._queue_of(priority)

    def _queue_of(self, priority: Priority) -> ReadyQueue:
        if not priority:
            return self.queue
        for level, queue in self._levels:
            if level == priority:
                return queue
        created: deque[Any] = deque()
        self._levels.append((priority, created))
        self._levels.sort(key=lambda entry: entry[0])
        self.enqueue = _enqueue_by_level
        self.forget_cancellation()
        return created

    def run_ready(self, most: int = 4096) -> bool:
        """Runs up to ``most`` ready parties; False if none is left.

        The queue of the highest level is a list that grows during the loop over it, and is then cleared up to there: a
        FIFO without the cost of ``popleft``. When a task ends, its StopIteration leaves the loop but not the iterator.
        """
        queue = self.queue
        if not queue:
            return self._run_lower_level()
        batch = islice(queue, most)
        while True:
            try:
                for party in batch:
                    self.current = party
                    resume = party.resume  # CPython 3.11 does not specialize a call of what a slot holds.
                    resume(None)
                break
            except StopIteration:
                self._task_ended(None)
            except BaseException as error:
                self._task_ended(error)
        self.current = nobody
        if len(queue) <= most:
            queue.clear()
            return bool(self._levels)
        del queue[:most]
        return True

    def run_first(self) -> bool:
        """Runs the party that has been ready for longest, of the highest level; False if none is left."""
        queue = self.queue
        if not queue:
            return self._run_lower_level()
        self.run_one(queue.pop(0))
        return bool(queue or self._levels)

    def _run_lower_level(self) -> bool:
        for _, queue in self._levels:
            if queue:
                self.run_one(queue.popleft())
                return True
        return False

    def end_delays(self, before: int, root: Task) -> None:
        """Passes the time until the instant ``before`` while no party is ready, as long as all that happens are single
        delays that end and what follows from that, and ``root`` has not ended.
        """
        timers = self.timers
        heap, at, queue = timers.heap, timers.at, self.queue
        while heap and (instant := heap[0]) < before and type(delay := at.get(instant)) is Delay:
            heappop(heap)
            del at[instant]
            self.now = instant
            entry = delay.task.entry
            try:
                next(entry)
            except StopIteration:
                self._ended(entry, None)
            except BaseException as error:
                self._ended(entry, error)
            self.current = nobody
            while (queue or self._levels) and self.run_ready():
                stopping.check()
            if stopping.signal or root.ended:
                return

    def run_ready_by(self, policy: Policy) -> bool:
        """Like ``run_ready``, but only one party, which the policy chooses among those of the highest level."""
        for _, queue in ((), self.queue), *self._levels:
            if queue:
                position = policy.next(tuple(queue))
                party = queue[position]
                del queue[position]
                self.run_one(party)
                return True
        return False

    def take_ready(self) -> Iterator[tuple[Priority, Party]]:
        """Takes all ready parties out of their queues, for a caller that runs them by ``run_one``."""
        for level, queue in ((), self.queue), *self._levels:
            yield from [(level, party) for party in queue]
            queue.clear()

    def is_ready(self, party: Party) -> bool:
        """Whether a party is in a queue; looks through all of them."""
        queues = [self.queue, *(queue for _, queue in self._levels)]
        return any(entry is party.entry for queue in queues for entry in queue)

    @property
    def has_levels(self) -> bool:
        """Whether there is, or was, a prioritized parallel."""
        return bool(self._levels)

    def run_one(self, party: Party) -> None:
        """Runs a party that is in no queue until it has to wait."""
        try:
            self._run_one(party)
        finally:
            self.current = nobody

    def _run_one(self, party: Party) -> None:
        self.current = party  # type: ignore[assignment]
        try:
            party.resume(None)
        except StopIteration:
            self._task_ended(None)
        except BaseException as error:
            self._task_ended(error)

    def _ended(self, entry: Entry, error: BaseException | None) -> None:
        """The task behind an entry that was resumed has ended."""
        self._task_ended(error)

    def _task_ended(self, error: BaseException | None) -> None:
        """A task has ended; an exception that it raised belongs to the program, unless it ends the run."""
        if error is not None and stopping.ends_run(error):
            raise error
        ended = self.current
        if ended.ended:
            return  # Of several communications that it offered at once, one more was done.
        ended.ended = True
        ended.join.branch_ended(ended, error)


def _refuse(party: Party) -> None:
    raise Led


def _enqueue_by_level(party: Party) -> None:
    party.ready_queue.append(party)


nobody: Task = None  # type: ignore[assignment]
"""The current task while no process runs."""

_present: ContextVar[Scheduler] = ContextVar("the run of this thread")

present = _present.get
"""The scheduler of the run that this thread is in. Raises LookupError if there is none."""

no_run: Final = Scheduler()
"""Belongs to no run: channels have it before their first use."""
no_run.end()


def hold(policy: Policy, *options: Option, together: bool = False) -> Generator[None, None, Option | None]:
    """Halts the current task if the policy says so. Returns what it is to continue with; None: as in any run."""
    task = present().current
    if task.cancelled:
        raise Cancelled
    gate = policy.halt(task, options, together=together)
    if gate is None:
        return None
    task.waiting = gate
    yield
    return gate.chosen
