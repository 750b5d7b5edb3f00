"""What is recorded while a program runs."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from cspdiag.simulate.record.history import History, histories_of, series

if TYPE_CHECKING:
    from cspdiag.model.types import Type


class Communication(NamedTuple):
    """A value that was passed: the time in nanoseconds, the channel's hierarchical name, the writer and the reader."""

    time: int
    channel: str
    value: object
    writer: str
    reader: str


class Activity(NamedTuple):
    """A process or a named group from its start to its end, in nanoseconds; ``end`` is None while it runs."""

    path: str
    kind: str
    start: int
    end: int | None


class ExecutionTime(NamedTuple):
    """The longest step that was measured, in nanoseconds, and the number of steps.

    ``what`` was measured: a ``law``, for which a sample is a step; a ``process`` with its laws, or a ``thread`` with
    everything inlined in it, for which a step is what runs from one wait to the next.
    """

    longest: int
    steps: int
    what: Literal["law", "process", "thread"]


class Recorder:
    """The observer of a run: records communications, if requested, and processes and groups, in the order in which they
    happen.

    With ``ports``, the types of external ports by hierarchical name, only what a recording has of them is noted, as
    numbers, which is faster and takes less memory.
    """

    def __init__(self, *, communications: bool = True, ports: Mapping[str, Type] | None = None) -> None:
        self.wants_communications = communications
        self.port_logs = None if ports is None else {name: (array("q"), series(kind)) for name, kind in ports.items()}
        """The instants and the values of each port."""
        self.communication_log: list[Any] = []
        """Five entries for each communication, as in ``Communication``: making a tuple for each would take longer than
        the communication.
        """
        self.sample_log: list[Any] = []
        """Three entries for each sample of a sampled input, read or not: time, port, value."""
        self.releases: list[tuple[int, str, object]] = []
        self.changes: list[tuple[int, str, tuple[int, ...], object]] = []
        """The changes of parameters of the program: time in nanoseconds, parameter, positions of the part, value."""
        self.on_change: Callable[[int, str, tuple[int, ...], object], object] | None = None
        """What is called at each change, too."""
        self.refused: list[tuple[int, str, str]] = []
        """Changes that were not made: time in nanoseconds, parameter, why, if that is known."""
        self.variables: dict[str, list[tuple[int, float]]] = {}
        self.execution_times: dict[str, ExecutionTime] = {}
        self.activities: list[Activity] = []
        """In order of their starts; those that still run have no end."""
        self.running: dict[str, int] = {}
        """The positions in ``activities`` of what is running, by path."""

    @property
    def communications(self) -> Iterator[tuple[int, str, object, str, str]]:
        """All communications in order, each as the fields of ``Communication``."""
        log = iter(self.communication_log)
        return zip(log, log, log, log, log, strict=True)

    @property
    def samples(self) -> Iterator[tuple[int, str, object]]:
        """All samples in order: time in nanoseconds, port, value."""
        log = iter(self.sample_log)
        return zip(log, log, log, strict=True)

    def histories(self, types: Mapping[str, Type]) -> Mapping[str, History]:
        """See ``Passed.histories``."""
        if self.port_logs is not None:
            passed = {name: History(*log, array("q")) for name, log in self.port_logs.items()}
            return {name: history for name, history in passed.items() if len(history.time)}
        return histories_of(self.communications, self.samples)

    def communication(self, time: int, channel: str, value: object, writer: str, reader: str) -> None:
        """A value was passed through a channel or an external port."""
        self.communication_log += (time, channel, value, writer, reader)

    def sampled(self, time: int, port: str, value: object) -> None:
        """A sampled input has a new sample, which is a communication only if a process reads it."""
        self.sample_log += (time, port, value)

    def released(self, time: int, port: str, value: object) -> None:
        """An output was set to its safe value at the end of the run; that is not a communication."""
        self.releases.append((time, port, value))

    def changed(self, time: int, parameter: str, path: tuple[int, ...], value: object) -> None:
        """A parameter of the program, or a part of it, has a new value."""
        self.changes.append((time, parameter, path, value))
        if self.on_change is not None:
            self.on_change(time, parameter, path, value)

    def refused_change(self, time: int, parameter: str, reason: str) -> None:
        """A change was not made."""
        self.refused.append((time, parameter, reason))

    def variable_written(self, time: int, name: str, value: float) -> None:
        """A probed variable was given a value."""
        self.variables.setdefault(name, []).append((time, value))

    def process_started(self, time: int, path: str, kind: str) -> None:
        """A process of class ``kind`` begins."""
        self.running[path] = len(self.activities)
        self.activities.append(Activity(path, kind, time, None))

    def process_ended(self, time: int, path: str) -> None:
        """A process ended, successfully or not."""
        position = self.running.pop(path, None)
        if position is not None:
            self.activities[position] = self.activities[position]._replace(end=time)

    def execution_time(
        self, path: str, longest: int, steps: int = 1, what: Literal["law", "process", "thread"] = "law"
    ) -> None:
        """Note the longest step; earlier measurements are kept."""
        known = self.execution_times.get(path, ExecutionTime(0, 0, what))
        self.execution_times[path] = ExecutionTime(max(known.longest, longest), known.steps + steps, what)

    def group_started(self, time: int, path: str) -> None:
        """A named group begins."""
        self.process_started(time, path, "")

    def group_ended(self, time: int, path: str) -> None:
        """A named group ended."""
        self.process_ended(time, path)
