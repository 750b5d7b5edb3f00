"""Where processes halt in a replay: before each communication, delay and choice, until the trace has come to it.

Between two gates a process runs as always, on the same runtime. So a replay changes nothing but the order in which processes get on, and what each alternative
chooses: it is one of the runs that the program can have when its processes take any time.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any, Literal

from cspdiag.runtime.composition import Branches
from cspdiag.runtime.exceptions import Cancelled
from cspdiag.runtime.process import Process
from cspdiag.runtime.scheduler import Party, Priority, Task, Waits, scheduler
from cspdiag.runtime.selector import Selector

__package__ = Process.__module__.rpartition(".")[0]
"""That of the runtime: places of processes are looked for outside of it."""

Action = Literal["read", "write", "ready", "wait", "after", "skip"]


@dataclass(frozen=True)
class Option:
    """Something that a process at a gate can go on with; ``index`` tells options of one gate apart.

    ``ready`` is a guard that leaves the reading to the guarded process, ``wait`` a delay, ``after`` a time-out, ``skip`` the guard that is always ready. ``duration``, in
    nanoseconds, belongs to ``wait`` and ``after``.
    """

    action: Action
    channel: str = ""
    index: int = 0
    duration: int = 0


class Gate:
    """A task that halts; what it may go on with, in text order. ``selector`` is that of a prioritized alternative."""

    def __init__(
        self, task: Task, options: tuple[Option, ...], selector: Selector | None, halted: dict[Task, Gate]
    ) -> None:
        self.task = task
        self.options = options
        self.prioritized = selector is not None
        self._selector = selector
        self.chosen: Option | None = None
        self._halted = halted

    @property
    def path(self) -> str:
        """The process that halts here."""
        return "" if self.task.process is None else self.task.process.name

    @property
    def names(self) -> tuple[str, ...]:
        """What a trace may call it: its process, or so many a branch of that."""
        return names_of(self.task)

    @property
    def priority(self) -> Priority:
        """The level of priority of the task."""
        return self.task.priority

    def is_ready(self, option: Option) -> bool:
        """Whether the other side of a guard of a prioritized alternative has come already."""
        communicates = option.action in {"read", "write", "ready"}
        return communicates and self._selector is not None and bool(self._selector.ready >> option.index & 1)

    def withdraw(self, party: Party) -> bool:
        """See ``Waiting.withdraw``."""
        self._halted.pop(self.task, None)
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``Waiting.waits_for``."""
        return tuple((f"to {option.action} {option.channel}".rstrip(), None) for option in self.options)


def names_of(task: Task) -> tuple[str, ...]:
    """The path of the process that a task executes, and its number among the parallel branches of that."""
    path = "" if task.process is None else task.process.name
    join = task.join
    while isinstance(join, Branches) and len(join.tasks) == 1:
        join = join._parent.join
    if not isinstance(join, Branches):
        return (path,)
    return path, *(f"{path}.{number}" for number, branch in enumerate(join.tasks, start=1) if branch is task)


@dataclass
class Interruption:
    """An interrupt whose body runs: ``fire`` abandons the body at the gate at which it halts."""

    task: Task
    options: tuple[Option]
    fire: Callable[[], None]

    @property
    def names(self) -> tuple[str, ...]:
        """What a trace may call it: its process, or so many a branch of that."""
        return names_of(self.task)

    @property
    def path(self) -> str:
        """The process whose interrupt it is."""
        return "" if self.task.process is None else self.task.process.name


@dataclass
class Conductor:
    """Who halts where, and what comes from outside; ``free`` lets everybody through, as in any other run."""

    halted: dict[Task, Gate] = field(default_factory=dict)
    interruptions: list[Interruption] = field(default_factory=list)
    supplied: dict[str, Any] = field(default_factory=dict)
    """The value that the environment offers next, by port; an exception stands for a sample that was missed."""
    done: list[tuple[str, str]] = field(default_factory=list)
    """Communications since it was emptied: direction and channel."""
    free: bool = False
    ready_bits: list[tuple[Selector, int]] = field(default_factory=list)

    def reset(self) -> None:
        """Forget everything, for a new run."""
        self.__init__()  # type: ignore[misc]

    def hold(self, *options: Option, selector: Selector | None = None) -> Generator[None, None, Option | None]:
        """Halts the current task until one of the options is its turn; None in a run that is not conducted. See ``Gate``."""
        task = scheduler.current
        if task.cancelled:
            raise Cancelled
        if self.free:
            return None
        gate = self.halted[task] = Gate(task, options, selector, self.halted)
        task.waiting = gate
        yield
        return gate.chosen

    def release(self, gate: Gate, option: Option | None) -> None:
        """Lets a task through."""
        del self.halted[gate.task]
        gate.chosen = option
        scheduler.enqueue(gate.task)

    def go_free(self) -> None:
        """From now on nobody halts, and nothing comes from outside any more."""
        self.free = True
        for selector, bit in self.ready_bits:
            selector.ready &= ~bit


conductor = Conductor()
"""That of the one run that there is at a time, as ``scheduler`` is."""
