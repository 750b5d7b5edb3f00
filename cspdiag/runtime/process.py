"""Processes and submodels: the base classes of what a program consists of."""

from __future__ import annotations

from collections.abc import Generator
from typing import TYPE_CHECKING, Any, TypeVar

from .kernel.exceptions import Cancelled, Fault, Place, ProcessError, fault_of, run_is_ended
from .kernel.executed import Executed
from .kernel.places import note_place, place_of
from .kernel.policy import compute_first
from .kernel.scheduler import Scheduler, present

if TYPE_CHECKING:
    from .channels.ports import In

E = TypeVar("E", bound="In[Any]")


class Process(Executed):
    """A process: ports, parts of its own, and a ``run`` that is its composition.

    ``await process`` runs it; it may be run again, never twice at the same time. ``name`` is its path from the
    outermost process, ``source`` the file and line where it was defined, ``enclosing`` the process that runs it.
    """

    def __init__(self, name: str, *, source: str | None = None) -> None:
        self.name = name
        self.source = source
        self.runs_now = False
        self.enclosing: Executed | None = None
        self.ends: list[In[Any]] = []
        """Reading ends of this process, closed when it ends."""

    async def run(self) -> None:
        """What the process does."""
        raise NotImplementedError(f"{type(self).__name__}.run")

    def owns(self, end: E) -> E:
        """Registers ``end`` to be closed when this process ends."""
        self.ends.append(end)
        return end

    def __await__(self) -> Generator[Any, None, None]:
        return self.execute().__await__()

    async def execute(self) -> None:
        """Runs the process once, and keeps account of the current process, its start and end, and its open ends."""
        if self.runs_now:
            raise Fault(
                f"{self.name} is already running; a process never runs twice at the same time",
                Place(self.name, self.source),
            )
        scheduler = present()
        task = scheduler.current
        if self.is_law and task.cancelled:
            raise Cancelled
        enclosing = self.enclosing = task.process
        task.process = self
        self.runs_now = True
        if scheduler.watcher is not None or scheduler.policy is not None:
            self.started(scheduler)
        try:
            await self.run()
        except ProcessError as error:
            if error.place is None:
                error.place = place_of(error, self)
            raise
        except ArithmeticError as error:
            raise fault_of(error, place_of(error, self)) from error
        except BaseException as error:
            note_place(error, self)
            raise
        finally:
            self.runs_now = False
            task.process = enclosing
            for end in self.ends:
                end.close()
            if scheduler.watcher is not None:
                self.ended(scheduler)
        if scheduler.policy is not None:
            compute_first(scheduler.policy, self)

    def started(self, scheduler: Scheduler) -> None:
        """Tells the observer."""
        if scheduler.watcher is not None:
            scheduler.watcher.process_started(scheduler.now, self.name, type(self).__name__)

    def ended(self, scheduler: Scheduler) -> None:
        """Tells the observer."""
        if scheduler.watcher is not None and not run_is_ended():
            scheduler.watcher.process_ended(scheduler.now, self.name)


class Submodel(Process):
    """A control law: one run reads all inputs at once, computes one sample, and writes all outputs at once.

    Subclasses have a ``calculate`` from inputs to outputs, and a ``run`` that is ``read_all``, ``calculate``,
    ``write_all``.
    """

    is_law = True

    def reset(self) -> None:
        """Puts the states back to their initial values."""

    def started(self, scheduler: Scheduler) -> None:
        """Observers are not notified: submodels run once a sample."""
        if scheduler.policy is not None:
            self.has_computed = False

    def ended(self, scheduler: Scheduler) -> None:
        """Observers are not notified: submodels run once a sample."""
