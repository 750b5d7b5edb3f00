"""Reading, writing, assigning, waiting: the steps that a process does by itself."""

from __future__ import annotations

from math import isfinite

from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import EQUALITY, Code, Own, address, call, code, ignored, infix, member_of, own
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.statements import Block, Plain, Statement, Wait, choose, define, give, go, run, store
from cspdiag.model.types import ArrayType, Type
from cspdiag.network.ir.actions import ReadValue, Step, StopStep, Target, WaitStep, WriteValue
from cspdiag.network.ir.expressions import Expression, LiteralValue, VariableValue
from cspdiag.network.ir.faults import is_index_of

READS = {
    "channel": "csp_channel_read", "any": "csp_any_read", "broadcast": "csp_broadcast_read",
    "buffer": "csp_buffer_read",
    "sampled": "csp_sampled_read", "event": "csp_event_read",
}  # fmt: skip
"""The function that reads an end; ends that are read at once have none."""

WRITES = {
    "channel": "csp_channel_write", "any": "csp_any_write", "broadcast": "csp_broadcast_write",
    "buffer": "csp_buffer_write",
    "latched": "csp_latched_write", "direct": "csp_direct_write",
}  # fmt: skip


def read_value(writer: Writer, step: ReadValue) -> list[Statement]:
    """A communication that reads into a variable."""
    source, target = writer.members.source(step.source), step.target
    if source.at_once:
        return [writer.remark(step), *take(writer, target, source, writer.where(step))]
    if not target.indexes:
        variable = writer.members.variable(target.channel)
        return [writer.remark(step), receive(writer, step, source, variable), *writer.wrote(target.channel)]
    received = writer.slot(source.name, source.type, "received")
    stored = put(writer, target, received, source.type, writer.where(step))
    return [writer.remark(step), receive(writer, step, source, received), *stored]


def receive(writer: Writer, step: Step, source: Spelling, into: Code) -> Wait:
    """Waits for a value and puts it into an lvalue that outlives the wait."""
    place = writer.place(step, f"reads_{source.name}", "READ", source.member, indirect=source.indirect)
    operation = READS[source.access]
    waits_outside = source.access in ("sampled", "event")
    writer.current.progress |= waits_outside
    macro = "CSP_TAKE" if waits_outside else "CSP_COMMUNICATE"
    return Wait(call(macro, operation, source.pointer, into, place, writer.failing()))


def write_value(writer: Writer, step: WriteValue) -> list[Statement]:
    """A communication that writes a value."""
    sink, value, where = writer.members.sink(step.sink), step.value, writer.where(step)
    if sink.access == "variable":
        return [writer.remark(step), *writer.stored(sink.pointer, value, where), *mark_written(sink)]
    if sink.access == "discard":
        return discard(writer, value, where)
    own_variable = isinstance(value, VariableValue) and writer.members.is_own(value.channel)
    if writer.alone and own_variable and isinstance(value, VariableValue) and not writer.may_fault(value):
        return [writer.remark(step), *send(writer, step, sink, writer.members.variable(value.channel))]
    slot = writer.slot(sink.name, sink.type)
    computed = writer.evaluated(slot, value, where)
    return [writer.remark(step), *computed, *send(writer, step, sink, slot, finite=_is_finite(value))]


def _is_finite(value: Expression) -> bool:
    return isinstance(value, LiteralValue) and isinstance(value.value, int | float) and isfinite(value.value)


def discard(writer: Writer, value: Expression, where: str) -> list[Statement]:
    """A value that nobody takes: it can only fault."""
    if not writer.may_fault(value):
        return []
    return writer.evaluated(writer.slot("unused", value.type), value, where)


def check(writer: Writer) -> Plain:
    """Cancelled processes go no further, also where a communication never waits."""
    return run(call("CSP_CHECK", writer.failing()), "")


def send(writer: Writer, step: Step, sink: Spelling, value: Code, *, finite: bool = False) -> list[Statement]:
    """Writes what is in an lvalue that outlives the wait; ``finite``: what is surely no NaN and no infinity."""
    if sink.at_once:
        checked = [] if finite else finite_checked(writer, sink, value, writer.where(step))
        return [check(writer), *checked, hand_over(sink, value)]
    place = writer.place(step, f"writes_{sink.name}", "WRITE", sink.member, indirect=sink.indirect)
    return [Wait(call("CSP_COMMUNICATE", WRITES[sink.access], sink.pointer, value, place, writer.failing()))]


