"""Control laws in processes: inputs offered all at once, one run, outputs offered all at once."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.inlined_laws import reset_states, run_law, run_law_signals
from cspdiag.codegen.c.laws.laws import law_may_fault, law_members
from cspdiag.codegen.c.process.members import SELF
from cspdiag.codegen.c.process.plain_steps import (
    READS,
    WRITES,
    finite_check,
    finite_rows,
    flag_rows,
    receive_rows,
    send_rows,
)
from cspdiag.codegen.c.process.routines import Waiting
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.rows import Row, block, rows
from cspdiag.network.ir.actions import (
    ReadInputs,
    ResetInstance,
    ResetStates,
    RunInstance,
    RunLaw,
    SkipStep,
    Step,
    WriteOutputs,
)
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expressions import SignalValue
from cspdiag.network.ir.network import Connection, ConstantEnd, DiscardEnd, SubmodelClass

EXTERNAL = ("latched", "direct")


@record
class _Read:
    source: Spelling | None
    """None where ``constant`` is read."""
    into: str
    constant: str = ""


@record
class _Write:
    sink: Spelling
    value: str
    """An lvalue that outlives the wait."""


# ---- Submodels that are classes of their own


def law_rows(writer: Writer, step: RunInstance, class_: SubmodelClass) -> list[Row]:
    """One run of a submodel."""
    instance = writer.members.instances[step.instance]
    member = f"{SELF}{writer.members.member(step.instance)}"
    names = law_members(class_, writer.names)
    struct = writer.names.classes[class_.name]
    reads = [_law_read(writer, c, f"{member}.{names[_port(c)]}") for c in _attached(class_, instance.connections, "in")]
    writes: list[_Write] = []
    for connection in _attached(class_, instance.connections, "out"):
        end = connection.attachment
        if not isinstance(end, ConstantEnd | DiscardEnd):
            writes.append(_Write(writer.members.sink(end), f"{member}.{names[_port(connection)]}"))
    outer, writer.inner = writer.inner, step.instance
    law = SkipStep(span=class_.span)  # where -O0 says that a law reads and writes
    found = _reading(writer, law, step.instance, reads)
    if law_may_fault(class_):
        called = f"(void){struct}_calculate(&{member});"
        found += [Row(called), writer.fault(writer.where(law))]
    else:
        found.append(Row(f"{struct}_calculate(&{member});"))
    found += _writing(writer, law, step.instance, writes)
    writer.inner = outer
    return [Row("", comment=writer.comment(step)), *(Row(row.text, row.depth) for row in found)]


def _attached(class_: SubmodelClass, connections: Sequence[Connection], direction: str) -> Iterator[Connection]:
    """The connections of the inputs or outputs in the order of the ports."""
    for port in class_.ports:
        if port.direction == direction:
            yield from (c for c in connections if port.name in (c.port, _port(c)))


def _port(connection: Connection) -> str:
    return connection.port if connection.index is None else f"{connection.port}[{connection.index}]"


def _law_read(writer: Writer, connection: Connection, into: str) -> _Read:
    end = connection.attachment
    if isinstance(end, ConstantEnd):
        return _Read(None, into, str(writer.printer.print(end.value)))
    assert not isinstance(end, DiscardEnd)
    return _Read(writer.members.source(end), into)


def reset_rows(writer: Writer, step: ResetInstance) -> list[Row]:
    """Puts the states of a submodel back."""
    struct = writer.names.classes[writer.class_of(step.instance).name]
    call = f"{struct}_reset(&{SELF}{writer.members.member(step.instance)});"
    return [Row(call, comment=writer.comment(step))]


# ---- Control laws that were inlined


def read_inputs_rows(writer: Writer, step: ReadInputs) -> list[Row]:
    """The inputs of an inlined law; they are members, because reading waits."""
    reads = [_Read(writer.members.source(read.source), writer.printer.signal(read.name)) for read in step.reads]
    return _reading(writer, step, "inputs", reads)


def write_outputs_rows(writer: Writer, step: WriteOutputs) -> list[Row]:
    """The outputs of an inlined law: all values first, for they may fault, then the communications."""
    found: list[Row] = []
    writes: list[_Write] = []
    for number, write in enumerate(step.writes, 1):
        sink = writer.members.sink(write.sink)
        if isinstance(write.value, SignalValue):
            writes.append(_Write(sink, writer.printer.signal(write.value.name)))
            continue
        slot = writer.slot(sink.name, sink.type, "sent" if number == 1 else f"sent_{number}")
        found += writer.evaluated(f"{slot} = ", write.value, ";", writer.where(step))
        writes.append(_Write(sink, slot))
    return [*found, *_writing(writer, step, "outputs", writes)]


def run_law_rows(writer: Writer, step: RunLaw) -> list[Row]:
    """One run of an inlined law; what only it needs are local variables of a block."""
    members = writer.members

    def place(item: Declared) -> str:
        return writer.names.place(item.span.file, item.span.line)

    def check(where: str) -> list[str]:
        return [f"CSP_FAULT_INSIDE({quoted(step.law)}, {quoted(where)}, {writer.failing()});"]

    law = run_law(
        step,
        members.process,
        owner=writer.struct,
        printer=writer.printer,
        place=place,
        check=check,
        types_of=members.signal_types,
    )
    writer.add_function(law.functions)
    local = [(name, type_) for name, type_ in run_law_signals(step) if name in members.local_signals]
    declared = [Row(f"{members.types.type_name(type_)} {members.local_signals[name]};") for name, type_ in local]
    words = Counter(word for line in law.lines for word in re.findall(r"\w+", line))
    spelled = [members.local_signals[name] for name, _ in local]
    unread = [Row(f"(void){name};") for name in spelled if words[name] == 1]
    body = [*declared, *(_row(line) for line in law.lines), *unread]
    told = f"{step.law}: {' '.join(step.doc.split())}" if step.doc else step.law
    opening = Row("", comment=f"{told} ({writer.where(step)})")
    return [opening, *(block("", body) if declared or any("csp_operand" in line for line in law.lines) else body)]


def _row(line: str) -> Row:
    text = line.lstrip(" ")
    return Row(text, (len(line) - len(text)) // 4)


def reset_states_rows(writer: Writer, step: ResetStates) -> list[Row]:
    """Puts states of the class back."""
    lines = reset_states(step.states, writer.members.process, writer.printer)
    return [Row("", comment=writer.comment(step)), *map(_row, lines)]


# ---- Several communications at once


def _reading(writer: Writer, step: Step, name: str, reads: Sequence[_Read]) -> list[Row]:
    """Reads all; with no more than one that can wait, that is a plain communication."""
    waiting = [read for read in reads if read.source is not None and not read.source.at_once]
    at_once = [row for read in reads if read not in waiting for row in _had(writer, step, read)]
    if not waiting:
        return [Row(f"CSP_CHECK({writer.failing()})", comment=writer.comment(step)), *at_once]
    if len(waiting) == 1:
        source = waiting[0].source
        assert source is not None
        return [*at_once, *receive_rows(writer, step, source, waiting[0].into)]
    offers = _Offers(writer, step, len(waiting), "INPUTS", f"reads_{name}")
    found = offers.begin()
    for read in reads:
        if read in waiting and read.source is not None:
            found += offers.offer(READS[read.source.access], read.source, read.into)
        else:
            found += _had(writer, step, read, offers)
    return [*found, *offers.wait()]


def _had(writer: Writer, step: Step, read: _Read, offers: _Offers | None = None) -> list[Row]:
    """What never waits; a variable may turn out not to have been written."""
    taken = Row(f"{read.into} = {read.constant if read.source is None else read.source.pointer};")
    if read.source is None or read.source.written is None:
        return [taken]
    fault = writer.fault(writer.where(step))
    if offers is None:
        return [taken, fault]
    given_up = Row(f"csp_offers_give_up(&{SELF}{offers.member});")
    return [taken, *block("if (csp_faulted())", [given_up, fault])]


def _writing(writer: Writer, step: Step, name: str, writes: Sequence[_Write]) -> list[Row]:
    """Writes all; see ``_reading``. An output of the program that is written after another communication was begun needs an offer too."""
    waiting = [write for write in writes if not write.sink.at_once]
    first = writes.index(waiting[0]) if waiting else len(writes)
    late = any(write.sink.access in EXTERNAL for write in writes[first:])
    if len(waiting) <= 1 and not late:
        found: list[Row] = []
        if not waiting:
            found.append(Row(f"CSP_CHECK({writer.failing()})", comment=writer.comment(step)))
        elif any(write.sink.access in EXTERNAL for write in writes):
            found.append(Row(f"CSP_CHECK({writer.failing()})"))
        for write in writes:
            if write not in waiting:
                found += _at_once(writer, step, write)
        return [*found, *(send_rows(writer, step, waiting[0].sink, waiting[0].value) if waiting else [])]
    offers = _Offers(writer, step, len(waiting), "OUTPUTS", f"writes_{name}")
    found = offers.begin()
    for write in writes:
        if write in waiting:
            found += offers.offer(WRITES[write.sink.access], write.sink, write.value)
        else:
            found += _at_once(writer, step, write, offers)
    return [*found, *offers.wait()]


def _at_once(writer: Writer, step: Step, write: _Write, offers: _Offers | None = None) -> list[Row]:
    sink, value = write.sink, write.value
    if sink.access == "discard":
        return []
    if sink.access == "variable":
        return [*rows(f"{sink.pointer} = {value};"), *flag_rows(sink)]
    checked = finite_rows(writer, sink, value, writer.where(step))
    if offers is not None and checked:
        check = finite_check(writer, sink.type, value, f"{sink.pointer}->name")
        given_up = rows(f"csp_offers_give_up(&{SELF}{offers.member});")
        fault = writer.fault(writer.where(step))
        checked = [*rows(f"{check};"), *block("if (csp_faulted())", [*given_up, fault])]
    return [*checked, Row(f"(void){WRITES[sink.access]}(party, {sink.pointer}, &{value}, sizeof({value}));")]


class _Offers:
    """The offers of one step function, which are made one law after the other."""

    def __init__(self, writer: Writer, step: Step, count: int, waiting: Waiting, state: str) -> None:
        self.writer = writer
        self.step = step
        self.member = writer.offers(count)
        self.place = writer.place(step, state, waiting, self.member)

    def begin(self) -> list[Row]:
        """Cancelled processes go no further."""
        begun = f"if (csp_offers_begin(party, &{SELF}{self.member}) == CSP_FAILS)"
        first, *rest = block(begun, rows(f"goto {self.writer.failing()};"))
        return [Row(first.text, first.depth, self.writer.comment(self.step)), *rest]

    def offer(self, operation: str, end: Spelling, value: str) -> list[Row]:
        """One communication begins."""
        given = f"&{SELF}{self.member}, {operation}, {end.pointer}, {value}, {self.place}, {self.writer.failing()}"
        return rows(f"CSP_OFFER({given})")

    def wait(self) -> list[Row]:
        """Until all are done."""
        again = f"csp_offers_again(party, &{SELF}{self.member})"
        waited = self.writer.await_rows(self.step, f"csp_offers_wait(&{SELF}{self.member})", again, self.place)
        return [Row(waited[0].text), *waited[1:]]
