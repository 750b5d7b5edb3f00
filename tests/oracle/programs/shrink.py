"""Makes a program smaller while its answer stays wrong."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from tests.oracle.programs.text import branches, uses
from tests.oracle.programs.tree import (
    After,
    Alt,
    Assign,
    Bin,
    Bool,
    Catch,
    Channel,
    Comp,
    Expr,
    Guarded,
    If,
    If3,
    Int,
    Interrupt,
    Lit,
    Mu,
    Par,
    Program,
    Raise,
    Read,
    Replicated,
    Run,
    Seq,
    Skip,
    Un,
    Wait,
    While,
    Write,
    parts,
    walk,
    with_parts,
)  # fmt: skip

Wrong = Callable[[Program], bool]


def shrink(program: Program, wrong: Wrong, *, seconds: float = 60) -> Program:
    """Try smaller programs, starting again as soon as one is still wrong, until none is or the time is up."""
    end = time.monotonic() + seconds
    found_smaller = True
    while found_smaller:
        found_smaller = False
        for smaller in _smaller(program):
            if time.monotonic() > end:
                return program
            made = tidy(smaller)
            if made != program and wrong(made):
                program, found_smaller = made, True
                break
    return program


def tidy(program: Program) -> Program:
    """The program without what nothing uses."""
    laws = {law.name: law for law in program.laws}
    used = set().union(*(uses(part, laws) for part in branches(program)))
    runs = {part.law for part in walk(program.body) if isinstance(part, Run)}
    names = repr(program.body)
    kept = [law for law in program.laws if law.name in runs]
    touched = {name for law in kept for name in (*(s for _, _, s in law.inputs), *(s for _, _, s, _ in law.outputs))}
    channels: list[Channel] = [each for each in program.channels if {each.name + "?", each.name + "!"} & used]
    raised = {part.name for part in walk(program.body) if isinstance(part, Raise | Catch)}
    return replace(
        program,
        channels=tuple(channels),
        laws=tuple(kept),
        ports=tuple(port for port in program.ports if {port.name + "?", port.name + "!"} & used),
        variables=tuple(v for v in program.variables if f"'{v.name}'" in names or v.name in touched),
        exceptions=tuple(name for name in program.exceptions if name in raised),
        enums=tuple(enum for enum in program.enums if f"Enum(name='{enum.name}'" in repr((program.body, channels))),
        structs=tuple(
            each for each in program.structs if f"Struct(name='{each.name}'" in repr((program.body, channels))
        ),
    )


def _smaller(program: Program) -> Iterator[Program]:
    if program.boxed:
        yield replace(program, boxed=frozenset())
    if isinstance(program.body, Par):
        if program.body.prioritized:
            yield replace(program, body=replace(program.body, prioritized=False))
        for at, branch in enumerate(program.body.parts):
            for smaller in [Skip(), *_simpler(branch)]:
                made = (*program.body.parts[:at], smaller, *program.body.parts[at + 1 :])
                if made != program.body.parts:
                    yield replace(program, body=Par(made, program.body.prioritized))
    else:
        for smaller in _simpler(program.body):
            yield replace(program, body=smaller)
    for law in program.laws:
        if law.wcet not in (None, 1000):
            yield replace(
                program, laws=tuple(replace(law, wcet=1000) if each is law else each for each in program.laws)
            )


def _simpler(node: Comp) -> Iterator[Comp]:
    """The same composition with one part less."""
    if not isinstance(node, Skip | Guarded):
        yield Skip()
    match node:
        case Seq(steps):
            for at in range(len(steps)):
                left = (*steps[:at], *steps[at + 1 :])
                yield left[0] if len(left) == 1 else Seq(left)
        case Par(inner) | Alt(inner):
            yield from (part.body if isinstance(part, Guarded) else part for part in inner)
            if len(inner) > 2:
                for at in range(len(inner)):
                    yield with_parts(node, (*inner[:at], *inner[at + 1 :]))
        case Guarded(event, body, when):
            if when is not None:
                yield replace(node, when=None)
                yield from (replace(node, when=each) for each in _values(when))
            if body != Skip():
                yield replace(node, body=Skip())
            yield from (replace(node, event=each) for each in _events(event))
        case Mu(body, until):
            yield body
            yield from (replace(node, until=each) for each in ([None, *_values(until)] if until else []))
        case While(test, body) | If(test, body):
            yield body
            yield from (replace(node, condition=each) for each in _values(test))
        case Catch(body) | Interrupt(body):
            yield body
        case Replicated(_, _, _, body):
            if not isinstance(body, Guarded):
                yield body
        case Write(_, value) | Assign(_, value):
            yield from (replace(node, value=each) for each in _values(value))
        case Wait(time_, until) if until or not isinstance(time_, int) or time_ > 10**6:
            yield Wait(10**6)
            if not isinstance(time_, int):
                yield from (replace(node, time=each) for each in _values(time_))
    inner_parts = parts(node)
    for at, part in enumerate(inner_parts):
        for smaller in _simpler(part):
            if not isinstance(part, Guarded) or isinstance(smaller, Guarded):
                yield with_parts(node, (*inner_parts[:at], smaller, *inner_parts[at + 1 :]))


def _events(event: object) -> Iterator[Read | Write | After]:
    if isinstance(event, Write):
        yield from (replace(event, value=each) for each in _values(event.value))
    if isinstance(event, After) and not isinstance(event.time, int):
        yield from (replace(event, time=each) for each in _values(event.time))


def _values(value: Expr) -> Iterator[Expr]:
    """Simpler expressions of the same type."""
    if not isinstance(value, Lit) and isinstance(value.type, Int):
        yield Lit(1, value.type)
    if not isinstance(value, Lit) and isinstance(value.type, Bool):
        yield Lit(True, value.type)
    match value:
        case Lit(_, _, True):
            yield replace(value, constant=False)
        case Un(_, of):
            yield of
            yield from (replace(value, of=each) for each in _values(of))
        case If3(condition, yes, no):
            yield from (yes, no)
            yield from (replace(value, condition=each) for each in _values(condition))
        case Bin(_, left, right):
            yield from (each for each in (left, right) if each.type == value.type)
            yield from (replace(value, left=each) for each in _values(left))
            yield from (replace(value, right=each) for each in _values(right))
