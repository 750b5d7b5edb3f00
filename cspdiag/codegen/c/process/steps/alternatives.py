"""Alternatives: guards that are initialized once and enabled before each selection, and the branch that was chosen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.steps.alike import Run, runs
from cspdiag.codegen.c.process.steps.plain_steps import (
    check_finite,
    hand_over,
    mark_written,
    read_variable,
    size_of,
    store_value,
)
from cspdiag.codegen.c.process.steps.turns import turn_finder
from cspdiag.codegen.c.process.struct.members import StructMember
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import EQUALITY, RELATION, Code, address, call, code, infix, own, unsigned
from cspdiag.codegen.c.text.media import EndInC
from cspdiag.codegen.c.text.rolling import rolled
from cspdiag.codegen.c.text.statements import (
    Label,
    Plain,
    Statement,
    Switch,
    can_wait,
    choose,
    goto,
    has_effect,
    run,
    store,
)
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.actions import AfterEvent, Branch, Choice, Event, InputEvent, OutputEvent, ReadyEvent, SkipEvent
from cspdiag.network.ir.faults import is_known_at_start

MOST_GUARDS = 65_535
"""The kernel numbers guards with 16 bits."""
_MAX_TESTED_BRANCHES = 8
"""Up to this number of branches an ``if`` tests each in turn; with more, a ``switch`` jumps to the chosen one."""

_GUARDS_OF_WORD = 32
"""``CSP_GUARDS_OF_WORD`` of the kernel: up to this number of guards need no array of words on any machine."""


@dataclass(eq=False)
class Guard:
    """One guard of an alternative or interrupt; guards with equal text are different guards."""

    branch: Branch
    kept: Code | None = None
    """The lvalue for the value that it writes or reads, if that is not a variable of the process."""

    @property
    def event(self) -> Event:
        """The event that it waits for."""
        return self.branch.event


@record
class _Body:
    """What the branches from ``start`` to before ``end`` run; ``guard`` is the first one's."""

    guard: Guard
    start: int
    end: int
    statements: list[Statement]


def choice(writer: Writer, step: Choice) -> list[Statement]:
    """Chooses one of the guards that are ready, and continues with its process."""
    if len(step.branches) > MOST_GUARDS:
        raise TargetError(
            f"{step.span}: an alternative of {len(step.branches)} guards: C numbers them with 16 bits, which is enough "
            f"for {MOST_GUARDS}\n  help: let several processes choose, each among a part of them"
        )
    name = writer.members.names.fresh(step.name)
    member = own(name)
    alternative = address(member.field("alternative"))
    number_chosen = member.field("alternative").field("chosen")
    parts = list(runs(writer.members, turn_finder(writer), step.branches, number_chosen))
    guards = [guard for part in parts for guard in _guards(writer, step, part, name)]
    timers = [guard for guard in guards if isinstance(guard.event, AfterEvent)]
    writer.members.structs[name] = _fields(len(guards), len(timers))
    conditional = any(branch.condition is not None for branch in step.branches)
    setup: list[Statement] = [_initialized(member, len(guards), prioritized=step.prioritized)]
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
    inputs = all(isinstance(branch.event, InputEvent) for branch in step.branches)
    if inputs and not conditional and not step.prioritized:
        begun = call("csp_select_inputs", "party", alternative, unsigned(len(guards)))
    else:
        begun = call("csp_select", "party", alternative)
    waiting = writer.wait(begun, again, place)
    bodies = [_body(writer, part, guards[part.start]) for part in parts]
    return [writer.remark(step), *enabling, waiting, *_chosen(writer, number_chosen, bodies)]


def _fields(count: int, timers: int) -> list[StructMember]:
    """The members of an alternative with this number of guards."""
    members = [StructMember("csp_alternative alternative"), StructMember(f"csp_guard guards[{count}]")]
    if timers:
        members.append(StructMember(f"csp_timer time_outs[{timers}]"))
    if count > _GUARDS_OF_WORD:
        members.append(StructMember(f"csp_word words[2U * CSP_WORDS({count}U)]"))
    return members


