"""Reading, writing, assigning, waiting: the basic steps of a process."""

from __future__ import annotations

from math import isfinite

from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import EQUALITY, Code, Own, address, call, code, ignored, infix, member_of, own
from cspdiag.codegen.c.text.media import EndInC
from cspdiag.codegen.c.text.numbered import mentions_number
from cspdiag.codegen.c.text.rolling import countable
from cspdiag.codegen.c.text.statements import (
    Block,
    If,
    Plain,
    Statement,
    choose,
    define,
    goto,
    goto_if,
    return_value,
    run,
    store,
)
from cspdiag.model.types import INT, ArrayType, Type
from cspdiag.network.ir.actions import ReadValue, Step, StopStep, Target, WaitStep, WriteValue
from cspdiag.network.ir.expressions import Expression, LiteralValue, VariableValue
from cspdiag.network.ir.faults import is_index_of

_LARGE = 1 << 31
"""From here on a number needs a suffix in C."""

READS = {
    "channel": "csp_channel_read", "guarded": "csp_guarded_read", "any": "csp_any_read",
    "broadcast": "csp_broadcast_read",
    "buffer": "csp_buffer_read",
    "sampled": "csp_sampled_read", "event": "csp_event_read",
}  # fmt: skip
"""The function that reads from an end; none for ends where reading never waits."""

WRITES = {
    "channel": "csp_channel_write", "guarded": "csp_guarded_write", "any": "csp_any_write",
    "broadcast": "csp_broadcast_write",
    "buffer": "csp_buffer_write",
    "latched": "csp_latched_write", "direct": "csp_direct_write",
}  # fmt: skip


def read_value(writer: Writer, step: ReadValue) -> list[Statement]:
    """A communication that reads into a variable."""
    source, target = writer.members.source(step.source), step.target
    if source.never_waits:
        return [writer.remark(step), *read_variable(writer, target, source, writer.where(step))]
    if not target.indexes:
        variable = writer.members.variable(target.channel)
        return [writer.remark(step), *receive(writer, step, source, variable), *writer.mark_written(target.channel)]
    received = writer.slot(source.name, source.type, "received")
    stored = store_value(writer, target, received, source.type, writer.where(step))
    return [writer.remark(step), *receive(writer, step, source, received), *stored]


def receive(writer: Writer, step: Step, source: EndInC, into: Code) -> list[Statement]:
    """Waits for a value and stores it in an lvalue that exists during the wait."""
    chosen, member, indirect = _awaited(writer, source)
    place = writer.place(step, f"reads_{source.name}", "READ", member, indirect=indirect)
    operation = READS[source.access]
    if source.access in ("sampled", "event"):
        again = _operation(f"{operation}_again", source, into)
        return [*chosen, writer.wait(_operation(operation, source, into), again, place)]
    waits = writer.wait(_operation(operation, source, into), code("CSP_DONE"), place)
    return [*chosen, check_cancelled(writer), waits]


def _awaited(writer: Writer, end: EndInC) -> tuple[list[Statement], Code, bool]:
    """The statements before a wait at an end, the member for the table of places, and whether that is a pointer.

    An element that the turn of a loop chooses has no place of its own in the struct, so a pointer to it is kept.
    """
    if not (writer.in_turns and mentions_number(end.member)):
        return [], end.member, end.indirect
    pointer = writer.shared_member("awaited", "const void *")
    return [store(own(pointer), end.pointer)], pointer, True


def _operation(function: str, end: EndInC, value: Code) -> Code:
    """A communication of the process with the value of an lvalue."""
    return call(function, "party", end.pointer, address(value), size_of(value))


def write_value(writer: Writer, step: WriteValue) -> list[Statement]:
    """A communication that writes a value."""
    sink, value, where = writer.members.sink(step.sink), step.value, writer.where(step)
    if sink.access == "variable":
        return [writer.remark(step), *writer.assign(sink.pointer, value, where), *mark_written(sink)]
    if sink.access == "discard":
        return discard(writer, value, where)
    own_variable = isinstance(value, VariableValue) and writer.members.is_own(value.channel)
    if writer.alone and own_variable and isinstance(value, VariableValue) and not writer.may_fault(value):
        return [writer.remark(step), *send(writer, step, sink, writer.members.variable(value.channel))]
    slot = writer.slot(sink.name, sink.type)
    computed = writer.evaluate_into(slot, value, where)
    return [writer.remark(step), *computed, *send(writer, step, sink, slot, finite=_is_finite(value))]


def _is_finite(value: Expression) -> bool:
    return isinstance(value, LiteralValue) and isinstance(value.value, int | float) and isfinite(value.value)


def discard(writer: Writer, value: Expression, where: str) -> list[Statement]:
    """Evaluates a value that is not used, because it may fault."""
    if not writer.may_fault(value):
        return []
    return writer.evaluate_into(writer.slot("unused", value.type), value, where)


def check_cancelled(writer: Writer) -> If:
    """The check whether the process was cancelled, for communications that never wait."""
    return goto_if(call("csp_refused", "party"), writer.failure_label())


