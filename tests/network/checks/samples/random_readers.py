"""Random loops that follow samples, with delays, events, time-outs, interrupts and exceptions between the reads, for
W0707.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    After,
    Alt,
    Bin,
    Catch,
    Comp,
    Event,
    Guarded,
    If,
    Interrupt,
    Lit,
    Mu,
    Par,
    Port,
    Program,
    Raise,
    Read,
    Ref,
    Replicated,
    Seq,
    Skip,
    Stop,
    Target,
    Variable,
    Wait,
    walk,
)

RAISED = "Hot"


class _Reader:
    def __init__(self, rng: Random, events: int, samples: tuple[str, ...]) -> None:
        self.rng = rng
        self.events = events
        self.samples = samples

    def delay(self) -> int:
        return self.rng.choice((1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25)) * MS

    def read(self, port: str) -> Read:
        return Read(port, Target("n" if port.startswith("e") else "v", INT))

    def sample(self) -> Read:
        return self.read(self.rng.choice(self.samples))

    def test(self) -> Bin:
        return Bin("==", Ref("v", INT), Lit(1, INT), BOOL)

    def event(self) -> str:
        return f"e{self.rng.randrange(self.events)}"

    def part(self, depth: int) -> Comp:
        kind = self.rng.random()
        if depth == 0 or kind < 0.3:
            return self.step()
        if kind < 0.5:
            return Seq(tuple(self.part(depth - 1) for _ in range(self.rng.randint(2, 3))))
        if kind < 0.72:
            return self.alternative(depth - 1)
        if kind < 0.8:
            return If(self.condition(), self.part(depth - 1), self.part(depth - 1) if self.rng.random() < 0.5 else None)
        if kind < 0.88:
            return Interrupt(self.body(depth - 1), Guarded(self.event_guard(), self.part(depth - 1)))
        if kind < 0.93:
            raising = Seq((self.part(depth - 1), Raise(RAISED)))
            inner: Comp = raising if self.rng.random() < 0.5 else If(self.condition(), raising)
            return Catch(inner, RAISED, self.part(depth - 1))
        if kind < 0.97:
            return Replicated("seq", "i", self.rng.randint(2, 3), self.part(depth - 1))
        return Par((self.step(), Wait(self.delay())))

    def step(self) -> Comp:
        kind = self.rng.random()
        if kind < 0.45:
            return self.sample()
        if kind < 0.8:
            return Wait(self.delay())
        if kind < 0.9 and self.events:
            return self.read(self.event())
        return Skip()

    def condition(self) -> Bin | Lit:
        return Lit(self.rng.random() < 0.5, BOOL) if self.rng.random() < 0.5 else self.test()

    def body(self, depth: int) -> Comp:
        kind = self.rng.random()
        if kind < 0.4:
            return Mu(self.sample())
        if kind < 0.5:
            return Stop()
        return self.part(depth)

    def event_guard(self) -> Event:
        kind = self.rng.random()
        if kind < 0.15:
            return self.sample()
        return self.read(self.event()) if self.events and kind < 0.55 else After(self.delay())

    def when(self, event: Event) -> Bin | Lit | None:
        kind = self.rng.random()
        if kind < 0.08:
            return Lit(False, BOOL)
        return self.test() if kind < 0.2 and isinstance(event, Read) and event.channel in self.samples else None

    def alternative(self, depth: int) -> Comp:
        guards: dict[str, Guarded] = {}
        for _ in range(self.rng.choice((2, 2, 3))):
            kind = self.rng.random()
            event: Event
            if kind < 0.4:
                event = self.sample()
            elif kind < 0.65 and self.events:
                event = self.read(self.event())
            elif kind < 0.9:
                event = After(self.delay())
            else:
                event = Skip()
            name = event.channel if isinstance(event, Read) else repr(event)
            when = self.when(event)
            following = self.part(depth) if self.rng.random() < 0.6 else Skip()
            guards.setdefault(name, Guarded(event, following, when))
        return Alt(tuple(guards.values()), self.rng.random() < 0.5)


def reader(seed: int) -> Program:
    """A program with one process that follows samples of ``x``, and perhaps of ``z``, in a loop, often after something
    else.
    """
    rng = Random(seed)
    events = rng.choice((0, 0, 1, 1, 2))
    made = _Reader(rng, events, ("x", "x", "z") if rng.random() < 0.3 else ("x",))
    turn: Comp = Seq((made.part(2), made.part(1)))
    if not any(isinstance(inner, Read) and inner.channel == "x" for inner in walk(turn)):
        turn = Seq((made.read("x"), turn))
    until = made.test() if rng.random() < 0.2 else None
    body: Comp = Mu(turn, until)
    if rng.random() < 0.3:
        body = Seq((*(made.part(1) for _ in range(rng.randint(1, 3))), body))
    names = {inner.channel for inner in walk(body) if isinstance(inner, Read)}
    names |= {
        inner.event.channel for inner in walk(body) if isinstance(inner, Guarded) and isinstance(inner.event, Read)
    }
    ports = [Port("x", True, INT, rng.choice((5, 10)) * MS, domain=(0, 1), values=((0, 0), (23 * MS, 1)))]
    if "z" in names:
        period = rng.choice((5, 10, 15, 20)) * MS
        ports.append(Port("z", True, INT, period, domain=(0, 1), values=((0, 0), (31 * MS, 1))))
    ports += [
        Port(f"e{number}", True, INT, domain=(0, 1), values=((0, 0), (17 * MS, 1)))
        for number in range(events)
        if f"e{number}" in names
    ]
    raising = any(isinstance(inner, Raise | Catch) for inner in walk(body))
    return Program(
        body=body,
        variables=(Variable("n", INT, 0, 0), Variable("v", INT, 0, 0)),
        ports=tuple(_shifted(Random(f"offsets {rng.random()}"), ports)),
        exceptions=(RAISED,) if raising else (),
        step=MS,
    )


def _shifted(rng: Random, ports: list[Port]) -> list[Port]:
    """The ports, in half of the programs some with an offset."""
    offsets = rng.choice([(0, 2), (1, 3), (0.5, 4)]) if rng.random() < 0.5 else (0,)
    return [replace(port, offset=int(rng.choice(offsets) * MS)) if port.period else port for port in ports]
