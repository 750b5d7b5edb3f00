"""Reading, writing, assigning, waiting: the steps that a process does by itself."""

from __future__ import annotations

from cspdiag.codegen.c.process.members import SELF
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.rows import Row, block, rows
from cspdiag.model.types import ArrayType, RealType, Type
from cspdiag.network.ir.actions import ReadValue, Step, StopStep, Target, WaitStep, WriteValue
from cspdiag.network.ir.expressions import Expression, LiteralValue, VariableValue

READS = {
    "channel": "csp_channel_read", "any": "csp_any_read", "broadcast": "csp_broadcast_read", "buffer": "csp_buffer_read",
    "sampled": "csp_sampled_read", "event": "csp_event_read",
}  # fmt: skip
"""What reads an end; not for those that are had at once."""

WRITES = {
    "channel": "csp_channel_write", "any": "csp_any_write", "broadcast": "csp_broadcast_write", "buffer": "csp_buffer_write",
    "latched": "csp_latched_write", "direct": "csp_direct_write",
}  # fmt: skip


def read_rows(writer: Writer, step: ReadValue) -> list[Row]:
    """A communication that reads into a variable."""
    source, target = writer.members.source(step.source), step.target
    if source.at_once:
        stored = take_rows(writer, target, source, writer.where(step))
        return [Row("", comment=writer.comment(step)), *stored]
    if not target.indexes:
        variable = writer.members.variable(target.channel)
        return [*receive_rows(writer, step, source, variable), *writer.wrote(target.channel)]
    received = writer.slot(source.name, source.type, "received")
    stored = store_rows(writer, target, received, source.type, writer.where(step))
    return [*receive_rows(writer, step, source, received), *stored]


def receive_rows(writer: Writer, step: Step, source: Spelling, into: str) -> list[Row]:
    """Waits for a value and puts it into an lvalue that outlives the wait."""
    place = writer.place(step, f"reads_{source.name}", "READ", source.member, indirect=source.indirect)
    operation = READS[source.access]
    waits_outside = source.access in ("sampled", "event")
    writer.current.progress |= waits_outside
    macro = "CSP_TAKE" if waits_outside else "CSP_COMMUNICATE"
    text = f"{macro}({operation}, {source.pointer}, {into}, {place}, {writer.failing()})"
    return [Row(text, comment=writer.comment(step))]


def write_rows(writer: Writer, step: WriteValue) -> list[Row]:
    """A communication that writes a value."""
    sink, value, where = writer.members.sink(step.sink), step.value, writer.where(step)
    if sink.access == "variable":
        stored = writer.stored(sink.pointer, value, where)
        return [Row("", comment=writer.comment(step)), *stored, *flag_rows(sink)]
    if sink.access == "discard":
        return discard_rows(writer, value, where)
    own = isinstance(value, VariableValue) and writer.members.is_own(value.channel) and writer.members.is_sure(value)
    if writer.alone and own and isinstance(value, VariableValue):
        return send_rows(writer, step, sink, writer.members.variable(value.channel))
    slot = writer.slot(sink.name, sink.type)
    computed = writer.evaluated(f"{slot} = ", value, ";", where)
    sent = send_rows(writer, step, sink, slot)
    return [Row("", comment=sent[0].comment), *computed, Row(sent[0].text), *sent[1:]]


def discard_rows(writer: Writer, value: Expression, where: str) -> list[Row]:
    """A value that nobody takes: it can only fault."""
    if not writer.may_fault(value):
        return []
    slot = writer.slot("unused", value.type)
    return writer.evaluated(f"{slot} = ", value, ";", where)


def send_rows(writer: Writer, step: Step, sink: Spelling, value: str) -> list[Row]:
    """Writes what is in an lvalue that outlives the wait."""
    operation = WRITES[sink.access]
    if sink.at_once:
        checked = finite_rows(writer, sink, value, writer.where(step))
        written = f"(void){operation}(party, {sink.pointer}, &{value}, sizeof({value}));"
        return [Row(f"CSP_CHECK({writer.failing()})", comment=writer.comment(step)), *checked, Row(written)]
    place = writer.place(step, f"writes_{sink.name}", "WRITE", sink.member, indirect=sink.indirect)
    text = f"CSP_COMMUNICATE({operation}, {sink.pointer}, {value}, {place}, {writer.failing()})"
    return [Row(text, comment=writer.comment(step))]


