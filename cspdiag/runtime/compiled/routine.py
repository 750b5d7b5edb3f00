"""Optimized processes: generator functions that the scheduler resumes directly.

The code of a process and of all that was flattened into it is one generator, and so is that of each of its parallel
branches. Its first argument is the task that executes it.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from types import FrameType
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from ..kernel.exceptions import ProcessError, fault_of, run_is_ended
from ..kernel.executed import Executed
from ..kernel.party import Entry, Waits
from ..kernel.places import note_place, place_of
from ..kernel.scheduler import Join, Task, present
from .direct import SPENT, DirectScheduler
from .numbered import Names, name_of
from .rendezvous import Slots

if TYPE_CHECKING:
    from ..channels.ports import In

E = TypeVar("E", bound="In[Any]")

Steps: TypeAlias = Generator[None, None, None]
"""The run of an optimized process; it yields where it waits."""


class Part(Executed):
    """What is executed: a process with code of its own, or a process or a control law that is executed by the code
    around it.

    ``name`` is its path. ``kind`` is its class in the text, or "" for a control law, of which observers are not
    notified; ``source`` is the file and line of its definition. ``ends`` are its reading ends, closed when it ends.
    """

    __slots__ = ("_enclosing", "ends", "name")

    kind: str

    def __init__(self, name: str) -> None:
        self.name = name
        self.ends: tuple[In[Any], ...] = ()
        self._enclosing: Any = None

    def owns(self, end: E) -> E:
        """Registers ``end`` to be closed when this process ends."""
        self.ends = (*self.ends, end)
        return end

    def start(self, me: Task) -> None:
        """From now on ``me`` executes this process."""
        self._enclosing = me.process
        me.process = self
        scheduler = me.scheduler
        if scheduler.watcher is not None:
            scheduler.watcher.process_started(scheduler.now, self.name, self.kind)

    def end(self, me: Task) -> None:
        """The process has ended, in whatever way."""
        me.process = self._enclosing
        for end in self.ends:
            end.close()
        scheduler = me.scheduler
        if scheduler.watcher is not None and not run_is_ended():
            scheduler.watcher.process_ended(scheduler.now, self.name)

    def fail(self, me: Task, error: BaseException) -> None:
        """The process is ended by ``error``, which is given its place. Raises another exception if that describes the
        error better.
        """
        try:
            self.blame(error)
        finally:
            self.end(me)

    def blame(self, error: BaseException) -> None:
        """Gives an error that leaves this process its place. Raises a Fault in place of an error of Python's
        arithmetic.
        """
        if isinstance(error, ProcessError):
            if error.place is None:
                error.place = place_of(error, self)
        elif isinstance(error, ArithmeticError):
            raise fault_of(error, place_of(error, self)) from error
        else:
            note_place(error, self)


class Inlined(Part):
    """A process or a control law whose code is part of the code of another process."""

    __slots__ = ("kind", "source")

    def __init__(self, name: str, kind: str = "", *, source: str | None = None) -> None:
        super().__init__(name)
        self.kind = kind
        self.source = source


class Routine(Part):
    """A process with code of its own: ``steps``.

    ``checked``: whether the code checks before each communication if it was cancelled; otherwise it is abandoned where
    it is. ``tracked``, of the outermost process: whether the program has parts written by hand, which need to know
    which process runs, or levels of priority.
    """

    __slots__ = ()

    kind = ""
    source: str | None = None
    checked = False
    tracked = False

    def steps(self, me: Task) -> Steps:
        """What the process does."""
        raise NotImplementedError


class Numbered(Routine):
    """A process that may be an element of an array; ``label`` is its name, or the names of the array."""

    __slots__ = ("label",)

    label: str | Names

    @property
    def name(self) -> str:
        """Its path from the outermost process."""
        return name_of(self)

    @name.setter
    def name(self, name: str) -> None:
        self.label = name


Branch: TypeAlias = "Routine | Callable[[Task], Steps]"
"""What an optimized process can run in parallel with others."""


class RoutineTask(Task):
    """A task that executes optimized code.

    That code does not note in ``waiting`` at which rendezvous it waits: these are found among the variables of the code
    when they are needed.
    """

    __slots__ = ()

    def __init__(self, branch: Branch, join: Join, parent: Task | None) -> None:
        steps = branch.steps if isinstance(branch, Routine) else branch
        super().__init__(steps(self), join, parent)

    def _is_resumed(self) -> None:
        scheduler, generator = self.scheduler, cast("Steps", self.coroutine)
        if isinstance(scheduler, DirectScheduler):
            scheduler.tasks[generator] = self
            self.entry = generator
        else:
            super()._is_resumed()

    def cancel(self) -> None:
        """See ``Task.cancel``; from now on it is not resumed directly."""
        if not self.ended:
            self.entry = self
            super().cancel()

    def _cancel_ready(self) -> None:
        self.resume = self._abandon
        self._takes_place(others=SPENT)

    def _takes_place(self, others: Entry) -> None:
        """Takes the last place of its generator in the ready queue; ``others`` take those before it."""
        if isinstance(self.scheduler, DirectScheduler):
            self.scheduler.displaced[self.coroutine] = self, others

    def withdraw(self) -> bool:
        """Removes the task from where it waits; False if it does not wait."""
        waits = False
        for channel in self._channels():
            waits |= channel.withdraw(self)
        if waits:
            self._forget_done()
        return waits or super().withdraw()

    def _forget_done(self) -> None:
        """Removes it from the ready queue, into which communications that are done may have put it if several were
        offered at once.
        """
        scheduler, queue = self.scheduler, self.ready_queue
        if isinstance(scheduler, DirectScheduler) and scheduler.current is not self:
            scheduler.displaced[self.coroutine] = SPENT, SPENT
            return
        for position, entry in enumerate(queue):
            if entry is self:
                queue[position] = SPENT

    def waits(self) -> Waits:
        """What the task waits for."""
        channels = [channel for channel in self._channels() if channel.holds(self)]
        if channels:
            return tuple([wait for channel in channels for wait in channel.waits_for(self)])
        return super().waits()

    def _channels(self) -> Iterator[Slots[Any]]:
        """The rendezvous channels that its code can see, each once."""
        seen: dict[int, Slots[Any]] = {}
        generator: Any = self.coroutine
        while generator is not None:
            frame: FrameType | None = getattr(generator, "gi_frame", None)
            for value in () if frame is None else frame.f_locals.values():
                if value is self.ready_queue:
                    continue  # There are only parties in it, and many.
                for item in value if isinstance(value, list | tuple) else (value,):
                    if isinstance(item, Slots):
                        seen[id(item)] = item
            generator = getattr(generator, "gi_yieldfrom", None)
        yield from seen.values()


class CheckedTask(RoutineTask):
    """A task that executes code that is ``checked``."""

    __slots__ = ()

    def _cancel_ready(self) -> None:
        self.resume = self._run_until_communication
        self._takes_place(others=self)  # Its code counts the communications that are done.


def routine_task(branch: Branch, join: Join, parent: Task | None) -> RoutineTask:
    """What executes ``branch``."""
    checked = branch.checked if isinstance(branch, Routine) else isinstance(parent, CheckedTask)
    return (CheckedTask if checked else RoutineTask)(branch, join, parent)


def start_group(me: Task, label: str) -> str:
    """Begins a labelled part, for traces and progress; returns its path."""
    path = label if me.process is None else f"{me.process.name}.{label}"
    scheduler = me.scheduler
    if scheduler.watcher is not None:
        scheduler.watcher.group_started(scheduler.now, path)
    return path


def end_group(path: str) -> None:
    """A labelled part has ended, in whatever way."""
    scheduler = present()
    if scheduler.watcher is not None and not run_is_ended():
        scheduler.watcher.group_ended(scheduler.now, path)
