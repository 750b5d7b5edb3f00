"""One run of a network, from the first instant to the release of its outputs.

However a run ends, every output is handed its safe value and every driver is closed.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from functools import partial
from signal import SIGINT
from typing import Any, Literal, Protocol, TypeVar, assert_never

from ..compiled.routine import Routine
from ..composition import end_all, task_for
from ..deadlock.partners import report_deadlock
from ..kernel.clock import Clock
from ..kernel.durations import END_OF_TIME
from ..kernel.exceptions import EnvironmentFailure, RunFailed, text_of
from ..kernel.observer import Observer
from ..kernel.parameters import ProgramParameters
from ..kernel.party import Party
from ..kernel.scheduler import Scheduler, Task
from ..kernel.stopping import HandlerFailed, Stopped, stopping
from ..outcome import Outcome
from ..outside.devices import Devices
from ..outside.event_inputs import EventInput
from ..outside.external import Port
from ..outside.instants import Environment, Instants
from ..outside.sampled_inputs import SampledInput
from ..process import Process
from ..real_time.jitter import Jitter
from ..real_time.preference import preferred
from .virtual_time import Ending, VirtualTime

T = TypeVar("T")


class Runnable(Protocol):
    """What is run: the outermost process, the external ports and the parameters of a ``Network``."""

    process: Process | Routine
    ports: tuple[Port, ...]
    parameters: ProgramParameters


class NetworkRun:
    """One run of a network."""

    def __init__(
        self,
        network: Runnable,
        scheduler: Scheduler,
        environment: Environment | None,
        clock: Clock,
        until: int | None,
        on_miss: Literal["timeout", "count"],
        observer: Observer | None,
    ) -> None:
        self._network = network
        self._scheduler = scheduler
        self._environment = environment
        self._clock = clock
        self._until = until
        self._observer = observer
        self._ports = self._own_ports()
        self._devices = Devices(self._ports, clock)
        self.driven = self._devices.driven
        """Whether it has drivers of devices, not only those of a simulated environment."""
        self._instants = Instants(network.ports, environment, self._ports)
        self._jitter = {period: Jitter() for period in self._instants.periods} if clock.real else {}
        for port in self._ports:
            if isinstance(port, SampledInput):
                port.begin(on_miss)
        self._preferred = ExitStack()
        """Left after the outputs have been released."""
        self._preference = ""
        self._process = os.getpid()
        self._root_error: BaseException | None = None
        self._root = task_for(network.process, self, None)
        self.virtual_time = VirtualTime(
            scheduler, self._instants, self._root, self._change_parameters, self._last_instant
        )

    @property
    def root(self) -> Task:
        """What executes the outermost process."""
        return self._root

    def _own_ports(self) -> tuple[Port, ...]:
        """The ports whose drivers this run has."""
        return self._network.ports

    def branch_ended(self, branch: Task, error: BaseException | None) -> None:
        """The outermost process has ended."""
        self._root_error = error

    def outcome(self) -> Outcome:
        """Runs to the end, and releases the outputs."""
        began = time.perf_counter()
        with stopping.running(self._leave), self._preferred:
            return self._released_outcome(began)

    def _leave(self) -> None:
        self._devices.leave()
        self._scheduler.leave()

    def _released_outcome(self, began: float) -> Outcome:
        try:
            outcome = self.caught(self._ending)
        except HandlerFailed as end:
            if stopping.say is None:
                raise end.cause from None  # The caller, which is not a command, handles it.
            outcome = Outcome("failed", self._scheduler.now, error=end.error)
        finally:
            errors = self._release()
        outcome.wall_time = time.perf_counter() - began
        return self._concluded(outcome, errors)

    def released(self, outcome: Outcome) -> Outcome:
        """Releases the outputs after a run that was continued piece by piece; the outcome with what is known then."""
        with self._preferred:
            return self._concluded(outcome, self._release())

    def _concluded(self, outcome: Outcome, errors: Sequence[BaseException]) -> Outcome:
        failure = text_of(outcome.error) if outcome.ended == "failed" and outcome.error is not None else None
        outcome.release_errors = [error for error in errors if text_of(error) != failure]
        outcome.missed = {port.name: port.missed for port in self._ports if isinstance(port, SampledInput)}
        outcome.jitter = self._jitter
        outcome.real_time = self._clock.real
        outcome.preference = self._preference
        return outcome

    def caught(self, part: Callable[[], T]) -> T | Outcome:
        """The result of a part of the run, or how it has ended the run."""
        try:
            return part()
        except Stopped as stopped:
            return Outcome("stopped", self._scheduler.now, signal=stopped.signal, error=stopped.hanging)
        except KeyboardInterrupt:
            return Outcome("stopped", self._scheduler.now, signal=SIGINT)
        except HandlerFailed:
            raise
        except RunFailed as end:
            return Outcome("failed", self._scheduler.now, error=end.error)
        except EnvironmentFailure as error:
            return Outcome("failed", self._scheduler.now, error=error)

    def _ending(self) -> Outcome:
        self.start()
        if not self._clock.real:
            with stopping.raising(patiently=True):
                return self._in_virtual_time()
        outcome = self.in_real_time()
        assert outcome is not None
        return outcome

    def _in_virtual_time(self) -> Outcome:
        until = END_OF_TIME if self._until is None else min(self._until, END_OF_TIME)
        return self.ended(self.virtual_time.advance(until, self._running()), until)

    def ended(self, ending: Ending, until: int) -> Outcome:
        """The outcome of a run that has ended so in virtual time."""
        match ending:
            case "terminated":
                return self._ended_by_itself()
            case "deadlock":
                return self._deadlocked()
            case "time limit":
                return self._limit_reached(until)
            case _:
                assert_never(ending)

    def _last_instant(self, until: int) -> int:
        """The last instant before the next change of a parameter, or before the time limit."""
        change = self._network.parameters.next_change()
        return until if change is None else min(until, change - 1)

    def _change_parameters(self, now: int) -> None:
        """Make the changes of parameters up to an instant, before anything happens at it."""
        changed = getattr(self._observer, "changed", None)
        for change in self._network.parameters.reach(now):
            if changed is not None:
                changed(now, change.parameter, change.path, change.value)

    def _running(self) -> Callable[[], bool]:
        if self._scheduler.policy is not None:
            return partial(self._scheduler.run_ready_by, self._scheduler.policy)
        return self._scheduler.run_ready

    def in_real_time(self, until: int | None = None) -> Outcome | None:
        """The same against the clock. When that shows ``until``, the result is None, and the run can be continued.

        The clock is read after each step of a process. All instants that have passed are met before the next one,
        so a process that computes for too long finds its samples overwritten. Instants that pass while others are met
        wait for the next iteration: processes run in between, however slow drivers are.
        """
        watch = self._devices.watch
        watch.limits_steps = True
        with stopping.raising(patiently=True):
            while until is None or self._clock.now() < until:
                watch.iterations += 1
                outcome = self._iteration(until)
                if outcome is not None:
                    return outcome
        watch.limits_steps = False
        return None

    def _iteration(self, until: int | None) -> Outcome | None:
        watch = self._devices.watch
        ready = self._scheduler.run_first()
        stopping.check()
        self._stepped()
        if self._root.ended:
            return self._ended_by_itself()
        if not ready and not self._can_continue():
            return self._deadlocked()
        instant = self._next_instant()
        present = self._clock.now() if self._reached(_earlier(self._limited(instant), until), ready) else -1
        while (limited := self._limited(instant)) is not None and limited <= present:
            watch.iterations += 1
            stopping.check()
            if instant is None or instant != limited:
                return self._limit_reached(limited)
            self._meet(instant, present)
            instant = self._next_instant()
        if self._has_news():
            self._take_over(instant)
        return None

    def _stepped(self) -> None:
        """A process has made a step."""

    def _has_news(self) -> bool:
        """Whether something arrived from outside."""
        return self._devices.has_news

    def _can_continue(self) -> bool:
        """Whether anything at a later instant can make a process ready or hand over a value."""
        return self._scheduler.timers.next_instant() is not None or self._instants.port_can_have_effect()

    def _limited(self, instant: int | None) -> int | None:
        """The instant, or the time limit if that is earlier."""
        return _earlier(instant, self._until)

    def _limit_reached(self, until: int) -> Outcome:
        self._scheduler.now = until
        return Outcome("time limit", until)

    def _reached(self, instant: int | None, ready: bool) -> bool:
        """Whether the clock has reached the instant; waits for it, or for something from outside, only while no process
        is ready.
        """
        if ready:
            return instant is not None and self._clock.now() >= instant
        self._devices.watch.limits_steps = False
        reached = self._clock.reach(instant)
        self._devices.watch.limits_steps = True
        return reached

    def _deadlocked(self) -> Outcome:
        return self._deadlocked_since(self._scheduler.now)

    def _deadlocked_since(self, instant: int) -> Outcome:
        # The report takes seconds if hundreds of processes wait.
        self._scheduler.over = True
        return Outcome("deadlock", self._scheduler.now, deadlock=report_deadlock(self._root, instant))

    def _ended_by_itself(self) -> Outcome:
        if self._root_error is None:
            return Outcome("terminated", self._scheduler.now)
        return Outcome("failed", self._scheduler.now, error=self._root_error)

    def start(self) -> None:
        """Opens the drivers and evaluates the environment at time 0; then the outermost process is ready."""
        if self._clock.real:
            self._preference = self._preferred.enter_context(preferred())
        self._observe()
        self._devices.open()
        self._change_parameters(0)
        self._instants.start()
        for port in self._ports:
            if isinstance(port, EventInput) and port.polled:
                port.start()
        self._clock.start()
        self._scheduler.enqueue(self._root.entry)

    def _observe(self) -> None:
        observer = self._observer
        if observer is None:
            return
        communication = observer.communication
        log: Any = getattr(observer, "communication_log", None)

        scheduler = self._scheduler

        def observe(channel: str, value: Any, writer: Party | None, reader: Party | None) -> None:
            communication(scheduler.now, channel, value, _name_of(writer), _name_of(reader))

        def note(channel: str, value: Any, writer: Party | None, reader: Party | None) -> None:
            source = "" if writer is None or (process := writer.process) is None else process.name
            sink = "" if reader is None or (process := reader.process) is None else process.name
            log.extend((scheduler.now, channel, value, source, sink))

        logs = getattr(observer, "port_logs", None)
        if logs is not None:
            scheduler.port_logs = logs
        elif getattr(observer, "wants_communications", True):
            scheduler.observe = observe if log is None else note
            scheduler.sample_log = getattr(observer, "sample_log", None)
        scheduler.watcher = observer

    def _take_over(self, instant: int | None) -> None:
        """Takes over what arrived from outside before ``instant``."""
        now = self._clock.now()
        self._scheduler.now = max(self._scheduler.now, now if instant is None else min(now, instant - 1))
        self._devices.take_over()

    def _next_instant(self) -> int | None:
        tick = self._instants.after(self._scheduler.now)
        timer = self._scheduler.timers.next_instant()
        if tick is None or (timer is not None and timer < tick):
            return timer
        return tick

    def _meet(self, instant: int, present: int) -> None:
        late = self._clock.now() - instant
        for period in self._instants.periods_at(instant):
            self._jitter[period].add(late)
        self._scheduler.now = instant
        self._change_parameters(instant)
        self._instants.meet(instant, present)
        self._scheduler.timers.fall_due(instant)

    def _release(self) -> Sequence[BaseException]:
        """Hands over safe values, closes the drivers, and ends what is still running."""
        try:
            stopping.hold()
        except (HandlerFailed, KeyboardInterrupt):
            return self._release()  # A handler was faster; from now on none is called.
        if os.getpid() != self._process:
            # A child that a library has forked without Python's knowledge returns here: it does not own the outputs.
            os._exit(1)
        self._devices.watch.limits_steps = False
        self._scheduler.end()
        released, errors = self._devices.release()
        tell = getattr(self._observer, "released", None)
        if tell is not None:
            for port, value in released:
                tell(self._scheduler.now, port, value)
        try:
            self._devices.watch.iterations += 1
            self._devices.watch.limits_steps = True
            end_all(self._root)
        except RunFailed as failed:
            errors = [*errors, failed.error]
        finally:
            self._devices.watch.end()
        return errors


def _name_of(party: Party | None) -> str:
    """The process on whose behalf a party communicates; empty for the environment."""
    return "" if party is None or party.process is None else party.process.name


def _earlier(instant: int | None, other: int | None) -> int | None:
    """The earlier of two instants, either of which may be never."""
    if other is None or (instant is not None and instant <= other):
        return instant
    return other
