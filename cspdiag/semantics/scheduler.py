"""Which process runs, and when time advances: the scheduling rules of the language, sentence by sentence."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, Protocol

from cspdiag.model.sampling import Sampling
from cspdiag.semantics.equations.parameters import Parameters
from cspdiag.semantics.observer import Observer
from cspdiag.semantics.outside import EventInput, ExternalInput, SampledInput, SampledOutput
from cspdiag.semantics.requests import CancelledError, Parent, Request, Run, Task, no_steps
from cspdiag.semantics.trace import Communication, Ending
from cspdiag.semantics.values import RaisedError

END_OF_TIME = 9_223_372_036 * 10**9
"""The last instant, in nanoseconds. «Time»"""

Resumption = Callable[[], Request]


class Outside(Protocol):
    """The environment: ``inputs`` are the outputs of the program. «Environments and drivers»"""

    grid: Sampling

    def advance(self, now: int) -> None:
        """Advance to ``now``, with the inputs held."""

    def output(self, port: str) -> Any:
        """The present value of one of its outputs, an input of the program."""

    def give(self, port: str, value: Any) -> None:
        """Take a value of an output of the program."""


class Canceller:
    """Ends a process that was cancelled while it was running, if it waits when the canceller has its turn.
    «Cancellation» 4
    """

    def __init__(self, victim: Task) -> None:
        self.victim = victim

    def branch_ended(self, task: Task, error: RaisedError | None) -> None:
        """Its turn."""
        victim = self.victim
        victim.doomed = False
        request = victim.request
        if request is None or request.completed or victim in request.world.ready:
            return
        request.abandon()
        if victim in request.world.ready:
            request.world.ready.remove(victim)
            request.world.run_next(victim)


class Scheduler:
    """The state of a run. «Scheduling and traces»"""

    def __init__(self, top: str, outside: Outside | None, timeouts: bool) -> None:
        self.top = top
        self.outside = outside
        self.timeouts = timeouts
        self.now = 0
        self.due = 0
        """Delays and time-outs up to this instant are over.

        It follows ``now`` once samples have been taken and outputs handed over.
        """
        self.trace: list[Communication] = []
        self.inputs: list[ExternalInput] = []
        self.outputs: list[SampledOutput] = []
        self.ready: list[Task] = []
        self.waiting: list[Request] = []
        """The requests of waiting processes, in the order in which they began."""
        self.main: Task | None = None
        """The whole program."""
        self.running: Task | None = None
        self.begun = 0
        self.failure: RaisedError | None = None
        self.look: Callable[[Scheduler], None] | None = None
        """Called with the state after each communication."""
        self.observer: Observer | None = None
        self.parameters: Parameters | None = None

    def change_parameters(self, now: int) -> None:
        """Make the changes of parameters up to an instant, before anything happens at it. «Parameters»"""
        for change, reason in [] if self.parameters is None else self.parameters.reach(now):
            if self.observer is not None and reason:
                self.observer.refused_change(change.time, change.parameter, reason)
            elif self.observer is not None:
                self.observer.changed(now, change.parameter, change.path, change.value)

    def communicate(self, channel: str, value: Any, writer: str = "", reader: str = "") -> None:
        """Record a communication. «Traces»"""
        self.trace.append(Communication(self.now, channel, value, writer, reader))
        if self.observer is not None:
            self.observer.communication(self.now, channel, value, writer, reader)
        if self.look is not None:
            self.look(self)

    def waits(self) -> Iterator[tuple[str, str]]:
        """The path of each process that waits, and what it waits for in words."""
        for request in self.waiting:
            offers = request.offers_now()
            who = " and ".join(dict.fromkeys(offer.end[0] for offer in offers)) or "a process"
            what = [f"to {'write' if offer.writes else 'read'} {offer.medium.name}" for offer in offers]
            what += [f"until {deadline / 1e6:.6f} ms" for deadline in request.deadlines()]
            if what and not request.completed:
                yield who, " or ".join(what)

    def hand_over(self, channel: str, value: Any) -> None:
        """Hand a value over to the environment. «Time»"""
        self.communicate(channel, value)
        if self.outside is not None:
            self.outside.give(channel.removeprefix(f"{self.top}."), value)

    def process_started(self, path: str, kind: str) -> None:
        """A process of a class, or a named group, begins."""
        if self.observer is not None:
            self.observer.process_started(self.now, path, kind)

    def group_ended(self, path: str) -> None:
        """A named group has ended."""
        self._report_end(path)

    def process_ended(self, path: str) -> None:
        """A process has ended, and with it the sessions of its reading ends. «Time»"""
        for port in self.inputs:
            if isinstance(port, SampledInput):
                port.process_ended(path)
        self._report_end(path)

    def _report_end(self, path: str) -> None:
        # A process that is left because the run is ended from outside has not ended itself.
        interrupted = sys.exception()
        if self.observer is not None and (interrupted is None or isinstance(interrupted, Exception)):
            self.observer.process_ended(self.now, path)

    def start(self, steps: Run, priority: tuple[int, ...], parent: Parent | None) -> Task:
        """A new task."""
        return Task(steps, priority, parent)

    def make_ready(self, task: Task) -> None:
        """Put a task into the ready queue, unless it is there already."""
        if task is not self.running and task not in self.ready and not task.ended:
            self.ready.append(task)

    def run_next(self, task: Task) -> None:
        """Put a task at the front of the ready queue: it runs in the present turn."""
        self.ready.insert(0, task)

    def cancel(self, task: Task) -> None:
        """Cancel a task: it ends at its next request, or at the one at which it waits. «Cancellation» 1 to 4"""
        if task.ended or task.cancelled:
            return
        task.cancelled = True
        if task is self.running:
            task.doomed = True
            self.ready.append(self.start(no_steps(), task.priority, Canceller(task)))
        elif task.request is not None and not task.request.completed:
            task.request.abandon()

    def notice(self) -> None:
        """Wake every task that may continue now, because of one event. «Parties, channels and guards»"""
        self._wake(sorted(self.waiting, key=lambda request: request.turn))

    def _wake(self, requests: Sequence[Request]) -> None:
        for request in requests:
            task = request.task
            asleep = task is not self.running and task not in self.ready and not task.cancelled
            if asleep and request in self.waiting and not request.completed and request.can_continue():
                request.wake()

    def run_until_none_is_ready(self) -> None:
        """Run processes by priority, and first come, first served within one priority. «Scheduling and traces»,
        «Priority»
        """
        while self.ready:
            highest = min(task.rank() for task in self.ready)
            task = self.next_task([task for task in self.ready if task.rank() == highest])
            self.ready.remove(task)
            self._run(task)

    def next_task(self, ready: Sequence[Task]) -> Task:
        """The task to run: the first of those that are ready, in the order in which they became ready. «Scheduling and
        traces»
        """
        return ready[0]

    def fair(self, ready: Sequence[int], last: int) -> int:
        """The guard that an alternative without priorities takes among those that are ready.

        It is the first one after the guard that it chose last, cyclically.
        """
        return next((index for index in ready if index > last), ready[0])

    def _run(self, task: Task) -> None:
        self.running = task
        resumption = self._continued(task)
        while resumption is not None:
            try:
                request = resumption()
            except StopIteration:
                self._end(task, None)
                break
            except RaisedError as error:
                self._end(task, error)
                break
            resumption = self._begun(task, request)
        self.running = None
        self.notice()

    def _continued(self, task: Task) -> Resumption | None:
        request = task.request
        if request is None:
            return partial(task.steps.send, None)
        if not request.completed and not task.cancelled:
            self._attempt(request, request.attempt)
        return self._answer(task, request)

    def _begun(self, task: Task, request: Request) -> Resumption | None:
        if task.cancelled:
            return partial(task.steps.throw, CancelledError())
        self.begun += 1
        request.task, request.world, request.began = task, self, self.begun
        task.request = request
        self.waiting.append(request)
        self._attempt(request, request.begin)
        if not request.completed:
            self._attempt(request, request.attempt)
        return self._answer(task, request)

    def _attempt(self, request: Request, step: Callable[[], None]) -> None:
        try:
            step()
        except RaisedError as error:
            for offer in request.offers_now():
                offer.medium.withdraw(offer)
            request.done, request.error = True, error
        self.notice()

    def _answer(self, task: Task, request: Request) -> Resumption | None:
        if not request.completed and (not task.cancelled or task.doomed or request.branches_run):
            return None
        self.waiting.remove(request)
        task.request = None
        if not request.completed:
            return partial(task.steps.throw, CancelledError())
        if request.error is not None:
            return partial(task.steps.throw, request.error)
        return partial(task.steps.send, request.outcome())

    def _end(self, task: Task, error: RaisedError | None) -> None:
        task.ended = True
        if task.parent is not None:
            task.parent.branch_ended(task, error)
        else:
            self.failure = error

    def instant(self, now: int) -> None:
        """Everything that happens at an instant before processes run. «An instant», «Time»"""
        self.now = now
        self.change_parameters(now)
        outside = self.outside
        if outside is not None:
            on_grid = outside.grid.is_tick(now)
            if on_grid or any(sampling.is_tick(now) for sampling in self.samplings()):
                outside.advance(now)
            for port in self.inputs:
                value = outside.output(port.name.removeprefix(f"{self.top}."))
                if isinstance(port, EventInput) and on_grid:
                    port.offered(value)
                elif isinstance(port, SampledInput) and port.sampling.is_tick(now):
                    if self.observer is not None:
                        self.observer.sampled(now, port.name, value)
                    port.sampled(value)
                self.notice()
        for output in self.outputs:
            if output.sampling.is_tick(now):
                output.tick()
        self.due = now
        self._wake(list(self.waiting))

    def samplings(self) -> list[Sampling]:
        """The samplings of the ports. «Time»"""
        sampled = [port.sampling for port in self.inputs if isinstance(port, SampledInput)]
        return sampled + [port.sampling for port in self.outputs]

    def next_instant(self) -> int | None:
        """The next instant at which something is due; None if nothing ever is: the program has ended or is in deadlock.

        «Scheduling and traces»
        """
        deadlines = [deadline for request in self.waiting for deadline in request.deadlines()]
        waits_outside = any(offer.medium.outside for request in self.waiting for offer in request.offers_now())
        pending = any(output.latched for output in self.outputs)
        if not deadlines and not waits_outside and not pending:
            return None
        samplings = self.samplings()
        if self.outside is not None:
            samplings.append(self.outside.grid)
        return min([*deadlines, *(sampling.next_tick(self.now) for sampling in samplings)])

    def run(self, program: Run, until: int | None) -> Ending:
        """Run to the end, to ``until``, or to the end of time. «Scheduling and traces», «Time»"""
        last = END_OF_TIME if until is None else min(until, END_OF_TIME)
        main = self.main = self.start(program, (), None)
        self.make_ready(main)
        self.run_until_none_is_ready()
        while not main.ended:
            instant = self.next_instant()
            if instant is None:
                return Ending("deadlock", self.now)
            if instant > last:
                return Ending("time limit", last)
            self.instant(instant)
            self.run_until_none_is_ready()
        if self.failure is None:
            return Ending("terminated", self.now)
        return Ending("failed", self.now, type(self.failure).__name__)
