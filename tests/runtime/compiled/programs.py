"""Programs of generator functions like those of generated code, which touch the slots of rendezvous channels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cspdiag.runtime import Alternated, Dedicated, Fault, Network, Outcome, Rendezvous, Routine, Steps, Task, parallel

Body = Callable[[Task], Steps]
AnyChannel = Rendezvous[Any] | Dedicated[Any]
CHANNELS: list[type[AnyChannel]] = [Rendezvous, Dedicated]


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


def waits(channel: AnyChannel) -> bool:
    """Whether a writer waits in the channel."""
    return channel.offered is not None if isinstance(channel, Dedicated) else channel.writing is not None


def offer(me: Task, channel: AnyChannel, value: object) -> None:
    """Waits to write, without a look at the reader."""
    if isinstance(channel, Dedicated):
        channel.writer = me
    else:
        channel.writing = me
    channel.offered = value


def write(me: Task, channel: AnyChannel, value: object) -> Steps:
    if isinstance(channel, Dedicated):
        channel.writer = me
        if channel.value is None:
            channel.value = value
            me.scheduler.queue.append(channel.reader.entry)
        else:
            channel.offered = value
            yield
        return
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


def writer(channel: AnyChannel, *values: object) -> Body:
    def steps(me: Task) -> Steps:
        for value in values:
            yield from write(me, channel, value)

    return steps


def reader(channel: AnyChannel, got: list[Any], count: int) -> Body:
    if isinstance(channel, Dedicated):
        return dedicated_reader(channel, got, count)

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


def dedicated_reader(channel: Dedicated[Any], got: list[Any], count: int) -> Body:
    def steps(me: Task) -> Steps:
        channel.reader = me
        for _ in range(count):
            if channel.offered is not None:
                got.append(channel.offered)
                channel.offered = None
                me.scheduler.queue.append(channel.writer.entry)
            else:
                channel.value = None
                yield
                got.append(channel.value)

    return steps


def failing(message: str) -> Body:
    def steps(me: Task) -> Steps:
        yield from ()
        raise Fault(message)

    return steps