def _initialized(member: Code, count: int, *, prioritized: bool) -> Plain:
    words = member.field("words") if count > _GUARDS_OF_WORD else code("NULL")
    alternative, guards = address(member.field("alternative")), member.field("guards")
    truth = "true" if prioritized else "false"
    return run(call("csp_alternative_init", alternative, guards, unsigned(count), words, truth))


def _guards(writer: Writer, step: Choice, part: Run, name: str) -> Iterator[Guard]:
    """The guards of a run of branches. Those that read share the member for the value, which only the one that is
    chosen sets.
    """
    first: Guard | None = None
    for number in range(part.start, part.end):
        branch = step.branches[number]
        if first is not None and isinstance(branch.event, InputEvent):
            yield Guard(branch, first.kept)
            continue
        guard = make_guard(writer, branch, f"{name}_value_{number}")
        first = first or guard
        yield guard


def _body(writer: Writer, part: Run, first: Guard) -> _Body:
    """What a run of branches does once one of their guards is chosen."""
    outer = writer.in_turns
    writer.in_turns = outer or part.is_shared
    statements = writer.statements(part.branch.body)
    beginning = branch_beginning(writer, Guard(part.branch, first.kept))
    writer.in_turns = outer
    return _Body(Guard(part.branch, first.kept), part.start, part.end, [*beginning, *statements])


def make_guard(writer: Writer, branch: Branch, name: str) -> Guard:
    """A guard, with a member for the value that it reads or writes if it needs one."""
    guard, event = Guard(branch), branch.event
    match event:
        case InputEvent(source=source, target=target):
            end = writer.members.source(source)
            if target.indexes and not end.never_waits:
                guard.kept = _kept(writer, name, end)
        case OutputEvent(sink=sink):
            guard.kept = _kept(writer, name, writer.members.sink(sink))
        case ReadyEvent() | AfterEvent() | SkipEvent():
            pass
        case _:
            assert_never(event)
    return guard


def _kept(writer: Writer, name: str, end: EndInC) -> Code:
    member = writer.members.names.fresh(name)
    writer.members.work.append(StructMember(f"{writer.members.types.type_name(end.type)} {member}"))
    return own(member)


def guard_call(writer: Writer, guard: Guard, alternative: Code, number: int, timer: Code) -> Code:
    """The call that initializes a guard; a communication that never waits is a guard that is always ready."""
    event, members = guard.event, writer.members
    match event:
        case InputEvent(source=source, target=target) if not (end := members.source(source)).never_waits:
            into = guard.kept or members.variable(target.channel)
            return call("csp_guard_read", alternative, unsigned(number), end.medium, address(into), size_of(into))
        case ReadyEvent(source=source) if not (end := members.source(source)).never_waits:
            return call("csp_guard_ready", alternative, unsigned(number), end.medium)
        case OutputEvent(sink=sink) if not (end := members.sink(sink)).never_waits:
            assert guard.kept is not None
            value = guard.kept
            return call("csp_guard_write", alternative, unsigned(number), end.medium, address(value), size_of(value))
        case AfterEvent():
            return call("csp_guard_after", alternative, unsigned(number), address(timer))
        case InputEvent() | ReadyEvent() | OutputEvent() | SkipEvent():
            return call("csp_guard_skip", alternative, unsigned(number))
    assert_never(event)


def _enabled(writer: Writer, guard: Guard, alternative: Code, number: int, *, conditional: bool) -> list[Statement]:
    """The statements before a selection that prepare a guard, and enable it if its condition holds."""
    prepared = prepare(writer, guard, alternative, number)
    condition = guard.branch.condition
    if conditional:
        prepared.append(run(call("csp_enable", alternative, unsigned(number))))
    if condition is None:
        return prepared
    setup, holds = writer.condition(condition, guard.branch)
    return [*setup, *choose(holds, prepared)]


