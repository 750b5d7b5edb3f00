"""Where processes halt in a replay: before each communication, delay and choice, until the trace has reached it.

Between two gates a process runs on the runtime as in any run. So a replay only determines the order in which processes
continue, and what each alternative chooses: it is one of the runs that the program can have if its processes take any
time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, assert_never

from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.kernel.durations import shown
from cspdiag.runtime.kernel.party import Party, Waits
from cspdiag.runtime.kernel.policy import Interruption as LedInterrupt
from cspdiag.runtime.kernel.policy import Option, Policy
from cspdiag.runtime.kernel.scheduler import Task
from cspdiag.runtime.outside.supply import Supply
from cspdiag.verify.guided.script import Passed
from cspdiag.verify.runs.task_names import TaskNames, path_of, task_of


class Gate:
    """A task that halts, and the options with which it may continue, in text order. ``together``: with all of them, in
    any order. ``number``: gates count in the order in which tasks halted.
    """

    def __init__(
        self, conductor: Conductor, task: Task, options: tuple[Option, ...], *, number: int, together: bool
    ) -> None:
        self.task = task
        self.number = number
        self.options = options
        self.together = together
        self.chosen: Option | None = None
        self._conductor = conductor

    @property
    def path(self) -> str:
        """The process that halts here."""
        return path_of(self.task)

    @property
    def names(self) -> tuple[str, ...]:
        """Its possible names in a trace: its process, or a numbered branch of that."""
        return self._conductor.names.possible_names(self.task)

    def withdraw(self, party: Party) -> bool:
        """See ``Waitable.withdraw``."""
        self._conductor.forget(self.task)
        return True

    def waits_for(self, party: Party) -> Waits:
        """See ``Waitable.waits_for``."""
        return tuple((_words(option), None) for option in self.options)


def _keys(gate: Gate) -> set[tuple[str, str | None]]:
    """Where a gate is found again: its actions on each channel, and on any."""
    return {(option.action, channel) for option in gate.options for channel in (option.channel, None)}


def _words(option: Option) -> str:
    """What a task waits for at a gate, in the words of the runtime for a task that waits for it."""
    match option.action:
        case "read" | "ready":
            return f"to read {option.channel}"
        case "write":
            return f"to write {option.channel}"
        case "wait":
            return f"in `wait {shown(option.duration)}`"
        case "after":
            return f"after {shown(option.duration)}"
        case "skip":
            return "skip"
        case _:
            assert_never(option.action)


class Interruption:
    """An interrupt whose body is running."""

    def __init__(self, conductor: Conductor, led: LedInterrupt) -> None:
        self.task = task_of(led.task)
        self.options = (led.option,)
        self._conductor = conductor
        self._led = led

    def fire(self) -> None:
        """Takes the guard, and abandons the body at the gate at which it halts."""
        self._conductor.note(self.task, self.options[0])
        self._led.come(taken=True)

    def abandon(self) -> None:
        """Abandons the body, and leaves the guard to wait."""
        self._led.come(taken=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Its possible names in a trace: its process, or a numbered branch of that."""
        return self._conductor.names.possible_names(self.task)

    @property
    def path(self) -> str:
        """The process whose interrupt it is."""
        return path_of(self.task)


class Conductor(Policy):
    """Which tasks halt where, and what arrives from outside; ``free`` lets all tasks through, as in any other run."""

    leads_interrupts = True

    run: StepwiseRun
    """That which it leads."""

    def __init__(self) -> None:
        self.halted: dict[Task, Gate] = {}
        self.outside = Outside(self)
        self.done: list[tuple[str, str]] = []
        """Communications since it was emptied: direction and channel."""
        self.passed: list[Passed] = []
        """All that processes have continued with."""
        self.names = TaskNames()
        self.free = False
        self._interruptions: dict[LedInterrupt, Interruption] = {}
        self._halts = 0
        self._offering: dict[tuple[str, str | None], dict[Task, Gate]] = {}
        self._last: dict[tuple[Task, str], Passed] = {}

    @property
    def interruptions(self) -> list[Interruption]:
        """The interrupts whose bodies are running."""
        return list(self._interruptions.values())

    def halt(self, task: Party, options: Sequence[Option], *, together: bool) -> Gate | None:
        """See ``Policy.halt``."""
        if self.free:
            return None
        halting = task_of(task)
        self.forget(halting)
        self._halts += 1
        gate = self.halted[halting] = Gate(self, halting, tuple(options), number=self._halts, together=together)
        for key in _keys(gate):
            self._offering.setdefault(key, {})[halting] = gate
        return gate

    def forget(self, task: Task) -> None:
        """A task halts no more."""
        gate = self.halted.pop(task, None)
        for key in _keys(gate) if gate is not None else ():
            del self._offering[key][task]

    def offering(self, actions: Sequence[str], channel: str | None) -> list[Gate]:
        """The gates at which a task may continue with one of these actions, on a channel or on any, in the order in
        which tasks halted.
        """
        found = {task: gate for action in actions for task, gate in self._offering.get((action, channel), {}).items()}
        return sorted(found.values(), key=lambda gate: gate.number)

    def did(self, task: Party, option: Option) -> None:
        """See ``Policy.did``."""
        self.done.append((option.action, option.channel))

    def interrupt_begins(self, interruption: LedInterrupt) -> None:
        """See ``Policy.interrupt_begins``."""
        self._interruptions[interruption] = Interruption(self, interruption)

    def interrupt_ends(self, interruption: LedInterrupt) -> None:
        """See ``Policy.interrupt_ends``."""
        del self._interruptions[interruption]

    def release(self, gate: Gate, option: Option | None) -> None:
        """Lets a task through."""
        self.forget(gate.task)
        gate.chosen = option
        if option is not None:
            self.note(gate.task, option, together=gate.together)
        self.run.ready(gate.task)

    def note(self, task: Task, option: Option, *, together: bool = False) -> None:
        """Notes that a task continues with an option; a guard that leaves the reading to what follows is noted with
        that.
        """
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

    def took(self, task: Task, channel: str, value: Any) -> None:
        """A task has read what the environment offers; an exception means a missed sample."""
        self.done.append(("read", channel))
        entry = self._last.get((task, channel))
        if entry is not None:
            entry.value = value
            if isinstance(value, BaseException):
                entry.action = "miss"

    def let_all_through(self) -> None:
        """From now on no task halts, and nothing more arrives from outside."""
        self.free = True
        self.outside.run_dry()


class Outside(Supply):
    """What the environment offers next, by port; an exception means a missed sample."""

    def __init__(self, conductor: Conductor) -> None:
        super().__init__()
        self.offered: dict[str, Any] = {}
        self._conductor = conductor

    def value(self, port: str, reader: Task) -> Any:
        """See ``Supply.value``."""
        value = self.offered.get(port)
        self._conductor.took(reader, port, value)
        if isinstance(value, BaseException):
            raise value
        return value
