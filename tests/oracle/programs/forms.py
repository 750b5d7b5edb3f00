"""Random compositions within one branch, and random changes of a list of steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tests.oracle.programs.edges import Edges
from tests.oracle.programs.scope import BYTE, Scope
from tests.oracle.programs.text import uses
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    MS,
    REAL,
    TIME,
    After,
    Alt,
    Assign,
    Bin,
    Call,
    Catch,
    Channel,
    Comp,
    Event,
    Expr,
    Guarded,
    If,
    Int,
    Interrupt,
    Lit,
    Mu,
    Par,
    Raise,
    Read,
    Ref,
    Replicated,
    Seq,
    Skip,
    Stop,
    Target,
    Wait,
    While,
    Write,
    early,
    walk,
)  # fmt: skip


def forever(body: Comp) -> Comp:
    """A loop that waits for something in each iteration; a loop that never does is refused."""
    instants = has_instants(body)
    if not instants and any(isinstance(part, Read | Write | Wait) for part in walk(body)):
        return Mu(body)
    if not instants and any(isinstance(part, Guarded) and not isinstance(part.event, Skip) for part in walk(body)):
        return Mu(body)
    return Mu(Seq((*body.parts, Wait(MS)) if isinstance(body, Seq) else (body, Wait(MS))))


def has_instants(body: Comp) -> bool:
    """Whether a composition waits for instants."""
    return any(_of_instant(part) for part in walk(body))


def _of_instant(part: Comp) -> bool:
    """Whether it waits for an instant, which can only be once."""
    match part:
        case Wait(_, True) | Guarded(After(_, True)):
            return True
        case _:
            return False


def _port(event: Event) -> str:
    """What no two guards of an alternative may share."""
    match event:
        case Read(channel, _):
            return channel + "?"
        case Write(channel, _):
            return channel + "!"
        case After(_, at):
            return "at" if at else "after"
        case _:
            return "skip"


class Forms:
    def __init__(self, scope: Scope, without: frozenset[str]) -> None:
        self.scope = scope
        self.rng = scope.rng
        self.without = without

    def sequence(self, steps: Sequence[Comp]) -> Comp:
        flat: list[Comp] = []
        for step in steps:
            flat += step.parts if isinstance(step, Seq) else (step,)
        return Skip() if not flat else flat[0] if len(flat) == 1 else Seq(tuple(flat))

    def loop(self, body: Comp) -> Comp:
        """A loop that runs forever, or a number of times."""
        choice = self.rng.random()
        if choice < 0.5:
            return forever(body)
        counter = self.scope.world.variable(INT, self.scope.owner)
        count = Assign(Target(counter.name, INT), Bin("+", Ref(counter.name, INT), Lit(1, INT), INT))
        times = Lit(self.rng.randint(1, 3), INT)
        if choice < 0.8:
            return Mu(self.sequence([body, count]), Bin(">=", Ref(counter.name, INT), times, BOOL))
        return While(Bin("<", Ref(counter.name, INT), times, BOOL), self.sequence([body, count]))

    def delay(self) -> int:
        return self.rng.choice([0, 1, 1, 2, 2, 3, 5]) * MS

    def wait(self) -> Wait:
        """A delay, or a wait until an instant."""
        until = self.rng.random() < 0.2
        return Wait(self.instant() if until else self.delay(), until)

    def after(self) -> After:
        """A time-out, or an instant."""
        at = self.rng.random() < 0.25
        return After(self.instant() if at else self.delay(), at)

    def instant(self) -> int:
        return self.rng.choice([0, 1, 2, 3, 4, 6]) * MS

    def condition(self) -> Expr:
        if "time" not in self.without and self.rng.random() < 0.1:
            return early(self.instant())
        return self.scope.condition()

    # ---- steps ----

    def steps(self, count: int, depth: int) -> list[Comp]:
        found: list[Comp] = []
        for _ in range(count):
            found.append(self.step(depth))
        return found

    def communication(self) -> Read | Write | None:
        """One of the channels of this branch."""
        reads: list[tuple[Channel, bool]] = [(channel, True) for channel in self.scope.reads]
        ends = reads + [(channel, False) for channel in self.scope.writes]
        if not ends:
            return None
        channel, read = self.rng.choice(ends)
        if read:
            return Read(channel.name, self.scope.target(channel.type))
        return Write(channel.name, self.scope.value(channel.type))

    def local(self) -> list[Comp]:
        """Something that concerns no other branch."""
        choice = self.rng.random()
        if choice < 0.4 and "time" not in self.without:
            return [self.wait()]
        if choice < 0.6 and self.scope.outputs:
            return [Write(self.rng.choice(self.scope.outputs), self.scope.number())]
        return [self.assignment()]

    def assignment(self) -> Assign:
        if self.scope.world.rich and self.rng.random() < 0.3:
            return Assign(self.scope.target(REAL), self.scope.real())
        target = self.scope.target(INT)
        return Assign(target, self.scope.number())

    def step(self, depth: int) -> Comp:
        choice = self.rng.random()
        if choice < 0.4:
            return self.communication() or self.local()[0]
        if choice < 0.55 or depth == 0:
            return self.local()[0]
        if choice < 0.7:
            return self.alternative(depth)
        if choice < 0.75:
            return If(self.condition(), self.step(depth - 1), self.step(depth - 1) if self.rng.random() < 0.6 else None)
        if choice < 0.79:
            return self.parallel(depth)
        if choice < 0.83:
            return self.loop(self.sequence(self.steps(self.rng.randint(1, 2), depth - 1)))
        if choice < 0.87:
            return self.caught(self.steps(self.rng.randint(1, 2), depth - 1), depth)
        if choice < 0.92:
            return self.interrupted(self.sequence(self.steps(self.rng.randint(1, 2), depth - 1)), depth)
        if choice < 0.94:
            return self.faulty(depth)
        if choice < 0.96:
            return self.guarded(depth)
        if choice < 0.98:
            return self.replicated(depth)
        if choice < 0.985:
            return Stop()
        return Skip()

    def event(self, *, timed: bool = True) -> Event:
        choice = self.rng.random()
        communication = self.communication()
        if communication is not None and choice < 0.75:
            return communication
        if choice < 0.93 and timed and "time" not in self.without:
            return self.after()
        return Skip()

    def guard(self, depth: int) -> Guarded:
        when = self.condition() if self.rng.random() < 0.2 else None
        return Guarded(self.event(), self.step(max(depth - 1, 0)), when)

    def guarded(self, depth: int) -> Comp:
        communication = self.communication()
        event: Event = communication if communication is not None else Skip()
        return Guarded(event, self.step(depth - 1))

    def alternative(self, depth: int) -> Comp:
        guards: list[Guarded] = []
        for _ in range(self.rng.choice([2, 2, 2, 3])):
            guard = self.guard(depth)
            if _port(guard.event) not in {_port(other.event) for other in guards}:
                guards.append(guard)
        return Alt(tuple(guards), self.rng.random() < 0.5) if len(guards) > 1 else guards[0]

    def parallel(self, depth: int) -> Comp:
        scopes = self.scope.split(2)
        inner = [Forms(scope, self.without) for scope in scopes]
        return Par(tuple(forms.sequence(forms.steps(self.rng.randint(1, 2), depth - 1)) for forms in inner))

    def replicated(self, depth: int) -> Comp:
        count = self.rng.randint(1, 3)
        choice = self.rng.random()
        if choice < 0.5 and self.scope.writes:
            channel = self.rng.choice(self.scope.writes)
            if channel.type == INT:
                return Replicated("seq", "i", count, Write(channel.name, Ref("i", INT)))
        if choice < 0.75:
            return Replicated("seq", "i", count, self.step(0))
        when = Bin("==", self.scope.number(0), Ref("i", INT), BOOL)
        return Replicated(self.rng.choice(["alt", "prialt"]), "i", 4, Guarded(Skip(), self.step(0), when))

    def caught(self, steps: list[Comp], depth: int) -> Comp:
        name = self.rng.choice(["Trouble", "Alarm"])
        self.scope.world.exceptions.add(name)
        thrown: Comp = Raise(name)
        if self.rng.random() < 0.5:
            thrown = If(self.scope.condition(), thrown)
        if self.rng.random() < 0.3:
            scopes = self.scope.split(2)
            inner = Forms(scopes[0], self.without)
            other = Forms(scopes[1], self.without)
            both = (inner.sequence([*inner.steps(1, 0), Raise(name)]), other.sequence(other.steps(2, 0)))
            return Catch(Par(both), name, self.step(depth - 1))
        return Catch(self.sequence([*steps, thrown]), name, self.step(depth - 1))

    def faulty(self, depth: int) -> Comp:
        """Arithmetic that may fault, with a handler."""
        scope = self.scope
        if scope.world.wide and self.rng.random() < 0.8:
            return self.saved(self.overflowing(depth))
        choice = self.rng.random()
        steps: list[Comp]
        if choice < 0.3:
            root = Bin("-", scope.real(), scope.real(), REAL)
            steps = [Assign(scope.target(REAL), Call("sqrt", (root,), REAL))]
        elif choice < 0.6:
            made = scope.world.variable(BYTE, scope.owner, self.rng.choice([1, 40, 100]))
            ref = Ref(made.name, BYTE)
            steps = [Assign(Target(made.name, BYTE), Bin(self.rng.choice("+*"), ref, ref, BYTE))]
        else:
            divisor = Ref(scope.variable(INT).name, INT)
            divided = Bin(self.rng.choice("/%"), Lit(7, INT), divisor, INT)
            steps = [Assign(scope.target(INT), Bin("%", divided, Lit(3, INT), INT))]
        return Catch(self.sequence([*steps, *self.local()]), "Fault", self.step(max(depth - 1, 0)))

    def interrupted(self, body: Comp, depth: int) -> Comp:
        """A body with a guard in parallel: they share no end and no variable."""
        if "interrupt" in self.without or "time" in self.without:
            return body
        beside = uses(body, {})
        read = [channel for channel in self.scope.reads if channel.name + "?" not in beside]
        write = [channel for channel in self.scope.writes if channel.name + "!" not in beside]
        guard = Scope(self.scope.world, self.scope.owner, read, write, [])
        event = Forms(guard, self.without).event()
        if isinstance(event, Skip):
            event = self.after()
        return Interrupt(body, Guarded(event, self.step(max(depth - 1, 0))))

    # ---- arithmetic at the ends of the ranges ----

    def saved(self, steps: Sequence[Comp], instead: Comp | None = None) -> Comp:
        """Steps that may fault, and what is done then: nothing, never anything, an endless loop, or a step."""
        choice = self.rng.random()
        handler: Comp = Skip() if choice < 0.2 else Stop() if choice < 0.5 else self.step(0)
        if 0.5 < choice < 0.6:
            handler = Edges(self.scope, self.without).spin(self.communication())
        if choice > 0.75:
            handler = instead or self.communication() or handler
        return Catch(self.sequence(steps), "Fault", handler)

    def overflowing(self, depth: int) -> list[Comp]:
        """Steps that compute, wait or communicate with a value that may be out of range."""
        edges = Edges(self.scope, self.without)
        choice = self.rng.random()
        communication = self.communication()
        timed = "time" not in self.without
        if choice < 0.12 and isinstance(communication, Write) and isinstance(communication.value.type, Int):
            return [replace(communication, value=edges.sum(communication.value.type))]
        if choice < 0.2 and self.scope.outputs:
            return [Write(self.rng.choice(self.scope.outputs), edges.sum(INT))]
        if choice < 0.3 and isinstance(communication, Read) and isinstance(communication.target.type, Int):
            return [communication, edges.added(communication.target)]
        if choice < 0.4 and timed:
            until = self.rng.random() < 0.5
            return [Wait(edges.sum(TIME), until)]
        if choice < 0.5 and communication is not None:
            return [self.overflowing_guards(edges, communication, timed=timed)]
        if choice < 0.55:
            return [If(edges.condition(), self.step(0), self.step(0))]
        if choice < 0.75:
            inner: list[Comp] = [communication] if communication is not None and self.rng.random() < 0.4 else []
            if not inner and timed and self.rng.random() < 0.4:
                inner = [self.wait()] if self.rng.random() < 0.1 else [Wait(MS)]
            return edges.loop(inner)
        return edges.steps()

    def overflowing_guards(self, edges: Edges, communication: Read | Write, *, timed: bool) -> Comp:
        """An alternative or an interrupt whose guards compute a value that may be out of range."""
        if timed and self.rng.random() < 0.6:
            late = Guarded(After(edges.sum(TIME), self.rng.random() < 0.5), self.step(0))
            if self.rng.random() < 0.3 and "interrupt" not in self.without:
                return Interrupt(communication, late)
            return Alt((Guarded(communication, Skip()), late), self.rng.random() < 0.5)
        if isinstance(communication, Write) and isinstance(communication.value.type, Int) and self.rng.random() < 0.5:
            written = replace(communication, value=edges.sum(communication.value.type))
            return Alt((Guarded(written, Skip()), Guarded(Skip(), self.step(0))), self.rng.random() < 0.5)
        alone = Guarded(communication, self.step(0), edges.condition())
        if self.rng.random() < 0.4:
            return alone
        return Alt((alone, Guarded(Skip(), self.step(0))), self.rng.random() < 0.5)

    def overflowed(self, steps: list[Comp]) -> list[Comp]:
        """A list of steps of which one computes a value that may be out of range, or is skipped after that."""
        if not steps:
            return [self.saved(self.overflowing(1))]
        at = self.rng.randrange(len(steps))
        before, step, after = steps[:at], steps[at], steps[at + 1 :]
        edges = Edges(self.scope, self.without)
        choice = self.rng.random()
        if isinstance(step, Write) and isinstance(step.value.type, Int) and choice < 0.5:
            value = edges.sum(step.value.type)
            return [*before, self.saved([replace(step, value=value)], instead=step), *after]
        if isinstance(step, Read) and isinstance(step.target.type, Int) and choice < 0.5:
            return [*before, step, self.saved([edges.added(step.target)]), *after]
        if choice < 0.75:
            return [*before, self.saved(self.overflowing(1)), step, *after]
        end = self.rng.randint(at, len(steps))
        return [*before, self.saved([*self.overflowing(1), *steps[at:end]], instead=step), *steps[end:]]

    # ---- changes ----

    def changed(self, steps: list[Comp]) -> list[Comp]:
        """A list of steps with one change, after which it may no longer match the others."""
        if not steps:
            return self.steps(1, 1)
        at = self.rng.randrange(len(steps))
        before, step, after = steps[:at], steps[at], steps[at + 1 :]
        match self.rng.randrange(12):
            case 0 if after:
                return [*before, after[0], step, *after[1:]]
            case 1:
                return [*before, *after]
            case 2:
                return [*before, self.step(1), step, *after]
            case 3:
                return [*before, self.wait(), step, *after]
            case 4 if isinstance(step, Read | Write) and self._may_guard(step):
                other = Guarded(self.after(), self.step(0))
                return [*before, Alt((Guarded(step, Skip()), other), self.rng.random() < 0.5), *after]
            case 5 if isinstance(step, Read | Write) and self._may_guard(step):
                rest = self.sequence(after)
                other = self.guard(1)
                if _port(other.event) == _port(step):
                    other = Guarded(After(self.delay()), self.step(0))
                return [*before, Alt((Guarded(step, rest), other), self.rng.random() < 0.5)]
            case 6:
                end = self.rng.randint(at, len(steps))
                return [*before, self.interrupted(self.sequence(steps[at:end]), 1), *steps[end:]]
            case 7:
                end = self.rng.randint(at, len(steps))
                return [*before, self.caught(steps[at:end], 1), *steps[end:]]
            case 8:
                return [*before, If(self.scope.condition(), step), *after]
            case 9 if (
                isinstance(step, Read) and after and isinstance(after[0], Read) and step.channel != after[0].channel
            ):
                first, second = step, after[0]
                if not (self._may_guard(first) and self._may_guard(second)):
                    return steps
                both = (Guarded(first, second), Guarded(second, first))
                return [*before, Alt(both, self.rng.random() < 0.3), *after[1:]]
            case 10:
                return [*before, self.faulty(1), step, *after]
            case 11:
                return [*before, self.loop(step), *after]
            case _:
                return [*before, self.alternative(1), step, *after]

    def _may_guard(self, step: Read | Write) -> bool:
        return isinstance(step, Read) or step.channel in {channel.name for channel in self.scope.writes}
