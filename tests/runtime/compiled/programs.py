"""Programs of generator functions like those of generated code, which touch the slots of rendezvous channels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cspdiag.runtime import Alternated, Fault, Network, Outcome, Rendezvous, Routine, Steps, Task, parallel

Body = Callable[[Task], Steps]


class Program(Routine):
    """The outermost process, with the given body."""

    def __init__(self, body: Body) -> None:
        super().__init__("Top")
        self.body = body

    def steps(self, me: Task) -> Steps:
        self.start(me)
        try:
            yield from self.body(me)
        except BaseException as error:
            self.fail(me, error)
            raise
        self.end(me)


class CheckedProgram(Program):
    checked = True


def run(*branches: Body, program: type[Program] = Program, until: int | None = None) -> Outcome:
    def body(me: Task) -> Steps:
        me.scheduler.current = me
        yield from parallel(*branches)

    return Network(program(body)).run(until=until)


def write(me: Task, channel: Rendezvous[Any], value: object) -> Steps:
    reader = channel.reading
    if reader is not None:
        channel.reading = None
        channel.value = value
        me.scheduler.queue.append(reader.entry)
    else:
        channel.writing = me
        channel.offered = value
        if isinstance(channel, Alternated):
            guards = channel.selector
            guards.ready |= channel.bit
            if guards.armed & channel.bit:
                me.scheduler.current = me
                guards.wake()
        yield


def writer(channel: Rendezvous[Any], *values: object) -> Body:
    def steps(me: Task) -> Steps:
        for value in values:
            yield from write(me, channel, value)

    return steps


def reader(channel: Rendezvous[Any], got: list[Any], count: int) -> Body:
    def steps(me: Task) -> Steps:
        for _ in range(count):
            writing = channel.writing
            if writing is not None:
                channel.writing = None
                got.append(channel.offered)
                if isinstance(channel, Alternated):
                    channel.lower()
                me.scheduler.queue.append(writing.entry)
            else:
                channel.reading = me
                yield
                got.append(channel.value)

    return steps


def failing(message: str) -> Body:
    def steps(me: Task) -> Steps:
        yield from ()
        raise Fault(message)

    return steps
