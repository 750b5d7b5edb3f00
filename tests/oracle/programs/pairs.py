"""Random pairs of a program and a specification, about half of which refine by construction.

`P` is made from `Q` by removing choices, or `Q` from `P` by adding some; or `P` computes the value that `Q` writes in
another way: through a variable, an expression, a struct, an array, a law. The rest has one more change that may matter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from random import Random

from tests.oracle.programs.closed import closed, is_wide
from tests.oracle.programs.forms import Forms, forever
from tests.oracle.programs.instants import uses_the_time, with_instants
from tests.oracle.programs.nested import is_nested, nested
from tests.oracle.programs.scope import MODE, PAIR, TWO, Scope, World
from tests.oracle.programs.shrink import tidy
from tests.oracle.programs.text import uses
from tests.oracle.programs.tree import (
    BOOL,
    INT,
    Alt,
    Assign,
    Bin,
    Catch,
    Channel,
    Comp,
    Expr,
    Field,
    Guarded,
    Index,
    Law,
    Lit,
    Make,
    Mu,
    Port,
    Program,
    Read,
    Ref,
    Run,
    Seq,
    Skip,
    Stop,
    Target,
    Variable,
    Wait,
    Write,
    changed_at,
    walk,
)  # fmt: skip

DOMAIN = (0, 1, 2, 7)


@dataclass
class Pair:
    program: Program
    specification: Program
    holds: bool | None  # by construction, for traces
    hidden: tuple[str, ...] = ()  # ports that only the program has


def pair(seed: int) -> Pair:
    rng = Random(seed)
    wide = is_wide(seed)
    if is_nested(seed):
        base, forms = _interrupted(rng)
    else:
        base, forms = _parallel(rng) if rng.random() < 0.3 else _sequential(rng, wide=wide)
    uses_time, instants = uses_the_time(seed), Random(f"instants {seed}")
    if uses_time:
        base = with_instants(base, instants, changes=1)
    one, other = base, base
    if wide:
        other = _sure(rng, other)
    if rng.random() < 0.5:
        one = _narrower(rng, one)
    if rng.random() < 0.5:
        other = _looser(rng, other)
    if is_nested(seed) and rng.random() < 0.5:
        other = _writing_anything(rng, base)
    one = _otherwise(rng, one, may_compute=not uses_time)
    holds: bool | None = None if wide else True
    if rng.random() < 0.5:
        world = forms.scope.world
        changed = _changed(rng, one, forms)
        if is_nested(seed) and uses(changed.body, {}) < uses(one.body, {}):
            changed = one  # a channel with one side is refused
        one, holds = (
            replace(changed, variables=tuple({v.name: v for v in (*world.variables, *one.variables)}.values())),
            None,
        )
    if uses_time and instants.random() < 0.3:
        one, holds = with_instants(one, instants, changes=1), None
    kept = base.ports
    hidden: tuple[Port, ...] = ()
    if rng.random() < 0.3:
        one, hidden = _hiding(rng, one)
    return Pair(
        replace(
            tidy(one),
            ports=(*kept, *hidden),
            name="Main",
            tags=one.tags | {"constants"},
            exceptions=one.exceptions,
            structs=base.structs,
            enums=base.enums,
        ),
        replace(tidy(other), ports=kept, name="Spec"),
        holds,
        tuple(port.name for port in hidden),
    )


def _hiding(rng: Random, program: Program) -> tuple[Program, tuple[Port, ...]]:
    """The program with a port that is written, or read, before one of its communications."""
    places = [at for at, part in enumerate(walk(program.body)) if isinstance(part, Write | Read)]
    if not places:
        return program, ()
    reads = rng.random() < 0.4
    port = Port("h0", reads, INT, domain=(0, 1), values=((0, 0),))
    step: Comp = Read("h0", Target("w2", INT)) if reads else Write("h0", Lit(rng.randrange(3), INT))
    body = changed_at(program.body, rng.choice(places), lambda part: Seq((step, part)))
    more = (Variable("w2", INT, 0, 0),) if reads else ()
    return replace(program, body=body, variables=(*program.variables, *more)), (port,)


def _parallel(rng: Random) -> tuple[Program, Forms]:
    """Branches that communicate with each other and with the environment."""
    made = closed(rng.randrange(10**9), inputs=True, sampled=False, without=frozenset({"time", "law"}))
    world = World(rng, variables=list(made.variables))
    outputs = [Channel(port.name, INT, "output") for port in made.ports if not port.input]
    scope = Scope(world, 0, [], outputs[:1], [])
    base = replace(made, boxed=frozenset(), environment=False)
    return base, Forms(scope, frozenset({"time", "law"}))


def _interrupted(rng: Random) -> tuple[Program, Forms]:
    """Nested interrupts that meet, in parallel with writers of outputs."""
    made = nested(rng.randrange(10**9), inputs=rng.random() < 0.3, timed=rng.random() < 0.3)
    outputs = [Channel(port.name, INT, "output") for port in made.ports if not port.input]
    scope = Scope(World(rng, variables=list(made.variables)), 0, [], outputs[:1], [])
    base = replace(made, boxed=frozenset(), environment=False, structs=(PAIR,), enums=(MODE,))
    return base, Forms(scope, frozenset({"time", "law"}))


def _writing_anything(rng: Random, program: Program) -> Program:
    """A specification that writes, in any order, what a program may write, and may end or not."""
    outputs = [port.name for port in program.ports if not port.input]
    guards = [Guarded(Skip(), Write(name, Lit(value, INT))) for name in outputs for value in range(9)]
    guards += [Guarded(Read(port.name, Target("w3", INT)), Skip()) for port in program.ports if port.input]
    ended = Variable("w4", INT, 0, 0)
    last = Assign(Target("w4", INT), Lit(1, INT))
    body: Comp = Mu(Alt(tuple(guards))) if guards else Stop()
    if guards and rng.random() < 0.6:
        body = Mu(Alt((*guards, Guarded(Skip(), last))), Bin("==", Ref("w4", INT), Lit(1, INT), BOOL))
    return replace(program, body=body, channels=(), variables=(Variable("w3", INT, 0, 0), ended), exceptions=())


def _sequential(rng: Random, *, wide: bool) -> tuple[Program, Forms]:
    """One process that communicates with the environment."""
    world = World(rng, rich=rng.random() < 0.3, wide=wide)
    domain = (-(2**63), 0, 1, 2**63 - 1) if wide else DOMAIN
    inputs = [Channel(f"i{number}", INT, "event") for number in range(rng.choice([0, 1, 1, 2]))]
    outputs = [Channel(f"o{number}", INT, "output") for number in range(rng.choice([1, 1, 2]))]
    scope = Scope(world, 0, inputs, outputs, [])
    without = frozenset({"time", "law"}) if rng.random() < 0.8 else frozenset({"law"})
    forms = Forms(scope, without)
    steps = forms.steps(rng.randint(1, 3), 1)
    for output in outputs:
        steps.insert(rng.randrange(len(steps) + 1), Write(output.name, scope.number()))
    steps += [Read(channel.name, scope.target(INT)) for channel in inputs if rng.random() < 0.7]
    if wide:
        steps = forms.overflowed(steps)
    body = forms.sequence(steps)
    looped = rng.random()
    body = forms.loop(body) if looped < 0.4 else forever(body) if looped < 0.6 else body
    ports = [Port(channel.name, True, INT, domain=domain, values=((0, 0),)) for channel in inputs]
    ports += [Port(channel.name, False, INT) for channel in outputs]
    base = Program(
        body,
        ports=tuple(ports),
        variables=tuple(world.variables),
        enums=(MODE,),
        structs=(PAIR,),
        exceptions=tuple(sorted(world.exceptions)),
        environment=False,
    )
    return base, forms


def _number(part: Comp) -> bool:
    """Whether it writes a number."""
    return isinstance(part, Write) and part.value.type == INT


def _narrower(rng: Random, program: Program) -> Program:
    """The program without one of the choices of an alternative whose guards are all always ready, or of any `[]`."""
    places = [at for at, part in enumerate(walk(program.body)) if isinstance(part, Alt) and not part.prioritized]
    if not places:
        return program

    def fewer(part: Comp) -> Comp:
        assert isinstance(part, Alt)
        left = rng.choice(part.branches)
        return left.body if isinstance(left.event, Skip) and left.when is None else part

    return replace(program, body=changed_at(program.body, rng.choice(places), fewer))


def _sure(rng: Random, program: Program) -> Program:
    """The program with another handler of a fault: it matters if the fault happens."""
    places = [at for at, part in enumerate(walk(program.body)) if isinstance(part, Catch) and part.name == "Fault"]
    if not places:
        return program

    def otherwise(part: Comp) -> Comp:
        assert isinstance(part, Catch)
        return replace(part, handler=rng.choice((Skip(), Stop())))

    return replace(program, body=changed_at(program.body, rng.choice(places), otherwise))


def _looser(rng: Random, program: Program) -> Program:
    """The program with another value that may be written instead."""
    places = [at for at, part in enumerate(walk(program.body)) if _number(part)]
    if not places:
        return program

    def more(part: Comp) -> Comp:
        assert isinstance(part, Write)
        other = Write(part.channel, Lit(rng.randrange(4), INT))
        return Alt((Guarded(Skip(), part), Guarded(Skip(), other)))

    return replace(program, body=changed_at(program.body, rng.choice(places), more))


def _otherwise(rng: Random, program: Program, *, may_compute: bool) -> Program:
    """The program with one written value computed in another way."""
    places = [at for at, part in enumerate(walk(program.body)) if _number(part)]
    if not places or rng.random() < 0.2:
        return program
    way = rng.randrange(6 if may_compute else 4)
    fresh = Variable(
        "w0", PAIR if way == 2 else TWO if way == 3 else INT, (0, False) if way == 2 else (0, 0) if way == 3 else 0, 0
    )
    through = Variable("w1", INT, 0, 0)
    law = Law("keep", (("x", INT, "w0"),), (("y", INT, "w1", Ref("x", INT)),), (), 1000, 0)

    def made(part: Comp) -> Comp:
        assert isinstance(part, Write)
        value: Expr = part.value
        ref = Ref("w0", fresh.type)
        whole = Target("w0", fresh.type)
        match way:
            case 0:
                return Seq((Assign(whole, value), Write(part.channel, ref)))
            case 1:
                return Write(part.channel, Bin("-", Bin("+", value, Lit(1, INT), INT), Lit(1, INT), INT))
            case 2:
                whole_value = Make((value, Lit(True, PAIR.fields[1][1])), PAIR)
                return Seq((Assign(whole, whole_value), Write(part.channel, Field(ref, 0, "a", INT))))
            case 3:
                both = Make((Lit(3, INT), value), TWO)
                return Seq((Assign(whole, both), Write(part.channel, Index(ref, Lit(1, INT), INT))))
            case 4:
                return Seq((Assign(whole, value), Run("keep"), Write(part.channel, Ref("w1", INT))))
            case _:
                return Write(part.channel, Bin("*", value, Lit(1, INT), INT))

    body = changed_at(program.body, rng.choice(places), made)
    laws = (law,) if way == 4 else ()
    return replace(program, body=body, variables=(*program.variables, fresh, through), laws=laws)


def _changed(rng: Random, program: Program, forms: Forms) -> Program:
    """The program with a change that may matter: another value, one step more or less."""
    places = [at for at, part in enumerate(walk(program.body)) if not isinstance(part, Guarded)]

    def other(part: Comp) -> Comp:
        match rng.randrange(4):
            case 0 if isinstance(part, Write) and _number(part):
                return replace(part, value=forms.scope.number())
            case 1 if isinstance(part, Write) and _number(part):
                return Write(part.channel, Lit(rng.choice(DOMAIN), INT))
            case 2 if not isinstance(part, Mu):
                return Seq((part, forms.step(0)))
            case _:
                return Skip() if not isinstance(part, Mu | Seq | Wait) else part

    return replace(program, body=changed_at(program.body, rng.choice(places), other))
