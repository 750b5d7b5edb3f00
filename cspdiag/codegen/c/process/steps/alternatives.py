"""Alternatives: guards that are set up once, enabled at each selection, and the branch that was chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.steps.alike import shared_body
from cspdiag.codegen.c.process.steps.plain_steps import finite_checked, hand_over, mark_written, put, size_of, take
from cspdiag.codegen.c.process.struct.members import StructMember
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import EQUALITY, Code, address, call, code, infix, own, unsigned
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.rolling import rolled
from cspdiag.codegen.c.text.statements import (
    Label,
    Plain,
    Statement,
    Switch,
    can_wait,
    choose,
    go,
    has_effect,
    run,
    store,
)
from cspdiag.network.ir.actions import AfterEvent, Branch, Choice, Event, InputEvent, OutputEvent, ReadyEvent, SkipEvent
from cspdiag.network.ir.faults import is_known_at_start

FEW = 8
"""Up to this number of branches each is tested in turn; with more the chosen one is jumped to."""

WORD = 64
"""Guards that need no further words; on machines of 32 bits the words are always there."""


@dataclass(eq=False)
class Guard:
    """One guard of an alternative or interrupt; guards of one text are not the same guard."""

    branch: Branch
    kept: Code | None = None
    """The lvalue of what it writes or reads, where that is no variable of the process."""

    @property
    def event(self) -> Event:
        """What it waits for."""
        return self.branch.event


def choice(writer: Writer, step: Choice) -> list[Statement]:
    """Chooses one of the guards that are ready, and goes on with its process."""
    name = writer.members.names.fresh(step.name)
    member = own(name)
    alternative = address(member.field("alternative"))
    guards = [make_guard(writer, branch, f"{name}_value_{number}") for number, branch in enumerate(step.branches)]
    timers = [guard for guard in guards if isinstance(guard.event, AfterEvent)]
    writer.members.structs[name] = _fields(len(guards), len(timers))
    conditional = any(branch.condition is not None for branch in step.branches)
    setup: list[Statement] = [_made(member, len(guards), prioritized=step.prioritized)]
    positions = {guard: position for position, guard in enumerate(timers)}
    made: list[list[Plain]] = []
    for number, guard in enumerate(guards):
        timer = member.field("time_outs").at(positions[guard]) if guard in positions else member
        made.append([run(guard_call(writer, guard, alternative, number, timer))])
        if isinstance(guard.event, AfterEvent) and is_known_at_start(guard.event.duration):
            duration = writer.members.initial_printer.plain(guard.event.duration)
            made[-1].append(run(call("csp_delay", alternative, unsigned(number), duration)))
    setup += rolled(made)
    if not conditional:
        setup.append(run(call("csp_enable_all", alternative)))
    writer.members.made_choices[step.name] = setup

    enabling: list[Statement] = [run(call("csp_enable_none", alternative))] if conditional else []
    for number, guard in enumerate(guards):
        enabling += _enabled(writer, guard, alternative, number, conditional=conditional)
    state = step.name.replace("choice", "chooses")
    place = writer.place(step, state, "ALTERNATIVE", member.member.field("alternative"))
    again = call("csp_select_again", "party", alternative)
    waited = writer.wait(call("csp_select", "party", alternative), again, place)
    number_chosen = member.field("alternative").field("chosen")
    shared = shared_body(writer, step, number_chosen) if len(guards) > FEW else None
    if shared is not None:
        return [writer.remark(step), *enabling, waited, *taken(writer, guards[0]), *shared]
    bodies = [[*taken(writer, guard), *writer.statements(guard.branch.body)] for guard in guards]
    return [writer.remark(step), *enabling, waited, *_chosen(writer, number_chosen, guards, bodies)]


def _fields(count: int, timers: int) -> list[StructMember]:
    """The members of an alternative with this number of guards."""
    found = [StructMember("csp_alternative alternative"), StructMember(f"csp_guard guards[{count}]")]
    if timers:
        found.append(StructMember(f"csp_timer time_outs[{timers}]"))
    if count > WORD // 2:
        found.append(StructMember(f"csp_word words[2U * CSP_WORDS({count}U)]"))
    return found


def _made(member: Code, count: int, *, prioritized: bool) -> Plain:
    words = member.field("words") if count > WORD // 2 else code("NULL")
    alternative, guards = address(member.field("alternative")), member.field("guards")
    truth = "true" if prioritized else "false"
    return run(call("csp_alternative_init", alternative, guards, unsigned(count), words, truth))


def make_guard(writer: Writer, branch: Branch, name: str) -> Guard:
    """A guard, with a place for what it reads or writes where that is needed."""
    guard, event = Guard(branch), branch.event
    match event:
        case InputEvent(source=source, target=target):
            end = writer.members.source(source)
            if target.indexes and not end.at_once:
                guard.kept = _kept(writer, name, end)
        case OutputEvent(sink=sink):
            guard.kept = _kept(writer, name, writer.members.sink(sink))
        case ReadyEvent() | AfterEvent() | SkipEvent():
            pass
        case _:
            assert_never(event)
    return guard


def _kept(writer: Writer, name: str, end: Spelling) -> Code:
    member = writer.members.names.fresh(name)
    writer.members.work.append(StructMember(f"{writer.members.types.type_name(end.type)} {member}"))
    return own(member)


def guard_call(writer: Writer, guard: Guard, alternative: Code, number: int, timer: Code) -> Code:
    """The call that makes a guard; what never waits is a guard that is always ready."""
    event, members = guard.event, writer.members
    match event:
        case InputEvent(source=source, target=target) if not (end := members.source(source)).at_once:
            into = guard.kept or members.variable(target.channel)
            return call("csp_guard_read", alternative, unsigned(number), end.medium, address(into), size_of(into))
        case ReadyEvent(source=source) if not (end := members.source(source)).at_once:
            return call("csp_guard_ready", alternative, unsigned(number), end.medium)
        case OutputEvent(sink=sink) if not (end := members.sink(sink)).at_once:
            assert guard.kept is not None
            value = guard.kept
            return call("csp_guard_write", alternative, unsigned(number), end.medium, address(value), size_of(value))
        case AfterEvent():
            return call("csp_guard_after", alternative, unsigned(number), address(timer))
        case InputEvent() | ReadyEvent() | OutputEvent() | SkipEvent():
            return call("csp_guard_skip", alternative, unsigned(number))
    assert_never(event)


def _enabled(writer: Writer, guard: Guard, alternative: Code, number: int, *, conditional: bool) -> list[Statement]:
    """What a selection does for a guard beforehand, where its condition holds."""
    prepared = prepare(writer, guard, alternative, number)
    condition = guard.branch.condition
    if conditional:
        prepared.append(run(call("csp_enable", alternative, unsigned(number))))
    if condition is None:
        return prepared
    setup, holds = writer.condition(condition, guard.branch)
    return [*setup, *choose(holds, prepared)]


def prepare(writer: Writer, guard: Guard, alternative: Code, number: int, *, always: bool = False) -> list[Statement]:
    """The value to be written, or the length of a time-out that varies (or ``always``)."""
    event = guard.event
    where = writer.where(event)
    match event:
        case OutputEvent(value=value):
            assert guard.kept is not None
            return writer.evaluated(guard.kept, value, where)
        case AfterEvent(duration=duration) if always or not is_known_at_start(duration):
            setup, known = writer.operand(duration, where, "duration")
            return [*setup, run(call("csp_delay", alternative, unsigned(number), known))]
    return []


def taken(writer: Writer, guard: Guard) -> list[Statement]:
    """What the branch of a guard begins with: the communication of what never waits, and values into elements of
    arrays.
    """
    event, where = guard.event, writer.where(guard.event)
    remark = writer.remark(event)
    match event:
        case InputEvent(source=source, target=target):
            end = writer.members.source(source)
            if end.at_once:
                return [remark, *take(writer, target, end, where)]
            if guard.kept is not None:
                return [remark, *put(writer, target, guard.kept, end.type, where)]
            return [remark, *writer.wrote(target.channel)]
        case OutputEvent(sink=sink):
            end, value = writer.members.sink(sink), guard.kept
            assert value is not None
            if end.access == "variable":
                return [remark, store(end.pointer, value), *mark_written(end)]
            if end.access in ("latched", "direct"):
                return [remark, *finite_checked(writer, end, value, where), hand_over(end, value)]
            return [remark]
        case ReadyEvent() | AfterEvent() | SkipEvent():
            return [remark]
        case _:
            assert_never(event)


def _chosen(
    writer: Writer, chosen: Code, guards: Sequence[Guard], bodies: Sequence[list[Statement]]
) -> list[Statement]:
    """The branches: as a ``switch`` where they do not wait, else as an ``if`` or a jump."""
    if len(bodies) == 1:
        return bodies[0]
    if not any(map(has_effect, bodies)):
        return []
    waits = any(map(can_wait, bodies))
    if len(bodies) == 2 or (waits and len(bodies) <= FEW):
        return _tested(chosen, bodies)
    return _jumps(writer, chosen, guards, bodies) if waits else _switch(chosen, guards, bodies)


def _tested(chosen: Code, bodies: Sequence[list[Statement]]) -> list[Statement]:
    found = bodies[-1]
    for number in range(len(bodies) - 2, -1, -1):
        found = choose(infix("==", EQUALITY, chosen, unsigned(number)), bodies[number], found)
    return found


def _switch(chosen: Code, guards: Sequence[Guard], bodies: Sequence[list[Statement]]) -> list[Statement]:
    cases = []
    for number, (guard, body) in enumerate(zip(guards, bodies, strict=True)):
        label = f"case {number}" if number < len(bodies) - 1 else "default"
        cases.append((label, (*body, *([run("break")] if ends(guard.branch.body) else []))))
    return [Switch(chosen, tuple(cases))]


def _jumps(writer: Writer, chosen: Code, guards: Sequence[Guard], bodies: Sequence[list[Statement]]) -> list[Statement]:
    after = writer.states.fresh("chosen")
    labels = [writer.states.fresh(f"guard_{number}") for number in range(len(bodies))]
    cases = tuple(
        (f"case {number}" if number < len(labels) - 1 else "default", (go(label),))
        for number, label in enumerate(labels)
    )
    found: list[Statement] = [Switch(chosen, cases)]
    for guard, label, body in zip(guards, labels, bodies, strict=True):
        found += [Label(label), *body]
        if ends(guard.branch.body):
            found.append(go(after))
    if any(ends(guard.branch.body) for guard in guards):
        found.append(Label(after))
    return found
