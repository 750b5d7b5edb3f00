"""Where processes halt in a replay: before each communication, delay and choice, until the trace has come to it.

Between two gates a process runs as always, on the same runtime. So a replay changes nothing but the order in which
processes get on, and what each alternative chooses: it is one of the runs that the program can have when its processes
take any time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from cspdiag.base.record import record
from cspdiag.runtime.channels.selector import Selector
from cspdiag.runtime.kernel.exceptions import Cancelled
from cspdiag.runtime.kernel.scheduler import Party, Task, Waits, scheduler
from cspdiag.runtime.process import Process
from cspdiag.verify.guided.script import Passed
from cspdiag.verify.runs.task_names import TaskNames, path_of

__package__ = Process.__module__.rpartition(".")[0]
"""That of the runtime: places of processes are looked for outside of it."""

Action = Literal["read", "write", "ready", "wait", "after", "skip"]


@record
class Option:
    """Something that a process at a gate can go on with; ``index`` tells options of one gate apart.

    ``ready`` is a guard that leaves the reading to the guarded process, ``wait`` a delay, ``after`` a time-out,
    ``skip`` the guard that is always ready. ``duration``, in nanoseconds, belongs to ``wait`` and ``after``, ``value``
    to ``write``.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset({"value"})

    action: Action
    channel: str = ""
    index: int = 0
    duration: int = 0
    value: Any = None


class Gate:
    """A task that halts; what it may go on with, in text order. ``together``: with all of it, in any order."""

    def __init__(
        self, task: Task, options: tuple[Option, ...], halted: dict[Task, Gate], *, together: bool = False
    ) -> None:
        self.task = task
        self.options = options
        self.together = together
        self.chosen: Option | None = None
        self._halted = halted

    @property
    def path(self) -> str:
        """The process that halts here."""
        return path_of(self.task)

    @property
    def names(self) -> tuple[str, ...]:
        """What a trace may call it: its process, or so many a branch of that."""
        return conductor.names.told(self.task)

    def withdraw(self, party: Party) -> bool:
        """See ``Waiting.withdraw``."""
        self._halted.pop(self.task, None)
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        return tuple((f"to {option.action} {option.channel}".rstrip(), None) for option in self.options)


@dataclass
class Interruption:
    """An interrupt whose body runs: ``fire`` takes the guard and abandons the body at the gate at which it halts;
    ``abandon`` leaves the guard to wait.
    """

    task: Task
    options: tuple[Option]
    fire: Callable[[], None]
    abandon: Callable[[], None]

    @property
    def names(self) -> tuple[str, ...]:
        """What a trace may call it: its process, or so many a branch of that."""
        return conductor.names.told(self.task)

    @property
    def path(self) -> str:
        """The process whose interrupt it is."""
        return path_of(self.task)


@dataclass
class Conductor:
    """Who halts where, and what comes from outside; ``free`` lets everybody through, as in any other run."""

    halted: dict[Task, Gate] = field(default_factory=dict)
    interruptions: list[Interruption] = field(default_factory=list)
    supplied: dict[str, Any] = field(default_factory=dict)
    """The value that the environment offers next, by port; an exception stands for a sample that was missed."""
    done: list[tuple[str, str]] = field(default_factory=list)
    """Communications since it was emptied: direction and channel."""
    passed: list[Passed] = field(default_factory=list)
    """All that processes have gone on with."""
    names: TaskNames = field(default_factory=TaskNames)
    free: bool = False
    ready_bits: list[tuple[Selector, int]] = field(default_factory=list)
    _last: dict[tuple[Task, str], Passed] = field(default_factory=dict)

    def reset(self) -> None:
        """Forget everything, for a new run."""
        self.__init__()  # type: ignore[misc]

    def hold(self, *options: Option, together: bool = False) -> Generator[None, None, Option | None]:
        """Halts the current task until one of the options is its turn; None in a run that is not conducted. See
        ``Gate``.
        """
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        if self.free:
            return None
        gate = self.halted[task] = Gate(task, options, self.halted, together=together)
        task.waiting = gate
        yield
        return gate.chosen

    def release(self, gate: Gate, option: Option | None) -> None:
        """Lets a task through."""
        del self.halted[gate.task]
        gate.chosen = option
        if option is not None:
            self.note(gate.task, option, together=gate.together)
        scheduler.enqueue(gate.task)

    def note(self, task: Task, option: Option, *, together: bool = False) -> None:
        """A task goes on with an option; one that leaves the reading to what follows is told with that."""
        if option.action == "ready":
            return
        duration = option.duration
        entry = Passed(
            self.names.key(task),
            path_of(task),
            option.action,
            option.channel,
            option.index,
            duration,
            together,
            name=self.names.called(task),
        )
        self.passed.append(entry)
        self._last[task, option.channel] = entry

    def took(self, task: Task, channel: str) -> Any:
        """The value, or the exception, that the environment supplies to a task that reads."""
        value = self.supplied.get(channel)
        entry = self._last.get((task, channel))
        if entry is not None:
            entry.value = value
            if isinstance(value, BaseException):
                entry.action = "miss"
        return value

    def go_free(self) -> None:
        """From now on nobody halts, and nothing comes from outside any more."""
        self.free = True
        for selector, bit in self.ready_bits:
            selector.ready &= ~bit


conductor = Conductor()
"""That of the one run that there is at a time, as ``scheduler`` is."""