def prepare(writer: Writer, guard: Guard, alternative: Code, number: int, *, always: bool = False) -> list[Statement]:
    """The statements that set the value to be written, or the length of a time-out that varies (or ``always``)."""
    event = guard.event
    where = writer.where(event)
    match event:
        case OutputEvent(value=value):
            assert guard.kept is not None
            return writer.evaluate_into(guard.kept, value, where)
        case AfterEvent(duration=duration) if always or not is_known_at_start(duration):
            setup, known = writer.operand(duration, where, "duration")
            return [*setup, run(call("csp_delay", alternative, unsigned(number), known))]
    return []


def branch_beginning(writer: Writer, guard: Guard) -> list[Statement]:
    """The statements at the beginning of a branch: communications that never wait, and assignments of values that were
    read to elements of arrays.
    """
    event, where = guard.event, writer.where(guard.event)
    remark = writer.remark(event)
    match event:
        case InputEvent(source=source, target=target):
            end = writer.members.source(source)
            if end.never_waits:
                return [remark, *read_variable(writer, target, end, where)]
            if guard.kept is not None:
                return [remark, *store_value(writer, target, guard.kept, end.type, where)]
            return [remark, *writer.mark_written(target.channel)]
        case OutputEvent(sink=sink):
            end, value = writer.members.sink(sink), guard.kept
            assert value is not None
            if end.access == "variable":
                return [remark, store(end.pointer, value), *mark_written(end)]
            if end.access in ("latched", "direct"):
                return [remark, *check_finite(writer, end, value, where), hand_over(end, value)]
            return [remark]
        case ReadyEvent() | AfterEvent() | SkipEvent():
            return [remark]
        case _:
            assert_never(event)


def _chosen(writer: Writer, chosen: Code, bodies: Sequence[_Body]) -> list[Statement]:
    """The branches: as a ``switch`` if they do not wait, else as an ``if`` or with jumps."""
    if len(bodies) == 1:
        return bodies[0].statements
    if not any(has_effect(body.statements) for body in bodies):
        return []
    waits = any(can_wait(body.statements) for body in bodies)
    if len(bodies) == 2 or (waits and len(bodies) <= _MAX_TESTED_BRANCHES):
        return _tested(chosen, bodies)
    return _jumps(writer, chosen, bodies) if waits else _switch(chosen, bodies)


def _tested(chosen: Code, bodies: Sequence[_Body]) -> list[Statement]:
    statements = bodies[-1].statements
    for body in reversed(bodies[:-1]):
        if body.end == body.start + 1:
            test = infix("==", EQUALITY, chosen, unsigned(body.start))
        else:
            test = infix("<", RELATION, chosen, unsigned(body.end))
        statements = choose(test, body.statements, statements)
    return statements


def _switch(chosen: Code, bodies: Sequence[_Body]) -> list[Statement]:
    return [
        Switch(
            chosen,
            tuple(
                case
                for body in bodies
                for case in _cases(
                    body,
                    bodies[-1],
                    (*body.statements, *([run("break")] if can_complete(body.guard.branch.body) else [])),
                )
            ),
        )
    ]


def _cases(body: _Body, last: _Body, statements: Sequence[Statement]) -> Iterator[tuple[str, tuple[Statement, ...]]]:
    """The cases of a ``switch`` for the branches of a body: the last one has its statements."""
    if body is last:
        yield "default", tuple(statements)
        return
    for number in range(body.start, body.end - 1):
        yield f"case {number}", ()
    yield f"case {body.end - 1}", tuple(statements)


def _jumps(writer: Writer, chosen: Code, bodies: Sequence[_Body]) -> list[Statement]:
    after = writer.states.fresh("chosen")
    labels = [writer.states.fresh(f"guard_{body.start}") for body in bodies]
    cases = tuple(
        case for label, body in zip(labels, bodies, strict=True) for case in _cases(body, bodies[-1], (goto(label),))
    )
    statements: list[Statement] = [Switch(chosen, cases)]
    for label, body in zip(labels, bodies, strict=True):
        statements += [Label(label), *body.statements]
        if can_complete(body.guard.branch.body):
            statements.append(goto(after))
    if any(can_complete(body.guard.branch.body) for body in bodies):
        statements.append(Label(after))
    return statements
