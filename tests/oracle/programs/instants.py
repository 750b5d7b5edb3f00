"""Programs that use the present instant: it ends their loops, is kept, compared and passed on, and decides what is
raised and what faults.

They are made from other programs, or from single steps, by changes at some of their places.
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

from tests.oracle.programs.text import branches
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    TIME,
    After,
    Alt,
    Assign,
    Bin,
    Catch,
    Channel,
    Comp,
    Expr,
    Guarded,
    If,
    If3,
    Interrupt,
    Lit,
    Mu,
    Now,
    Par,
    Port,
    Program,
    Raise,
    Read,
    Ref,
    Replicated,
    Seq,
    Skip,
    Target,
    Type,
    Un,
    Variable,
    Wait,
    While,
    Write,
    changed_at,
    walk,
)  # fmt: skip

ORDERED = ("<", "<=", ">", ">=")
MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}


def uses_the_time(seed: int) -> bool:
    """True for about one program in six; for the other seeds, programs are the same as without this choice."""
    return Random(f"now {seed}").random() < 1 / 6


def single_steps(rng: Random) -> Program:
    """One to three branches of one step each, with ports that are sampled or not."""
    bodies: list[Comp] = []
    ports: list[Port] = []
    variables: list[Variable] = []
    for owner in range(rng.choice([1, 1, 2, 2, 3])):
        variables += [Variable(f"n{owner}", INT, 0, owner), Variable(f"x{owner}", BOOL, False, owner)]
        choice = rng.random()
        out = Port(f"o{owner}", False, INT)
        if choice < 0.25:
            bodies.append(Wait(rng.choice([1, 1, 2, 3]) * MS))
        elif choice < 0.4:
            ports.append(out)
            bodies.append(Seq((Write(out.name, Ref(f"n{owner}", INT)), Wait(MS))))
        elif choice < 0.75:
            values = ((0, False), (7_500_000, True))
            ports.append(Port(f"i{owner}", True, BOOL, rng.choice([2, 2, 5]) * MS, domain=(False, True), values=values))
            read = Read(ports[-1].name, Target(f"x{owner}", BOOL))
            if rng.random() < 0.4:
                ports.append(out)
                bodies.append(Seq((read, Write(out.name, If3(Ref(f"x{owner}", BOOL), _whole(1), _whole(0), INT)))))
            else:
                bodies.append(read)
        elif choice < 0.85:
            ports.append(Port(f"e{owner}", True, BOOL, domain=(False, True), values=((0, False), (4_500_000, True))))
            read = Read(ports[-1].name, Target(f"x{owner}", BOOL))
            bodies.append(Alt((Guarded(read, Skip()), Guarded(After(rng.choice([1, 2]) * MS), Skip()))))
        else:
            bodies.append(Assign(Target(f"n{owner}", INT), _whole(1)))
    body = Par(tuple(bodies), rng.random() < 0.2) if len(bodies) > 1 else bodies[0]
    return Program(body, ports=tuple(ports), variables=tuple(variables))


def with_instants(program: Program, rng: Random, changes: int | None = None) -> Program:
    """The program with a few changes by which the present instant makes decisions."""
    made = _Instants(program, rng)
    for _ in range(rng.choice([1, 2, 2, 3]) if changes is None else changes):
        made.change()
    return made.program


def with_knot(program: Program) -> Program:
    """The program in parallel with two processes that wait for each other: they end only if everything else is ended,
    too.
    """
    owner = len(branches(program))
    names = ("left", "right")
    variables = [Variable(f"got{at}", INT, 0, owner + at) for at in (0, 1)]
    knot = [Seq((Read(names[at], Target(variables[at].name, INT)), Write(names[1 - at], _whole(3)))) for at in (0, 1)]
    prioritized = isinstance(program.body, Par) and program.body.prioritized
    return replace(
        program,
        body=Par((*branches(program), *knot), prioritized),
        channels=(*program.channels, *(Channel(name, INT, "sync") for name in names)),
        variables=(*program.variables, *variables),
    )


def _whole(value: int) -> Lit:
    return Lit(value, INT)


def _time(nanoseconds: int) -> Lit:
    return Lit(nanoseconds, TIME)


def _not(expr: Expr) -> Expr:
    return Un("not", expr, BOOL)


class _Instants:
    def __init__(self, program: Program, rng: Random) -> None:
        self.program = program
        self.rng = rng
        self.fresh = 0

    # ---- places ----

    def change(self) -> None:
        """Change one of the branches of the outermost parallel, or two of them."""
        count = len(branches(self.program))
        if count > 1 and self.rng.random() < 0.25:
            self._hand_over(*self.rng.sample(range(count), 2))
            return
        owner = self.rng.randrange(count)
        self._put(owner, self._changed(owner, branches(self.program)[owner]))

    def _put(self, owner: int, body: Comp) -> None:
        if not isinstance(self.program.body, Par):
            self.program = replace(self.program, body=body)
            return
        parts = (*self.program.body.parts[:owner], body, *self.program.body.parts[owner + 1 :])
        self.program = replace(self.program, body=replace(self.program.body, parts=parts))

    def _changed(self, owner: int, body: Comp) -> Comp:
        """A loop gets an end, a write another value, a condition another comparison; or a step is put into a loop."""
        found = walk(body)
        inside = {id(part) for node in found if isinstance(node, Replicated) for part in walk(node)[1:]}
        free = [at for at, part in enumerate(found) if not isinstance(part, Guarded) and id(part) not in inside]
        places = [at for at in free if isinstance(found[at], Mu | While | If | Write | Alt | Wait)]
        if places and self.rng.random() < 0.5:
            return changed_at(body, self.rng.choice(places), lambda part: self._asking(owner, part))
        at = 0 if self.rng.random() < 0.4 else self.rng.choice(free)
        return changed_at(body, at, lambda part: self._looped(owner, part))

    def _variable(self, kind: Type, owner: int) -> Ref:
        name = f"{'b' if kind == BOOL else 't' if kind == TIME else 'm'}{owner}_{len(self.program.variables)}"
        made = Variable(name, kind, False if kind == BOOL else 0, owner)
        self.program = replace(self.program, variables=(*self.program.variables, made))
        return Ref(made.name, kind)

    def _exception(self) -> str:
        self.program = replace(self.program, exceptions=tuple(sorted({*self.program.exceptions, "Late"})))
        return "Late"

    # ---- questions ----

    def instant(self) -> int:
        return self.rng.choice([0, 1, 2, 3, 3, 4, 4, 5, 6, 8]) * MS + self.rng.choice([0, 0, 0, 0, 0, MS // 2, 1, -1])

    def _compared(self, op: str, left: Expr, right: Expr) -> Expr:
        """A comparison, perhaps mirrored or negated."""
        if self.rng.random() < 0.35:
            op, left, right = MIRRORED[op], right, left
        if self.rng.random() < 0.15:
            opposite = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
            return _not(Bin(opposite[op], left, right, BOOL))
        return Bin(op, left, right, BOOL)

    def late(self, since: Ref | None = None) -> Expr:
        """A condition that holds from some instant on, or some time after another instant; rarely only at one
        instant.
        """
        op = "==" if self.rng.random() < 0.1 else self.rng.choice((">", ">="))
        if since is None:
            return self._compared(op, Now(), _time(self.instant()))
        age = self.rng.choice([1, 2, 2, 3]) * MS
        if self.rng.random() < 0.5:
            return self._compared(op, Bin("-", Now(), since, TIME), _time(age))
        return self._compared(op, Now(), Bin("+", since, _time(age), TIME))

    def question(self, since: Ref | None = None) -> Expr:
        """A condition on the present instant."""
        choice = self.rng.random()
        if choice < 0.5:
            return self.late(since)
        if choice < 0.75:
            return _not(self.late(since))
        if choice < 0.9 or since is None:
            op = self.rng.choice((*ORDERED, "==", "!="))
            return self._compared(op, Now(), _time(self.instant()))
        return self._compared(self.rng.choice(ORDERED), since, _time(self.instant()))

    # ---- changes ----

    def _asking(self, owner: int, part: Comp) -> Comp:
        """A loop, a condition or a value that the present instant decides."""
        match part:
            case Mu(body, None):
                return self._ended(owner, body)
            case Mu(body, until):
                assert until is not None
                return Mu(body, Bin(self.rng.choice(("or", "or", "and")), until, self.late(), BOOL))
            case While(condition, body):
                test = self.question()
                return While(Bin("and", condition, test, BOOL) if self.rng.random() < 0.6 else test, self._slow(body))
            case If():
                return replace(part, condition=self.question())
            case Alt(guards):
                at = self.rng.randrange(len(guards))
                guard = replace(guards[at], when=self.question())
                return replace(part, branches=(*guards[:at], guard, *guards[at + 1 :]))
            case Write(_, value):
                return self._written(part, value)
            case Wait(int(time), False) if time:
                if self.rng.random() < 0.5:
                    return Wait(Bin("+", Now(), _time(time), TIME), True)
                return Wait(If3(self.question(), _time(time), _time(self.rng.choice([1, 2, 4]) * MS), TIME))
            case _:
                return part

    def _written(self, part: Write, value: Expr) -> Comp:
        if value.type == BOOL:
            return replace(part, value=self.question())
        if value.type == INT:
            return replace(part, value=If3(self.question(), value, _whole(self.rng.randrange(3)), INT))
        if value.type == TIME:
            return replace(part, value=Now() if self.rng.random() < 0.7 else Bin("+", Now(), _time(MS), TIME))
        return If(self.question(), part)

    def _slow(self, body: Comp) -> Comp:
        """A body that usually lets time pass."""
        waits = any(isinstance(part, Wait) and isinstance(part.time, int) and part.time for part in walk(body))
        if waits or self.rng.random() < (0.5 if any(isinstance(part, Read) for part in walk(body)) else 0.1):
            return body
        wait = Wait(self.rng.choice([1, 1, 1, 2, 3]) * MS)
        return Seq((wait, body) if self.rng.random() < 0.3 else (body, wait))

    def _looped(self, owner: int, part: Comp) -> Comp:
        """A step inside or after a condition on the present instant."""
        choice = self.rng.random()
        if choice < 0.7:
            return self._ended(owner, part)
        if choice < 0.78:
            return self._late_choice(owner, part)
        if choice < 0.86:
            return If(self.question(), part, self._short() if self.rng.random() < 0.4 else None)
        kept = self._variable(TIME, owner)
        keeps = Assign(Target(kept.name, TIME), Now())
        if choice < 0.93:
            return Seq((keeps, part, If(self.question(kept), self._short())))
        deadline = Bin("+", kept, _time(self.rng.choice([1, 2, 3]) * MS), TIME)
        if self.rng.random() < 0.5:
            return Seq((keeps, part, Wait(deadline, True)))
        return Seq(
            (keeps, part, Alt((Guarded(After(deadline, True), Skip()), Guarded(After(MS), self._short())), True))
        )

    def _short(self) -> Comp:
        return self.rng.choice((Skip(), Wait(MS), Mu(Wait(MS)), Raise(self._exception())))

    def _ended(self, owner: int, body: Comp) -> Comp:
        """A loop that the present instant ends."""
        body = self._slow(body)
        choice = self.rng.random()
        if choice < 0.25:
            return Mu(body, self.late())
        if choice < 0.42:
            return While(_not(self.late()) if self.rng.random() < 0.3 else self._early(), body)
        if choice < 0.58:
            over = self._variable(BOOL, owner)
            asks = Assign(Target(over.name, BOOL), self.late())
            return Mu(Seq((body, asks) if self.rng.random() < 0.7 else (asks, body)), over)
        if choice < 0.72:
            raised = Raise(self._exception())
            loop = Mu(Seq((body, If(self.late(), raised))))
            return Catch(loop, raised.name, Skip()) if self.rng.random() < 0.6 else loop
        if choice < 0.84:
            number = self._variable(INT, owner)
            divisor = If3(self._moment(), _whole(0), _whole(self.rng.choice([1, 2])), INT)
            faults = Assign(Target(number.name, INT), Bin(self.rng.choice("/%"), _whole(6), divisor, INT))
            loop = Mu(Seq((body, faults)))
            return Catch(loop, "Fault", Skip()) if self.rng.random() < 0.7 else loop
        kept = self._variable(TIME, owner)
        keeps = Assign(Target(kept.name, TIME), Now())
        if choice < 0.95:
            return Seq((keeps, Mu(body, self.late(kept))))
        return Mu(Seq((keeps, body)), self.late(kept))  # ends only if one iteration takes that long

    def _early(self) -> Expr:
        return self._compared(self.rng.choice(("<", "<=")), Now(), _time(self.instant()))

    def _moment(self) -> Expr:
        """An instant that is usually reached by iterations of a millisecond."""
        if self.rng.random() < 0.5:
            return self._compared("==", Now(), _time(self.rng.choice([2, 3, 4]) * MS))
        return self.late()

    def _late_choice(self, owner: int, part: Comp) -> Comp:
        """An alternative that ends its loop once it is late."""
        over = self._variable(BOOL, owner)
        ends = Guarded(Skip(), Assign(Target(over.name, BOOL), Lit(True, BOOL)), self.late())
        other = Guarded(part, Skip()) if isinstance(part, Read) else Guarded(After(MS), part)
        if self.rng.random() < 0.3 and isinstance(part, Wait):
            return Interrupt(Mu(part), Guarded(After(2 * MS), Skip(), self.question()))
        return Mu(Alt((ends, other), self.rng.random() < 0.7), over)

    # ---- what is handed over ----

    def _hand_over(self, writer: int, reader: int) -> None:
        """A channel over which one branch sends another the time, or whether it is late; the other acts on it."""
        boxed = self.program.boxed
        if (writer in boxed) != (reader in boxed):
            self.program = replace(self.program, boxed=frozenset())
        kind = self.rng.choice(("sync", "sync", "buffer", "overwrite"))
        of = self.rng.choice((BOOL, TIME))
        name = f"h{len(self.program.channels)}"
        channel = Channel(name, of, kind, 1 if kind != "sync" else 0)
        self.program = replace(self.program, channels=(*self.program.channels, channel))
        got = self._variable(of, reader)
        writes = Write(channel.name, self.late() if of == BOOL else Now())
        reads = Read(channel.name, Target(got.name, of))
        over: Expr = got if of == BOOL else self.late(got) if self.rng.random() < 0.6 else self._on(got)
        before, after = branches(self.program)[writer], branches(self.program)[reader]
        if self.rng.random() < 0.5:  # in iterations on both sides, which may end at different times
            self._put(writer, Seq((before, self._round(writer, writes))))
            self._put(reader, Seq((after, self._repeated(reads, over))))
        elif self.rng.random() < 0.5:
            self._put(writer, Seq((writes, before)))
            self._put(reader, Seq((after, reads, If(over, Wait(MS), Mu(Wait(MS))))))
        else:
            self._put(writer, Seq((before, writes)))
            self._put(reader, Seq((reads, If(over, after))))

    def _on(self, got: Ref) -> Expr:
        """A condition on an instant that arrived over a channel."""
        return self._compared(self.rng.choice(ORDERED), got, _time(self.instant()))

    def _round(self, owner: int, writes: Write) -> Comp:
        if self.rng.random() < 0.5:
            return Mu(Seq((Wait(MS), writes)), self.late())
        return self._ended(owner, writes) if self.rng.random() < 0.5 else Mu(Seq((writes, Wait(MS))))

    def _repeated(self, reads: Read, over: Expr) -> Comp:
        if self.rng.random() < 0.3:
            patient = Alt((Guarded(reads, Skip()), Guarded(After(3 * MS), Skip())), self.rng.random() < 0.5)
            return Mu(patient, over)
        return Mu(reads, over)
