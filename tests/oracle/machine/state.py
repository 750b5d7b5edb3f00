"""The state of a running program: what is copied, hashed and searched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from tests.oracle.programs.tree import Value

Tid = tuple[tuple[int, int], ...]  # a thread: the parallel (its number) and branch that started it, from the root
Signal = tuple["Value | None", ...]  # what a thread does when it runs
CANCELLATION = (-1, 0)  # after the place of a thread in the ready queue: its cancellation


class Op(NamedTuple):
    """One communication that a thread performs."""

    channel: str
    end: str  # `?` or `!`
    value: Value | None  # what is written, or what was read
    seq: int
    done: bool = False
    pending: tuple[int, ...] = ()  # of a broadcast: the ends that have not taken it yet
    session: int = 0  # of a sampled input: the number of its session


class Offer(NamedTuple):
    """A guard whose condition is true, as it was when its alternative or interrupt began."""

    place: int
    kind: str  # read, write, after, skip, ready
    channel: str
    value: Value | None
    due: int
    seq: int
    session: int = 0  # of a sampled input: the number of its session


class Joint(NamedTuple):
    """Waits until all of its communications are complete."""

    ops: tuple[Op, ...]


class Choice(NamedTuple):
    """Waits for one of its guards."""

    node: int
    offers: tuple[Offer, ...]


class Delay(NamedTuple):
    due: int
    seq: int


class Stopped(NamedTuple):
    pass


class Branches(NamedTuple):
    """Waits for its branches."""

    node: int
    running: tuple[int, ...]
    failed: str | None
    cancelled: bool


Waiting = Joint | Choice | Delay | Stopped | Branches


class Frame(NamedTuple):
    """What is to be done later: `seq` (at a step), `mu`, `while`, `catch`, `intr`, `comm`, `guard`, `law-in`,
    `law-out`.
    """

    kind: str
    node: int
    at: int = 0
    offer: Offer | None = None  # the guard of an interrupt
    status: str = ""  # of an interrupt: off, armed, fired, chosen
    value: Value | None = None


@dataclass(slots=True)
class Thread:
    tid: Tid
    priority: tuple[int, ...]
    branch: int
    stack: tuple[Frame, ...]
    signal: Signal
    wait: Waiting | None = None
    cancel: bool = False  # to end at its next place

    def copy(self) -> Thread:
        return Thread(self.tid, self.priority, self.branch, self.stack, self.signal, self.wait, self.cancel)


SessionKey = tuple[int, str, int]  # the process, the port, and which of the sessions that the process has for it


class Session(NamedTuple):
    """What a process knows of a sampled input that it follows."""

    fresh: bool
    missed: bool
    ticked: bool  # there has been a tick since it was opened


@dataclass(slots=True)
class State:
    now: int
    threads: dict[Tid, Thread]
    ready: list[Tid]
    variables: dict[str, Value]
    buffers: dict[str, tuple[Value, ...]]
    laws: dict[str, tuple[Value, ...]]
    chosen: dict[int, int]  # which guard a fair alternative chose last
    sessions: dict[SessionKey, Session]
    samples: dict[str, Value]  # of the latest tick
    offered: dict[str, Value]  # what the environment offered last
    events: dict[str, Value]  # offered but not read yet
    latches: dict[str, Value]
    seq: int = 0
    ended: str | None = None
    running: Tid | None = None  # in the middle of a loop that does not wait
    missed: bool = False  # a sample was overwritten before it was taken, in some process
    timeout: bool = False  # a `Timeout` was raised

    def copy(self) -> State:
        return State(
            self.now,
            {tid: thread.copy() for tid, thread in self.threads.items()},
            list(self.ready),
            dict(self.variables),
            dict(self.buffers),
            dict(self.laws),
            dict(self.chosen),
            dict(self.sessions),
            dict(self.samples),
            dict(self.offered),
            dict(self.events),
            dict(self.latches),
            self.seq,
            self.ended,
            self.running,
            self.missed,
            self.timeout,
        )
