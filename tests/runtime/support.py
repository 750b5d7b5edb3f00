"""Programs from plain coroutine functions, and their traces."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from typing import Any

from cspdiag.runtime import Network, Observer, Outcome, Process
from cspdiag.runtime.outside.external import Port


class Body(Process):
    """A process made of a coroutine function."""

    def __init__(self, body: Callable[[], Awaitable[object]], name: str = "Top") -> None:
        super().__init__(name)
        self._body = body

    async def run(self) -> None:
        await self._body()


class Trace(Observer):
    def __init__(self) -> None:
        self.communications: list[tuple[int, str, Any]] = []
        self.partners: list[tuple[str, str]] = []
        self.activities: list[tuple[str, int, str]] = []

    def communication(self, time: int, channel: str, value: Any, writer: str, reader: str) -> None:
        self.communications.append((time, channel, value))
        self.partners.append((writer, reader))

    def process_started(self, time: int, path: str, class_name: str) -> None:
        self.activities.append(("started", time, path))

    def process_ended(self, time: int, path: str) -> None:
        self.activities.append(("ended", time, path))

    def group_started(self, time: int, path: str) -> None:
        self.activities.append(("group", time, path))

    def group_ended(self, time: int, path: str) -> None:
        self.activities.append(("group ended", time, path))


def run(body: Callable[[], Awaitable[object]], ports: Sequence[Port] = (), **options: Any) -> Outcome:
    return Network(Body(body), ports).run(**options)


def finish(body: Callable[[], Awaitable[object]], ports: Sequence[Port] = (), **options: Any) -> Outcome:
    """Runs a program that must terminate."""
    outcome = run(body, ports, **options)
    if outcome.error is not None:
        raise outcome.error
    assert outcome.ended == "terminated", outcome
    return outcome


def traced(
    body: Callable[[], Awaitable[object]], ports: Sequence[Port] = (), **options: Any
) -> list[tuple[int, str, Any]]:
    trace = Trace()
    finish(body, ports, observer=trace, **options)
    return trace.communications


class Scripted:
    """An environment that plays values: ``{port: {instant: value}}``, held in between, and notes the values written to
    it.
    """

    def __init__(self, script: dict[str, dict[int, Any]], outputs: Sequence[str] = (), step: int = 1_000_000) -> None:
        self.step = step
        self._script = script
        self._now = 0
        self.written: dict[str, list[tuple[int, Any]]] = {name: [] for name in outputs}
        self.drivers: dict[str, Any] = {name: _Source(values.get(0, 0)) for name, values in script.items()}
        self.drivers.update({name: _Sink(self, name) for name in outputs})

    def start(self) -> None:
        self.advance(0)

    def advance(self, now: int) -> None:
        self._now = now
        for name, values in self._script.items():
            due = [instant for instant in values if instant <= now]
            if due:
                self.drivers[name].value = values[max(due)]

    def note(self, name: str, value: Any) -> None:
        self.written[name].append((self._now, value))


class _Source:
    def __init__(self, value: Any) -> None:
        self.value = value

    def read(self) -> Any:
        return self.value


class _Sink:
    def __init__(self, environment: Scripted, name: str) -> None:
        self._environment = environment
        self._name = name

    def write(self, value: Any) -> None:
        self._environment.note(self._name, value)
