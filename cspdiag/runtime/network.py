"""A network: the outermost process with its external ports, which can be run."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from typing import Literal

from .advance.run import NetworkRun
from .compiled.direct import DirectScheduler
from .compiled.routine import Routine
from .kernel.clock import Clock, RealClock, VirtualClock
from .kernel.observer import Observer
from .kernel.parameters import ProgramParameters
from .kernel.policy import Policy
from .kernel.scheduler import Scheduler
from .kernel.stopping import stopping
from .outcome import Outcome
from .outside.external import Port
from .outside.instants import Environment
from .process import Process


class Network:
    """A program that can be run: its outermost process and its external ports, in the order of their declaration."""

    def __init__(
        self, process: Process | Routine, ports: Sequence[Port] = (), parameters: ProgramParameters | None = None
    ) -> None:
        self.process = process
        self.ports = tuple(ports)
        self.parameters = ProgramParameters() if parameters is None else parameters
        self._scheduler: Scheduler | None = None
        self._runs = False

    @property
    def now(self) -> int:
        """The present instant in nanoseconds, or that of the last run; another thread may read it."""
        return 0 if self._scheduler is None else self._scheduler.now

    @property
    def over(self) -> bool:
        """Whether the last run has simulated all that it will; it may still report a deadlock and release outputs.
        Another thread may read it.
        """
        return self._scheduler is not None and self._scheduler.over

    def run(
        self,
        environment: Environment | None = None,
        *,
        until: int | None = None,
        real_time: bool = False,
        on_miss: Literal["timeout", "count"] = "timeout",
        observer: Observer | None = None,
        policy: Policy | None = None,
    ) -> Outcome:
        """Runs the program to its end, or to ``until`` (an instant in nanoseconds).

        In virtual time only delays and ticks take time; with ``real_time`` it runs against the clock. Exceptions that
        the program raises, and signals (``stopping``), are part of the outcome. A ``policy`` decides what the language
        leaves open. Other networks may run at the same time, in other threads or inside a process of this one. Raises
        ValueError for a policy in real time or for optimized code, and RuntimeError if this network is already running.
        """
        if policy is not None and (real_time or isinstance(self.process, Routine)):
            raise ValueError("a policy leads runs in virtual time, of code without optimization (-O0)")
        if self._runs:
            raise RuntimeError("this network is running already")
        self._runs = True
        try:
            with self.new_scheduler(policy) as scheduler:
                self._scheduler = scheduler
                clock = RealClock() if real_time else VirtualClock()
                run = self.new_run(scheduler, environment, clock, until, on_miss, observer)
                with stopping if run.driven else nullcontext():
                    return run.outcome()
        finally:
            self._runs = False

    def new_run(
        self,
        scheduler: Scheduler,
        environment: Environment | None,
        clock: Clock,
        until: int | None,
        on_miss: Literal["timeout", "count"],
        observer: Observer | None,
    ) -> NetworkRun:
        """A run that has not begun; the scheduler is entered."""
        return NetworkRun(self, scheduler, environment, clock, until, on_miss, observer)

    def new_scheduler(self, policy: Policy | None) -> Scheduler:
        """A scheduler for one run."""
        if isinstance(self.process, Routine) and not self.process.tracked:
            return DirectScheduler()
        return Scheduler(policy)
