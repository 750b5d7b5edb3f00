"""Random programs with sampled inputs, for `schedulable`: loops one after another, waits and events between and within
them, several ports with one period or with several, partners that make a loop wait, and supervisors.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from tests.oracle.programs.forms import has_instants
from tests.oracle.programs.shrink import tidy
from tests.oracle.programs.text import uses
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    After,
    Alt,
    Assign,
    Bin,
    Channel,
    Comp,
    Event,
    Guarded,
    If,
    Interrupt,
    Law,
    Lit,
    Mu,
    Par,
    Port,
    Program,
    Read,
    Ready,
    Ref,
    Replicated,
    Run,
    Seq,
    Skip,
    Target,
    Variable,
    Wait,
    While,
    Write,
    walk,
)  # fmt: skip

WCET = (100_000, 300_000, 700_000, 1_100_000, 1_900_000)


class _Timed:
    """One branch, with its ports, laws and channels."""

    def __init__(self, rng: Random, owner: int) -> None:
        self.rng = rng
        self.owner = owner
        self.samples: list[Port] = []
        self.events: list[Port] = []
        self.laws: list[Law] = []
        self.reads: list[Channel] = []
        self.writes: list[Channel] = []
        self.variables: list[Variable] = []
        self.counters: list[Variable] = []

    def variable(self) -> Variable:
        if not self.variables or self.rng.random() < 0.3:
            self.variables.append(Variable(f"v{self.owner}_{len(self.variables)}", INT, 0, self.owner))
        return self.rng.choice(self.variables)

    def target(self) -> Target:
        return Target(self.variable().name, INT)

    def test(self) -> Bin:
        return Bin(self.rng.choice(["==", "!="]), Ref(self.variable().name, INT), Lit(1, INT), BOOL)

    def delay(self) -> int:
        return self.rng.choice([0, 1, 1, 2, 3, 3, 5, 7, 9]) * MS

    def instant(self) -> int:
        return self.rng.choice([0, 3, 5, 12, 20, 33]) * MS

    def sample(self) -> Comp:
        """Read one of the sampled inputs, directly or by a law."""
        if self.laws and (not self.samples or self.rng.random() < 0.6):
            return Run(self.rng.choice(self.laws).name)
        if self.samples:
            return Read(self.rng.choice(self.samples).name, self.target())
        return Wait(self.delay())

    def communication(self) -> Read | Write | None:
        ends = [(channel, True) for channel in self.reads] + [(channel, False) for channel in self.writes]
        if not ends:
            return None
        channel, read = self.rng.choice(ends)
        return Read(channel.name, self.target()) if read else Write(channel.name, Lit(self.rng.randrange(2), INT))

    def between(self, depth: int = 1) -> Comp:
        """Something that may make a loop late for its samples."""
        choice = self.rng.random()
        if choice < 0.07:
            return Wait(self.instant(), until=True)
        if choice < 0.35:
            return Wait(self.delay())
        if choice < 0.5 and self.events:
            return Read(self.rng.choice(self.events).name, self.target())
        if choice < 0.75:
            return self.communication() or Wait(self.delay())
        if choice < 0.85 and depth:
            return If(self.test(), self.between(0), self.sample() if self.rng.random() < 0.5 else None)
        if choice < 0.92:
            return Assign(self.target(), Lit(self.rng.randrange(2), INT))
        return Replicated("seq", "i", self.rng.randint(2, 3), self.sample() if self.rng.random() < 0.5 else Wait(MS))

    def guard(self) -> tuple[Event, Comp]:
        choice = self.rng.random()
        if choice < 0.4 and self.laws:
            law = self.rng.choice(self.laws)
            return Ready(law.inputs[0][2]), Run(law.name)
        if choice < 0.55 and self.samples:
            return Read(self.rng.choice(self.samples).name, self.target()), Skip()
        if choice < 0.75 and self.events:
            return Read(self.rng.choice(self.events).name, self.target()), Skip()
        communication = self.communication()
        if choice < 0.88 and communication is not None:
            return communication, Skip()
        if self.rng.random() < 0.2:
            return After(self.instant(), at=True), Skip()
        return After(self.delay()), Skip()

    def alternative(self) -> Comp:
        guards: dict[str, Guarded] = {}
        for _ in range(self.rng.choice([2, 2, 3])):
            event, body = self.guard()
            if self.rng.random() < 0.35:
                body = Seq((body, self.between()))
            name = event.channel if isinstance(event, Read | Write | Ready) else "after"
            guards.setdefault(name, Guarded(event, body))
        found = tuple(guards.values())
        if len(found) == 1:
            return found[0].body
        return Alt(found, self.rng.random() < 0.6)

    def round(self) -> Comp:
        steps: list[Comp] = []
        for _ in range(self.rng.choice([1, 1, 1, 2, 2, 3])):
            choice = self.rng.random()
            steps.append(self.sample() if choice < 0.6 else self.alternative() if choice < 0.85 else self.between())
        return steps[0] if len(steps) == 1 else Seq(tuple(steps))

    def loop(self, *, last: bool) -> Comp:
        body = self.round()
        if not any(isinstance(part, Read | Write | Wait | Run | Guarded) for part in walk(body)) or has_instants(body):
            body = Seq((body, Wait(MS)))
        choice = self.rng.random()
        if last and choice < 0.7:
            return Mu(body)
        if choice < 0.9:
            counter = Variable(f"n{self.owner}_{len(self.counters)}", INT, 0, self.owner)
            self.counters.append(counter)
            ref = Ref(counter.name, INT)
            count = Assign(Target(counter.name, INT), Bin("+", ref, Lit(1, INT), INT))
            times = Lit(self.rng.randint(1, 3), INT)
            if self.rng.random() < 0.7:
                return Mu(Seq((body, count)), Bin(">=", ref, times, BOOL))
            return While(Bin("<", ref, times, BOOL), Seq((body, count)))
        return Mu(body, self.test())

    def body(self) -> Comp:
        steps: list[Comp] = []
        loops = self.rng.choice([1, 1, 1, 2, 2])
        for number in range(loops):
            if self.rng.random() < (0.2 if number == 0 else 0.7):
                steps.append(self.between())
            loop = self.loop(last=number == loops - 1)
            while self.rng.random() < 0.14:
                event: Event = After(self.instant(), at=True) if self.rng.random() < 0.3 else After(self.delay())
                if self.events and self.rng.random() < 0.5:
                    event = Read(self.events[0].name, self.target())
                after = self.between() if self.rng.random() < 0.5 else self.sample()
                if not _shares(loop, event):
                    loop = Interrupt(loop, Guarded(event, after))
            steps.append(loop)
        return steps[0] if len(steps) == 1 else Seq(tuple(steps))


def _shares(body: Comp, event: Event) -> bool:
    """Whether a guard reads what its body reads, or into what it uses: guard and body are parallel parts."""
    if not isinstance(event, Read):
        return False
    return event.channel + "?" in uses(body, {}) or event.target.name in repr(body)


def timed(seed: int, *, outputs: bool = False) -> Program:
    """A program with sampled inputs; with `outputs`, its laws write sampled outputs, too."""
    rng = Random(seed)
    parts = [_Timed(rng, owner) for owner in range(rng.choice([1, 1, 2, 2, 3]))]
    periods = [value * MS for value in rng.choice([(5,), (10,), (4, 8), (5, 10), (3, 6), (4, 6)])]
    ports: list[Port] = []
    domain: tuple[int, ...] = (0, 1) if rng.random() < 0.4 else (0,)
    wcet = rng.random() < 0.4
    for part in parts:
        for _ in range(rng.choice([0, 1, 1, 2])):
            port = Port(f"x{len(ports)}", True, INT, rng.choice(periods), domain=domain, values=_values(rng))
            ports.append(port)
            if rng.random() < 0.6:
                long = rng.choice(WCET) if wcet else 1000
                name = f"law{len(ports)}"
                part.laws.append(_law(rng, name, port, part, long))
                if outputs and rng.random() < 0.7:
                    out = Port(f"y{len(ports)}", False, INT, rng.choice(periods), rng.random() < 0.3)
                    ports.append(out)
                    part.laws[-1] = _writing(part.laws[-1], out)
            else:
                part.samples.append(port)
        if rng.random() < 0.3:
            port = Port(
                f"e{len(ports)}", True, INT, domain=(0, 1), values=((0, 0), (int(rng.random() * 40) * MS + MS // 2, 1))
            )
            ports.append(port)
            part.events.append(port)
    channels: list[Channel] = []
    for number in range(rng.choice([0, 1, 1, 2]) if len(parts) > 1 else 0):
        writer, reader = rng.sample(parts, 2)
        kind, size = rng.choice([("sync", 0), ("sync", 0), ("buffer", 1), ("overwrite", 1)])
        channel = Channel(f"c{number}", INT, kind, size)
        channels.append(channel)
        writer.writes.append(channel)
        reader.reads.append(channel)
    bodies = [part.body() for part in parts]
    for channel in channels:
        ends = set().union(*(uses(body, {}) for body in bodies))
        for part in parts:
            if channel in part.writes and channel.name + "!" not in ends:
                bodies[part.owner] = Seq((bodies[part.owner], Write(channel.name, Lit(1, INT))))
            if channel in part.reads and channel.name + "?" not in ends:
                bodies[part.owner] = Seq((bodies[part.owner], Read(channel.name, part.target())))
    made = Program(
        body=Par(tuple(bodies), rng.random() < 0.4) if len(bodies) > 1 else bodies[0],
        channels=tuple(channels),
        variables=tuple(variable for part in parts for variable in [*part.variables, *part.counters]),
        ports=tuple(_shifted(Random(f"offsets {seed}"), ports)),
        laws=tuple(law for part in parts for law in part.laws),
        step=MS,
    )
    return tidy(made)


def _shifted(rng: Random, ports: list[Port]) -> list[Port]:
    """The ports, in half of the programs some with an offset."""
    offsets = rng.choice([(0,), (0, 1, 2), (0, 1.5), (0.5, 2)]) if rng.random() < 0.5 else (0,)
    return [replace(port, offset=int(rng.choice(offsets) * MS) if port.period else 0) for port in ports]


def _values(rng: Random) -> tuple[tuple[int, int], ...]:
    """The values that the printed environment offers, changing between the instants of all grids."""
    first, second = rng.randint(1, 20), rng.randint(21, 38)
    return (0, rng.randrange(2)), (first * MS + MS // 2, rng.randrange(3)), (second * MS + MS // 2, rng.randrange(3))


def _writing(law: Law, port: Port) -> Law:
    """The law with one more output, which also counts its runs."""
    ref = Ref("n", INT)
    count = ("n", INT, 0, Bin("%", Bin("+", ref, Lit(1, INT), INT), Lit(4, INT), INT))
    return replace(
        law,
        outputs=(*law.outputs, ("z", INT, port.name, Bin("+", Ref("x", INT), ref, INT))),
        states=(count,),
    )


def _law(rng: Random, name: str, port: Port, part: _Timed, wcet: int) -> Law:
    into = part.variable().name
    return Law(name, (("x", INT, port.name),), (("y", INT, into, Ref("x", INT)),), (), wcet, part.owner)