def send(writer: Writer, step: Step, sink: EndInC, value: Code, *, finite: bool = False) -> list[Statement]:
    """Writes the value of an lvalue that exists during the wait; ``finite`` if it cannot be NaN or infinite."""
    if sink.never_waits:
        checked = [] if finite else check_finite(writer, sink, value, writer.where(step))
        return [check_cancelled(writer), *checked, hand_over(sink, value)]
    chosen, member, indirect = _awaited(writer, sink)
    place = writer.place(step, f"writes_{sink.name}", "WRITE", member, indirect=indirect)
    operation = _operation(WRITES[sink.access], sink, value)
    return [*chosen, check_cancelled(writer), writer.wait(operation, code("CSP_DONE"), place)]


def hand_over(sink: EndInC, value: Code) -> Plain:
    """Writes to an output of the program."""
    return run(ignored(_operation(WRITES[sink.access], sink, value)))


def size_of(value: Code) -> Code:
    """The size of an object in bytes."""
    return call("sizeof", value)


def check_finite(writer: Writer, sink: EndInC, value: Code, where: str) -> list[Statement]:
    """The check that a value for an output of the program is neither NaN nor infinite."""
    check = writer.members.types.finite_check(sink.type, value, sink.pointer.arrow("name"))
    return [] if check is None else [run(check), writer.raise_noted_fault(where)]


def assign_value(writer: Writer, target: Target, value: Expression, where: str) -> list[Statement]:
    """Assigns to a variable, or to an element of it after the value has been evaluated."""
    variable = writer.members.variable(target.channel)
    number = _counting(value)
    if number is not None and _element(writer.members.channels[target.channel].type) == INT:
        return store_value(writer, target, countable(number), value.type, where)
    if not target.indexes:
        return [*writer.assign(variable, value, where), *writer.mark_written(target.channel)]
    computed, known = writer.operand(value, where, target.channel)
    return [*computed, *store_value(writer, target, known, value.type, where)]


def _counting(value: Expression) -> int | None:
    """A number that may be different in each turn of a loop in C; None for other values."""
    match value:
        case LiteralValue(type=type_, value=int(number), name=None) if type_ == INT and 0 <= number < _LARGE:
            return number
        case _:  # Every other expression.
            return None


def _element(kind: Type) -> Type:
    return _element(kind.element) if isinstance(kind, ArrayType) else kind


def read_variable(writer: Writer, target: Target, source: EndInC, where: str) -> list[Statement]:
    """Reads from an end where a value is always available."""
    return [*check_written(writer, source, where), *store_value(writer, target, source.pointer, source.type, where)]


def check_written(writer: Writer, source: EndInC, where: str) -> list[Statement]:
    """The check that a variable was written, unless it always is before it is read."""
    if source.written is None:
        return []
    return [run(call("csp_require_written", source.written)), writer.raise_noted_fault(where)]


def mark_written(sink: EndInC) -> list[Statement]:
    """The statements after a write to a variable: they set its flag, if it has one."""
    if sink.written is None:
        return []
    done = store(member_of(sink.written, "done"), "true")
    if isinstance(sink.written, Own):  # a pointer in a port, NULL if the variable has no flag
        return choose(infix("!=", EQUALITY, sink.written, code("NULL")), [done])
    return [done]


def store_value(writer: Writer, target: Target, value: Code, type_: Type, where: str) -> list[Statement]:
    """Stores a known value in a variable or an element of it; an index out of range changes nothing."""
    lvalue = writer.members.variable(target.channel)
    if not target.indexes:
        return [store(lvalue, value), *writer.mark_written(target.channel)]
    setup: list[Statement] = []
    flag = writer.members.written(target.channel)
    if flag is not None:
        setup += [run(call("csp_require_written", address(flag))), writer.raise_noted_fault(where)]
    kind: Type = writer.members.channels[target.channel].type
    for number, index in enumerate(target.indexes, 1):
        assert isinstance(kind, ArrayType)
        lvalue = lvalue.field("at")
        if isinstance(index, LiteralValue) and isinstance(index.value, int) and is_index_of(index, kind):
            lvalue, kind = lvalue.at(index.value), kind.element
            continue
        name = "index" if len(target.indexes) == 1 else f"index_{number}"
        computed, statements = writer.operand(index, where, name, "place")  # not in the slot of the value
        setup += computed
        if is_index_of(index, kind):
            lvalue = lvalue.at(statements)
        else:
            setup += [
                define("const size_t", name, call("csp_index", statements, str(kind.size))),
                writer.raise_noted_fault(where),
            ]
            lvalue = lvalue.at(code(name))
        kind = kind.element
    return [Block((*setup, store(lvalue, value)))] if setup else [store(lvalue, value)]


def wait(writer: Writer, step: WaitStep) -> list[Statement]:
    """A delay."""
    delay = writer.shared_member("delay", "csp_timer")
    place = writer.place(step, "waits", "DELAY", delay)
    first, duration = writer.operand(step.duration, writer.where(step), "duration")
    begun = call("csp_wait", "party", address(own(delay)), duration)
    return [writer.remark(step), *first, writer.wait(begun, code("csp_wait_again(party)"), place)]


def stop(writer: Writer, step: StopStep) -> list[Statement]:
    """Waits until the process is cancelled."""
    place = writer.place(step, "stops", "STOP")
    fails = infix("==", EQUALITY, call("csp_stop", "party"), code("CSP_FAILS"))
    refused = choose(fails, [goto(writer.failure_label())])
    return [writer.remark(step), *refused, store("party->state", place), return_value("NULL")]