def finite_rows(writer: Writer, sink: Spelling, value: str, where: str) -> list[Row]:
    """Refuses a NaN or an infinity for an output of the program."""
    check = finite_check(writer, sink.type, value, f"{sink.pointer}->name")
    return [] if check is None else [Row(f"{check};"), writer.fault(where)]


def finite_check(writer: Writer, type_: Type, value: str, name: str) -> str | None:
    """A call that notes a fault if a part of the value is no number."""
    types = writer.members.types
    if not types.has_reals(type_):
        return None
    if isinstance(type_, RealType):
        return f"csp_finite({'(double)' if type_.bits == 32 else ''}{value}, {name})"
    return f"{types.suffix(type_)}_finite({value}, {name})"


def assign_rows(writer: Writer, target: Target, value: Expression, where: str) -> list[Row]:
    """Sets a variable, or an element of it once the value is known."""
    variable = writer.members.variable(target.channel)
    if not target.indexes:
        return [*writer.stored(variable, value, where), *writer.wrote(target.channel)]
    computed, code = writer.operand(value, where, target.channel)
    return [*computed, *store_rows(writer, target, code, value.type, where)]


def take_rows(writer: Writer, target: Target, source: Spelling, where: str) -> list[Row]:
    """Reads what is had at once."""
    stored = store_rows(writer, target, source.pointer, source.type, where)
    return stored if source.written is None else [*stored[:1], writer.fault(where), *stored[1:]]


def flag_rows(sink: Spelling) -> list[Row]:
    """Behind a write to a variable."""
    if sink.written is None:
        return []
    if sink.written.startswith("&"):
        return rows(f"{sink.written[1:]}.done = true;")
    return block(f"if ({sink.written} != NULL)", rows(f"{sink.written}->done = true;"))


def store_rows(writer: Writer, target: Target, value: str, type_: Type, where: str) -> list[Row]:
    """Puts a value that is known into a variable or an element of it; an index out of range changes nothing."""
    lvalue = writer.members.variable(target.channel)
    if not target.indexes:
        return [*rows(f"{lvalue} = {value};"), *writer.wrote(target.channel)]
    setup: list[Row] = []
    flag = writer.members.written(target.channel)
    if flag is not None:
        setup += [Row(f"csp_require_written(&{SELF}{flag});"), writer.fault(where)]
    kind: Type = writer.members.channels[target.channel].type
    for number, index in enumerate(target.indexes, 1):
        assert isinstance(kind, ArrayType)
        if isinstance(index, LiteralValue) and isinstance(index.value, int) and 0 <= index.value < (kind.size or 0):
            lvalue += f".at[{index.value}]"
        else:
            name = "index" if len(target.indexes) == 1 else f"index_{number}"
            computed, code = writer.operand(index, where, name, "place")  # beside the value, which is there already
            setup += [*computed, Row(f"const size_t {name} = csp_index({code}, {kind.size});")]
            setup.append(writer.fault(where))
            lvalue += f".at[{name}]"
        kind = kind.element
    stored = rows(f"{lvalue} = {value};")
    return block("", [*setup, *stored]) if setup else stored


def wait_rows(writer: Writer, step: WaitStep) -> list[Row]:
    """A delay."""
    delay = writer.single("delay", "csp_timer")
    place = writer.place(step, "waits", "DELAY", delay)
    first, duration = writer.operand(step.duration, writer.where(step), "duration")
    again = "csp_wait_again(party)"
    return [*first, *writer.await_rows(step, f"csp_wait(party, &{SELF}{delay}, {duration})", again, place)]


def stop_rows(writer: Writer, step: StopStep) -> list[Row]:
    """Waits for nothing but cancellation."""
    place = writer.place(step, "stops", "STOP")
    refused = block("if (csp_stop(party) == CSP_FAILS)", rows(f"goto {writer.failing()};"))
    return [Row("", comment=writer.comment(step)), *refused, *rows(f"party->state = {place};", "return NULL;")]