def hand_over(sink: Spelling, value: Code) -> Plain:
    """Writes to an output of the program."""
    return run(ignored(call(WRITES[sink.access], "party", sink.pointer, address(value), size_of(value))))


def size_of(value: Code) -> Code:
    """The bytes of an object."""
    return call("sizeof", value)


def finite_checked(writer: Writer, sink: Spelling, value: Code, where: str) -> list[Plain]:
    """Refuses a NaN or an infinity for an output of the program."""
    looked = writer.members.types.finite_check(sink.type, value, sink.pointer.arrow("name"))
    return [] if looked is None else [run(looked), writer.fault(where)]


def assign_value(writer: Writer, target: Target, value: Expression, where: str) -> list[Statement]:
    """Sets a variable, or an element of it once the value is known."""
    variable = writer.members.variable(target.channel)
    if not target.indexes:
        return [*writer.stored(variable, value, where), *writer.wrote(target.channel)]
    computed, known = writer.operand(value, where, target.channel)
    return [*computed, *put(writer, target, known, value.type, where)]


def take(writer: Writer, target: Target, source: Spelling, where: str) -> list[Statement]:
    """Reads a value that is available at once."""
    return [*required(writer, source, where), *put(writer, target, source.pointer, source.type, where)]


def required(writer: Writer, source: Spelling, where: str) -> list[Plain]:
    """Looks whether a variable was written, where that is not sure."""
    if source.written is None:
        return []
    return [run(call("csp_require_written", source.written)), writer.fault(where)]


def mark_written(sink: Spelling) -> list[Statement]:
    """Behind a write to a variable."""
    if sink.written is None:
        return []
    done = store(member_of(sink.written, "done"), "true")
    if isinstance(sink.written, Own):  # a pointer in a port, NULL where the variable surely was written
        return choose(infix("!=", EQUALITY, sink.written, code("NULL")), [done])
    return [done]


def put(writer: Writer, target: Target, value: Code, type_: Type, where: str) -> list[Statement]:
    """Puts a value that is known into a variable or an element of it; an index out of range changes nothing."""
    lvalue = writer.members.variable(target.channel)
    if not target.indexes:
        return [store(lvalue, value), *writer.wrote(target.channel)]
    setup: list[Statement] = []
    flag = writer.members.written(target.channel)
    if flag is not None:
        setup += [run(call("csp_require_written", address(flag))), writer.fault(where)]
    kind: Type = writer.members.channels[target.channel].type
    for number, index in enumerate(target.indexes, 1):
        assert isinstance(kind, ArrayType)
        lvalue = lvalue.field("at")
        if isinstance(index, LiteralValue) and isinstance(index.value, int) and is_index_of(index, kind):
            lvalue, kind = lvalue.at(index.value), kind.element
            continue
        name = "index" if len(target.indexes) == 1 else f"index_{number}"
        computed, found = writer.operand(index, where, name, "place")  # beside the value, which is there already
        setup += computed
        if is_index_of(index, kind):
            lvalue = lvalue.at(found)
        else:
            setup += [define("const size_t", name, call("csp_index", found, str(kind.size))), writer.fault(where)]
            lvalue = lvalue.at(code(name))
        kind = kind.element
    return [Block((*setup, store(lvalue, value)))] if setup else [store(lvalue, value)]


def wait(writer: Writer, step: WaitStep) -> list[Statement]:
    """A delay."""
    delay = writer.single("delay", "csp_timer")
    place = writer.place(step, "waits", "DELAY", delay)
    first, duration = writer.operand(step.duration, writer.where(step), "duration")
    begun = call("csp_wait", "party", address(own(delay)), duration)
    return [writer.remark(step), *first, writer.wait(begun, code("csp_wait_again(party)"), place)]


def stop(writer: Writer, step: StopStep) -> list[Statement]:
    """Waits for nothing but cancellation."""
    place = writer.place(step, "stops", "STOP")
    fails = infix("==", EQUALITY, code("csp_stop(party)"), code("CSP_FAILS"))
    refused = choose(fails, [go(writer.failing())])
    return [writer.remark(step), *refused, store("party->state", place), give("NULL")]
