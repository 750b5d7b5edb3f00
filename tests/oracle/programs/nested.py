"""Random programs of nested interrupts whose guards meet: each other, in one process or in parallel, or an offer of a
body.

They are first drawn freely. Then places at which parts that run in sequence would communicate with each other, and
those at which parallel parts would share an output or an event, are replaced.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from random import Random

from tests.oracle.programs.closed import boxes, is_wide
from tests.oracle.programs.forms import forever
from tests.oracle.programs.instants import uses_the_time
from tests.oracle.programs.places import Place, beside, ends, places
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
    Catch,
    Channel,
    Comp,
    Event,
    Expr,
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
    Seq,
    Skip,
    Stop,
    Target,
    Variable,
    Wait,
    While,
    Write,
    changed_at,
    walk,
)  # fmt: skip

OTHER = {"?": "!", "!": "?"}
NAMES = ("c0", "c1", "c2")
OUTPUTS = ("o0", "o1", "o2")
DRAWN = Lit(True, BOOL)
"""The condition of a part; it is drawn once the variables that it may use are known."""


def is_nested(seed: int) -> bool:
    """True for about one program in five; for the other seeds, programs are the same as without this choice."""
    return not is_wide(seed) and not uses_the_time(seed) and Random(f"nested {seed}").random() < 0.4


def nested(seed: int, *, inputs: bool = False, sampled: bool = False, timed: bool = True) -> Program:
    """A program with nested interrupts; `timed` with delays and time-outs, which proofs of refinement leave open."""
    rng = Random(f"nests {seed}")
    draft = _Draft(rng, inputs=inputs, sampled=sampled, timed=timed)
    bodies = [draft.branch(owner) for owner in range(rng.choice([1, 1, 1, 2, 2, 2, 3]))]
    body = Par(tuple(bodies), rng.random() < 0.2) if len(bodies) > 1 else bodies[0]
    return draft.fixed(body)


Other = Read | Write | Wait | Skip


def with_event(part: Comp, event: Other) -> Comp:
    """The place with another communication, or with a delay, which is a time-out at a guard."""
    if isinstance(part, Guarded):
        return replace(part, event=After(event.time) if isinstance(event, Wait) else event)
    return event


def _asking(part: Comp, condition: Expr) -> Comp:
    assert isinstance(part, Guarded | If)
    return replace(part, when=condition) if isinstance(part, Guarded) else replace(part, condition=condition)


def _writing(part: Comp, value: Expr) -> Comp:
    assert isinstance(part, Write)
    return replace(part, value=value)


Clash = Callable[[Place, Place, list[Place]], bool]

# ---- the draft ----


@dataclass
class _Draft:
    rng: Random
    inputs: bool
    sampled: bool
    timed: bool
    owner: int = 0
    used: list[tuple[str, str]] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)

    def fresh(self) -> str:
        self.variables.append(Variable(f"n{len(self.variables)}", INT, 0, self.owner))
        return self.variables[-1].name

    def branch(self, owner: int) -> Comp:
        self.owner = owner
        steps: list[Comp] = [self.step(0) for _ in range(self.rng.choice([0, 0, 0, 1]))]
        steps.append(self.nest(self.rng.choice([1, 2, 2, 2, 3, 3])))
        steps += [self.step(0) for _ in range(self.rng.choice([0, 0, 1]))]
        body = steps[0] if len(steps) == 1 else Seq(tuple(steps))
        return self.loop(body) if self.rng.random() < 0.2 else body

    def communication(self, inside: set[str] | None = None) -> Read | Write:
        """A channel end, often the other end of one used before; preferably of one used in a body."""
        rng = self.rng
        known = self.used if inside is None else [each for each in self.used if "".join(each) in inside]
        alone = [each for each in known if (each[0], OTHER[each[1]]) not in self.used]
        if (alone and rng.random() < 0.75) or (known and rng.random() < 0.4):
            channel, end = rng.choice(alone or known)
            end = OTHER[end]
        else:
            channel, end = rng.choice(NAMES[: rng.choice([1, 2, 2, 3])]), rng.choice("?!")
        self.used.append((channel, end))
        return Read(channel, Target(self.fresh(), INT)) if end == "?" else Write(channel, Lit(rng.randrange(4), INT))

    def delay(self) -> int:
        return self.rng.choice([1, 1, 1, 2, 2, 3]) * MS

    def wait(self) -> Comp:
        if not self.timed:
            return self.output()
        return Wait(self.delay(), self.rng.random() < 0.2)

    def output(self) -> Write:
        return Write(OUTPUTS[self.owner], Lit(self.rng.randrange(4, 8), INT))

    def event(self, body: Comp) -> Event:
        """The guard and handler that interrupt a body."""
        choice = self.rng.random()
        if choice < 0.65:
            return self.communication(uses(body, {}) if self.rng.random() < 0.8 else None)
        if choice < 0.75 and self.inputs:
            return Read(f"e{self.owner}", Target(self.fresh(), INT))
        if choice < 0.97 and self.timed:
            return After(self.delay(), self.rng.random() < 0.2)
        return Skip() if choice > 0.97 else self.communication()

    def nest(self, depth: int, *, caught: bool = False) -> Comp:
        """Nested interrupts, with other forms here and there."""
        if depth == 0:
            return self.innermost(caught=caught)
        around = self.rng.random() < 0.12
        body = self.between(self.nest(depth - 1, caught=caught or around))
        guard = Guarded(self.event(body), self.step(1, caught=caught), DRAWN if self.rng.random() < 0.12 else None)
        made: Comp = Interrupt(body, guard)
        if around:
            made = Catch(made, self.rng.choice(["Alarm", "Alarm", "Trouble"]), self.step(0))
        return made

    def between(self, body: Comp) -> Comp:
        rng = self.rng
        choice = rng.random()
        if choice < 0.5:
            return body
        if choice < 0.58:
            return Catch(body, "Alarm", self.step(0))
        if choice < 0.66:
            return Seq((body, self.step(0)))
        if choice < 0.72:
            return Seq((self.step(0), body))
        if choice < 0.8:
            return self.loop(body)
        if choice < 0.9:
            return Par((body, self.step(1)) if rng.random() < 0.5 else (self.step(1), body), rng.random() < 0.2)
        if choice < 0.94:
            return If(DRAWN, body, self.step(0))
        first = Guarded(self.communication(), body)
        return Alt((first, Guarded(self.other(), self.step(0))), rng.random() < 0.5)

    def other(self) -> Event:
        return After(self.delay()) if self.timed else Skip()

    def innermost(self, *, caught: bool) -> Comp:
        rng = self.rng
        choice = rng.random()
        if choice < 0.15:
            return Stop()
        if choice < 0.3 and self.sampled:
            return Mu(Read(f"x{self.owner}", Target(self.fresh(), INT)))
        if choice < 0.4:
            return Seq((self.wait(), self.output()))
        if choice < 0.5:
            return self.loop(self.step(0))
        if choice < 0.65:
            return Alt((Guarded(self.communication(), self.step(0)), Guarded(self.other(), self.step(0))))
        steps = tuple(self.step(1, caught=caught) for _ in range(rng.randint(1, 2)))
        return Seq(steps) if len(steps) > 1 else steps[0]

    def step(self, depth: int, *, caught: bool = False) -> Comp:
        choice = self.rng.random()
        if choice < 0.35:
            return self.communication()
        if choice < 0.65:
            return self.output()
        if choice < 0.8:
            return self.wait()
        if choice < 0.88 and caught:
            return Raise("Alarm")
        if choice < 0.9 and depth:
            return Seq((self.step(0), self.step(0, caught=caught)))
        return Skip() if choice < 0.97 else Stop()

    def loop(self, body: Comp) -> Comp:
        """A loop that runs forever, a number of times, or until a variable says so."""
        choice = self.rng.random()
        if choice < 0.5:
            waits = isinstance(body, Read | Write) and body.channel in NAMES
            return Mu(body if waits else Seq((body, Wait(MS) if self.timed else self.communication())))
        counter = Ref(self.fresh(), INT)
        count = Assign(Target(counter.name, INT), Bin("+", counter, Lit(1, INT), INT))
        times = Lit(self.rng.randint(1, 2), INT)
        if choice < 0.85:
            return Mu(Seq((body, count)), Bin(">=", counter, times, BOOL))
        return While(Bin("<", counter, times, BOOL), Seq((body, count)))

    # ---- adapted to the rules ----

    def fixed(self, body: Comp) -> Program:
        """The program that the rules of the language allow, with the kinds of channels that their users need."""
        body = self._changed_where(body, _out_of_place, self._elsewhere)
        body = self._with_both_sides(body)
        for name in OUTPUTS:
            body = self._changed_where(body, _both_write, partial(self._to, name))
        body = self._changed_where(body, _both_write, partial(self._to, ""))
        body = self._with_values(body)
        found, used = places(body), uses(body, {})
        channels = tuple(self._channel(name, found) for name in NAMES if any(_on(name, place) for place in found))
        bodies = list(body.parts) if isinstance(body, Par) else [body]
        ports = [Port(name, False, INT) for name in OUTPUTS]
        for owner in range(len(bodies)):
            ports.append(Port(f"e{owner}", True, INT, domain=(0, 1), values=((0, 0), (2_500_000, 1))))
            ports.append(Port(f"x{owner}", True, INT, self.rng.choice([2, 5]) * MS, domain=(0,), values=((0, 0),)))
        apart = isinstance(body, Par) and self.rng.random() < 0.3
        return tidy(
            Program(
                body,
                channels,
                tuple(self.variables),
                tuple(port for port in ports if port.name + ("?" if port.input else "!") in used),
                exceptions=("Alarm", "Trouble"),
                tags=frozenset({"nested"}),
                boxed=boxes(self.rng, bodies, list(channels)) if apart else frozenset(),
            )
        )

    def _elsewhere(self, place: Place) -> Other:
        if self.timed:
            return Wait(self.delay())
        return Skip() if isinstance(place.part, Guarded) else self.output()

    def _to(self, name: str, _: Place) -> Other:
        return Write(name, Lit(8, INT)) if name else Skip()

    def _changed_where(self, body: Comp, clash: Clash, other: Callable[[Place], Other]) -> Comp:
        """The parts with a replacement at each place that clashes with an earlier one."""
        found = places(body)
        kept: list[Place] = []
        for place in found:
            if any(clash(place, earlier, found) for earlier in kept):
                body = changed_at(body, place.number, partial(with_event, event=other(place)))
            elif ends(place.part):
                kept.append(place)
        return body

    def _with_both_sides(self, body: Comp) -> Comp:
        """A place that is alone on a channel gets a partner in another branch, unless there are many; otherwise it is
        replaced.
        """
        partners: list[Comp] = []
        count = len(body.parts) if isinstance(body, Par) else 1
        for name in NAMES:
            used = uses(body, {}) & {name + "?", name + "!"}
            if len(used) != 1:
                continue
            if count + len(partners) < 4 and self.rng.random() < 0.7:
                self.owner = count + len(partners)
                partners.append(self._partner(name, "!" if name + "?" in used else "?"))
                continue
            for place in places(body):
                if _on(name, place):
                    body = changed_at(body, place.number, partial(with_event, event=self._elsewhere(place)))
        if not partners:
            return body
        return Par((*body.parts, *partners), body.prioritized) if isinstance(body, Par) else Par((body, *partners))

    def _partner(self, name: str, end: str) -> Comp:
        rng = self.rng
        event = Read(name, Target(self.fresh(), INT)) if end == "?" else Write(name, Lit(rng.randrange(4), INT))
        choice = rng.random()
        if choice < 0.2:
            return forever(event)
        if choice < 0.4 and self.timed:
            return Seq((Wait(self.delay()), event))
        if choice < 0.7:
            return Alt((Guarded(event, Skip()), Guarded(self.other(), Skip())), rng.random() < 0.5)
        return Interrupt(Stop(), Guarded(event, Skip())) if choice < 0.9 else event

    def _with_values(self, body: Comp) -> Comp:
        """The values and conditions are based on what was read in parts that do not run at the same time."""
        found, rng = places(body), self.rng
        owners = {variable.name: variable.owner for variable in self.variables}
        reads = [(place, _target(place)) for place in found if _target(place)]
        for place in found:
            branch = place.path[0][1] if place.path and isinstance(body, Par) else 0
            names = [name for read, name in reads if owners[name] == branch and not beside(place, read, found)]
            value: Expr = Ref(rng.choice(names), INT) if names else Lit(rng.randrange(2), INT)
            if isinstance(place.part, If) or (isinstance(place.part, Guarded) and place.part.when is not None):
                compared = Bin(rng.choice(["==", "!=", ">"]), value, Lit(rng.randrange(3), INT), BOOL)
                body = changed_at(body, place.number, partial(_asking, condition=compared))
            elif isinstance(place.part, Write) and names and rng.random() < 0.3:
                body = changed_at(body, place.number, partial(_writing, value=value))
        return body

    def _channel(self, name: str, found: list[Place]) -> Channel:
        """Channels are of kind `any` if several parts write or read at the same time."""
        here = [place for place in found if _on(name, place)]
        several = any(
            ends(one.part) == ends(other.part) and beside(one, other, found)
            for at, one in enumerate(here)
            for other in here[:at]
        )
        kind = "any" if several else self.rng.choice(["sync"] * 8 + ["any", "buffer", "overwrite"])
        return Channel(name, INT, kind, 1 if kind in ("buffer", "overwrite") else 0)


def _on(name: str, place: Place) -> bool:
    end = ends(place.part)
    return end is not None and end[0] == name


def _target(place: Place) -> str:
    """The variable into which a place reads."""
    event = place.part.event if isinstance(place.part, Guarded) else place.part
    return event.target.name if isinstance(event, Read) else ""


def _out_of_place(place: Place, other: Place, found: list[Place]) -> bool:
    """Both ends of a channel are in parallel parts; an event is taken by parts in sequence."""
    one, earlier = ends(place.part), ends(other.part)
    if one is None or earlier is None or one[0] != earlier[0] or one[0] in OUTPUTS:
        return False
    if one[0] in NAMES:
        return one != earlier and not beside(place, other, found)
    return one[0].startswith("e") and beside(place, other, found)


def _both_write(place: Place, other: Place, found: list[Place]) -> bool:
    """An output has one writer at a time."""
    end = ends(place.part)
    return end == ends(other.part) and end is not None and end[0] in OUTPUTS and beside(place, other, found)


def guards_that_meet(program: Program) -> int:
    """How many guards of interrupts may meet an offer in their own body."""
    found = 0
    for part in walk(program.body):
        if isinstance(part, Interrupt) and (end := ends(part.guard)) is not None:
            found += end[0] + OTHER[end[1]] in uses(part.body, {})
    return found
