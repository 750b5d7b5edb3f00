"""Alternatives: guards that are set up once, enabled at each selection, and the branch that was chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.members import SELF, Member
from cspdiag.codegen.c.process.plain_steps import WRITES, finite_rows, flag_rows, store_rows, take_rows
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.rows import Row, block, rows
from cspdiag.network.ir.actions import AfterEvent, Branch, Choice, Event, InputEvent, OutputEvent, ReadyEvent, SkipEvent
from cspdiag.network.ir.faults import is_known_at_start

FEW = 8
"""Of so many branches each is asked for in turn; of more the chosen one is jumped to."""

WORD = 64
"""Guards that need no further words; on machines of 32 bits the words are always there."""


@dataclass(eq=False)
class Guard:
    """One guard of an alternative or interrupt; guards of one text are not the same guard."""

    branch: Branch
    setup: list[str] = field(default_factory=list)
    """Calls that make it, without the first argument, the alternative."""
    kept: str | None = None
    """The lvalue of what it writes or reads, where that is no variable of the process."""

    @property
    def event(self) -> Event:
        """What it waits for."""
        return self.branch.event


def choice_rows(writer: Writer, choice: Choice) -> list[Row]:
    """Chooses one of the guards that are ready, and goes on with its process."""
    member = writer.members.names.fresh(choice.name)
    alternative = f"{SELF}{member}.alternative"
    guards = [make_guard(writer, branch, f"{member}_value_{number}") for number, branch in enumerate(choice.branches)]
    count = len(guards)
    fields = [Member("csp_alternative alternative"), Member(f"csp_guard guards[{count}]")]
    timers = [guard for guard in guards if isinstance(guard.event, AfterEvent)]
    if timers:
        fields.append(Member(f"csp_timer time_outs[{len(timers)}]"))
    words = "NULL"
    if count > WORD // 2:
        fields.append(Member(f"csp_word words[2U * CSP_WORDS({count}U)]"))
        words = f"{SELF}{member}.words"
    writer.members.structs[member] = fields
    made = (
        f"csp_alternative_init(&{alternative}, {SELF}{member}.guards, {count}U, {words}, {_truth(choice.prioritized)});"
    )
    setup = rows(made)
    for number, guard in enumerate(guards):
        timer = f"{SELF}{member}.time_outs[{timers.index(guard)}]" if guard in timers else ""
        setup.append(Row(guard_call(writer, guard, f"&{alternative}", number, timer)))
        if isinstance(guard.event, AfterEvent) and is_known_at_start(guard.event.duration):
            duration = writer.members.initial_printer.print(guard.event.duration)
            setup.append(Row(f"csp_delay(&{alternative}, {number}U, {duration});"))
    conditional = any(branch.condition is not None for branch in choice.branches)
    if not conditional:
        setup.append(Row(f"csp_enable_all(&{alternative});"))
    writer.members.made_choices[choice.name] = setup

    opening = Row("", comment=writer.comment(choice))
    enabling = rows(f"csp_enable_none(&{alternative});") if conditional else []
    for number, guard in enumerate(guards):
        enabling += _enabled(writer, guard, f"&{alternative}", number, conditional=conditional)
    place = writer.place(choice, choice.name.replace("choice", "chooses"), "ALTERNATIVE", f"{member}.alternative")
    again = f"csp_select_again(party, &{alternative})"
    waited = writer.await_rows(choice, f"csp_select(party, &{alternative})", again, place)
    bodies = [[*taken_rows(writer, guard), *writer.rows(guard.branch.body)] for guard in guards]
    chosen = _chosen(writer, f"{alternative}.chosen", guards, bodies)
    return [opening, *enabling, Row(waited[0].text), *waited[1:], *chosen]


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
        case _:
            pass
    return guard


def _kept(writer: Writer, name: str, end: Spelling) -> str:
    member = writer.members.names.fresh(name)
    writer.members.work.append(Member(f"{writer.members.types.type_name(end.type)} {member}"))
    return SELF + member


def guard_call(writer: Writer, guard: Guard, alternative: str, number: int, timer: str) -> str:
    """The call that makes a guard; what never waits is a guard that is always ready."""
    event, members = guard.event, writer.members
    always = f"csp_guard_skip({alternative}, {number}U);"
    match event:
        case InputEvent(source=source, target=target):
            end = members.source(source)
            into = guard.kept or members.variable(target.channel)
            return (
                always
                if end.at_once
                else (f"csp_guard_read({alternative}, {number}U, {end.medium}, &{into}, sizeof({into}));")
            )
        case ReadyEvent(source=source):
            end = members.source(source)
            return always if end.at_once else f"csp_guard_ready({alternative}, {number}U, {end.medium});"
        case OutputEvent(sink=sink):
            end, value = members.sink(sink), guard.kept
            return (
                always
                if end.at_once
                else (f"csp_guard_write({alternative}, {number}U, {end.medium}, &{value}, sizeof({value}));")
            )
        case AfterEvent():
            return f"csp_guard_after({alternative}, {number}U, &{timer});"
        case SkipEvent():
            return always


def _enabled(writer: Writer, guard: Guard, alternative: str, number: int, *, conditional: bool) -> list[Row]:
    """What a selection does for a guard beforehand, where its condition holds."""
    prepared = prepare_rows(writer, guard, alternative, number)
    condition = guard.branch.condition
    if conditional:
        prepared.append(Row(f"csp_enable({alternative}, {number}U);"))
    if condition is None:
        return prepared
    setup, holds = writer.condition(condition, guard.branch)
    return [*setup, *block(f"if ({holds})", prepared)]


def prepare_rows(writer: Writer, guard: Guard, alternative: str, number: int, *, always: bool = False) -> list[Row]:
    """The value to be written, or the length of a time-out that varies (or ``always``)."""
    event = guard.event
    where = writer.where(event)
    match event:
        case OutputEvent(value=value):
            return writer.evaluated(f"{guard.kept} = ", value, ";", where)
        case AfterEvent(duration=duration) if always or not is_known_at_start(duration):
            setup, code = writer.operand(duration, where, "duration")
            return [*setup, Row(f"csp_delay({alternative}, {number}U, {code});")]
    return []


def taken_rows(writer: Writer, guard: Guard) -> list[Row]:
    """What the branch of a guard begins with: the communication of what never waits, and values into elements of arrays."""
    event, where = guard.event, writer.where(guard.event)
    comment = Row("", comment=writer.comment(event))
    match event:
        case InputEvent(source=source, target=target):
            end = writer.members.source(source)
            if end.at_once:
                return [comment, *take_rows(writer, target, end, where)]
            if guard.kept is not None:
                return [comment, *store_rows(writer, target, guard.kept, end.type, where)]
            return [comment, *writer.wrote(target.channel)]
        case OutputEvent(sink=sink):
            end, value = writer.members.sink(sink), guard.kept or ""
            if end.access == "variable":
                return [comment, *rows(f"{end.pointer} = {value};"), *flag_rows(end)]
            if end.access in ("latched", "direct"):
                written = f"(void){WRITES[end.access]}(party, {end.pointer}, &{value}, sizeof({value}));"
                return [comment, *finite_rows(writer, end, value, where), Row(written)]
    return [comment]


def _chosen(writer: Writer, chosen: str, guards: Sequence[Guard], bodies: Sequence[list[Row]]) -> list[Row]:
    """The branches: as a ``switch`` where they do not wait, else as an ``if`` or a jump."""
    if len(bodies) == 1:
        return bodies[0]
    if all(not row.text for body in bodies for row in body):
        return []
    waits = any(_has_labels(body) for body in bodies)
    if not waits:
        return _switch(chosen, guards, bodies)
    if len(bodies) > FEW:
        return _jumps(writer, chosen, guards, bodies)
    found: list[Row] = []
    for number, body in enumerate(bodies):
        last = number == len(bodies) - 1
        head = "else" if last else f"{'else ' if number else ''}if ({chosen} == {number}U)"
        opened = block(head, body)
        if found:
            found[-1:] = [Row(f"}} {opened[0].text}"), *opened[1:]]
        else:
            found = opened
    return found


def _has_labels(body: Sequence[Row]) -> bool:
    return any(
        "case " in row.text or row.text.startswith(("CSP_AWAIT", "CSP_COMM", "CSP_CALL", "CSP_TAKE")) for row in body
    )


def _switch(chosen: str, guards: Sequence[Guard], bodies: Sequence[list[Row]]) -> list[Row]:
    found = [Row(f"switch ({chosen}) {{")]
    for number, (guard, body) in enumerate(zip(guards, bodies, strict=True)):
        found.append(Row(f"case {number}:" if number < len(bodies) - 1 else "default:"))
        found += [Row(row.text, row.depth + 1, row.comment) for row in body]
        if ends(guard.branch.body):
            found.append(Row("break;", 1))
    return [*found, Row("}")]


def _jumps(writer: Writer, chosen: str, guards: Sequence[Guard], bodies: Sequence[list[Row]]) -> list[Row]:
    after = writer.states.fresh("chosen")
    labels = [writer.states.fresh(f"guard_{number}") for number in range(len(bodies))]
    found = [Row(f"switch ({chosen}) {{")]
    for number, label in enumerate(labels):
        found.append(Row(f"case {number}:" if number < len(labels) - 1 else "default:"))
        found.append(Row(f"goto {label};", 1))
    found.append(Row("}"))
    for guard, label, body in zip(guards, labels, bodies, strict=True):
        found += [Row(f"{label}:;", -1), *body]
        if ends(guard.branch.body):
            found.append(Row(f"goto {after};"))
    if any(ends(guard.branch.body) for guard in guards):
        found.append(Row(f"{after}:;", -1))
    return found


def _truth(value: bool) -> str:
    return "true" if value else "false"
