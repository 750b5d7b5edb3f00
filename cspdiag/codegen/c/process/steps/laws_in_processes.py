"""Control laws in processes: inputs offered all at once, one run, outputs offered all at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.equations import Check
from cspdiag.codegen.c.laws.inlined_laws import reset_states, run_law, run_law_signals
from cspdiag.codegen.c.laws.laws import law_may_fault, law_members
from cspdiag.codegen.c.process.routines import Waiting
from cspdiag.codegen.c.process.steps.plain_steps import (
    READS,
    WRITES,
    check,
    finite_checked,
    hand_over,
    mark_written,
    receive,
    required,
    send,
)
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import EQUALITY, Call, Code, address, call, code, ignored, infix, own
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.media import Spelling
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.statements import Plain, Remark, Statement, choose, give, go, in_block, run, store
from cspdiag.codegen.shared.trees import nodes
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expressions import Expression, SignalValue
from cspdiag.network.ir.network import Connection, ConstantEnd, DiscardEnd, SubmodelClass

EXTERNAL = ("latched", "direct")

_LONGEST_BLOCK = 10
"""A run of more equations than this is a function of its own, and the step function stays short."""


@record
class _Read:
    source: Spelling | None
    """None where ``constant`` is read."""
    into: Code
    constant: Expression | None = None


@record
class _Write:
    sink: Spelling
    value: Code
    """An lvalue that outlives the wait."""


# ---- Submodels that are classes of their own


def call_law(writer: Writer, step: ir.RunInstance, class_: SubmodelClass) -> list[Statement]:
    """One run of a submodel."""
    instance = writer.members.instances[step.instance]
    member = own(writer.members.member(step.instance))
    names = law_members(class_, writer.names)
    struct = writer.names.classes[class_.name]
    reads = [_law_read(writer, c, member.field(names[_port(c)])) for c in _attached(class_, instance.connections, "in")]
    writes: list[_Write] = []
    for connection in _attached(class_, instance.connections, "out"):
        end = connection.attachment
        if not isinstance(end, ConstantEnd | DiscardEnd):
            writes.append(_Write(writer.members.sink(end), member.field(names[_port(connection)])))
    outer, writer.inner = writer.inner, step.instance
    law = ir.SkipStep(span=class_.span)  # where -O0 says that a law reads and writes
    called = call(f"{struct}_calculate", address(member))
    ran = [run(ignored(called)), writer.fault(writer.where(law))] if law_may_fault(class_) else [run(called)]
    found = [*_reading(writer, law, step.instance, reads), *ran, *_writing(writer, law, step.instance, writes)]
    writer.inner = outer
    return [writer.remark(step), *found]


def _attached(class_: SubmodelClass, connections: Sequence[Connection], direction: str) -> Iterator[Connection]:
    """The connections of the inputs or outputs in the order of the ports."""
    for port in class_.ports:
        if port.direction == direction:
            yield from (c for c in connections if port.name in (c.port, _port(c)))


def _port(connection: Connection) -> str:
    return connection.port if connection.index is None else f"{connection.port}[{connection.index}]"


def _law_read(writer: Writer, connection: Connection, into: Code) -> _Read:
    end = connection.attachment
    if isinstance(end, ConstantEnd):
        return _Read(None, into, end.value)
    assert not isinstance(end, DiscardEnd)
    return _Read(writer.members.source(end), into)


def reset(writer: Writer, step: ir.ResetInstance) -> list[Statement]:
    """Puts the states of a submodel back."""
    struct = writer.names.classes[writer.class_of(step.instance).name]
    return [writer.remark(step), run(call(f"{struct}_reset", address(own(writer.members.member(step.instance)))))]


# ---- Control laws that were inlined


def read_inputs(writer: Writer, step: ir.ReadInputs) -> list[Statement]:
    """The inputs of an inlined law; they are members, because reading waits."""
    reads = [_Read(writer.members.source(read.source), writer.printer.signal(read.name)) for read in step.reads]
    return _reading(writer, step, "inputs", reads, with_remark=True)


def write_outputs(writer: Writer, step: ir.WriteOutputs) -> list[Statement]:
    """The outputs of an inlined law: all values first, for they may fault, then the communications."""
    found: list[Statement] = []
    writes: list[_Write] = []
    for number, write in enumerate(step.writes, 1):
        sink = writer.members.sink(write.sink)
        if isinstance(write.value, SignalValue):
            writes.append(_Write(sink, writer.printer.signal(write.value.name)))
            continue
        slot = writer.slot(sink.name, sink.type, "sent" if number == 1 else f"sent_{number}")
        found += writer.evaluated(slot, write.value, writer.where(step))
        writes.append(_Write(sink, slot))
    return [*found, *_writing(writer, step, "outputs", writes, with_remark=True)]


def run_inlined_law(writer: Writer, step: ir.RunLaw) -> list[Statement]:
    """One run of an inlined law: a function if it is long, else a block in which what only it needs are local
    variables.
    """

    def look(where: str) -> list[Plain]:
        return [run(call("CSP_FAULT_INSIDE", quoted(step.law), quoted(where), writer.failing()))]

    outside = writer.members.local_signals
    local = {name: outside[name] for name, _ in run_law_signals(step) if name in outside}
    text = f"{step.law}: {' '.join(step.doc.split())}" if step.doc else step.law
    remark = Remark(f"{text} ({writer.where(step)})")
    if len(step.equations) + len(step.next_values) + len(step.derivatives) <= _LONGEST_BLOCK:
        return [remark, *in_block(_law_statements(writer, step, look, local))]
    if not step.derivatives:  # Their integration has local variables of its own.
        names = Names({*writer.members.types.names.globals, "self"})
        local = {name: names[name.removeprefix(f"{step.law}.")] for name in local}
    body = _law_statements(writer, step, lambda where: [run(call("CSP_CHECK_LAW", quoted(where)))], local)
    faulty = any(isinstance(node, Call) and node.function == "CSP_CHECK_LAW" for node in nodes(body))
    name = writer.law_function(
        step.law, [*body, give("true")] if faulty else body, "bool" if faulty else "void", remark
    )
    called = call(name, "self")
    ran = [run(ignored(called)), *look(writer.where(step))] if faulty else [run(called)]
    return [Remark(f"{step.law} ({writer.where(step)})"), *ran]


def _law_statements(writer: Writer, step: ir.RunLaw, check: Check, local: Mapping[str, str]) -> list[Statement]:
    """``local`` are the names of the signals that are local variables."""
    members = writer.members

    def place(item: Declared) -> str:
        return writer.names.place(item.span.file, item.span.line)

    def signal(name: str) -> Code:
        return code(local[name]) if name in local else members.signal(name)

    law = run_law(
        step,
        members.process,
        owner=writer.struct,
        printer=replace(writer.printer, signal=signal),
        place=place,
        check=check,
        types_of=members.signal_types,
        local=local,
    )
    writer.add_function(law.functions)
    return [*law.statements, *(run(ignored(code(name))) for signal, name in local.items() if signal in law.unread)]


def reset_law_states(writer: Writer, step: ir.ResetStates) -> list[Statement]:
    """Puts states of the class back."""
    return [writer.remark(step), *reset_states(step.states, writer.members.process, writer.printer)]


# ---- Several communications at once


def _reading(
    writer: Writer, step: ir.Step, name: str, reads: Sequence[_Read], *, with_remark: bool = False
) -> list[Statement]:
    """Reads all; with no more than one that can wait, that is a plain communication."""
    remark = [writer.remark(step)] if with_remark else []
    waiting = [read for read in reads if read.source is not None and not read.source.at_once]
    at_once = [statement for read in reads if read not in waiting for statement in _had(writer, step, read)]
    if not waiting:
        return [*remark, check(writer), *at_once]
    if len(waiting) == 1:
        source = waiting[0].source
        assert source is not None
        return [*remark, *at_once, receive(writer, step, source, waiting[0].into)]
    offers = _Offers(writer, step, len(waiting), "INPUTS", f"reads_{name}")
    found = [*remark, *offers.begin()]
    for read in reads:
        if read in waiting and read.source is not None:
            found.append(offers.offer(READS[read.source.access], read.source, read.into))
        else:
            found += _had(writer, step, read, offers)
    return [*found, offers.wait()]


def _had(writer: Writer, step: ir.Step, read: _Read, offers: _Offers | None = None) -> list[Statement]:
    """What never waits; a variable may turn out not to have been written."""
    if read.source is None:
        assert read.constant is not None
        return writer.evaluated(read.into, read.constant, writer.where(step))
    looked = required(writer, read.source, writer.where(step))
    return [*(offers.given_up(looked) if offers is not None else looked), store(read.into, read.source.pointer)]


def _writing(
    writer: Writer, step: ir.Step, name: str, writes: Sequence[_Write], *, with_remark: bool = False
) -> list[Statement]:
    """Writes all; see ``_reading``. An output of the program that is written after another communication was begun
    needs an offer too.
    """
    remark = [writer.remark(step)] if with_remark else []
    waiting = [write for write in writes if not write.sink.at_once]
    first = writes.index(waiting[0]) if waiting else len(writes)
    late = any(write.sink.access in EXTERNAL for write in writes[first:])
    if len(waiting) <= 1 and not late:
        found: list[Statement] = [*remark]
        if not waiting or any(write.sink.access in EXTERNAL for write in writes):
            found.append(check(writer))
        for write in writes:
            if write not in waiting:
                found += _at_once(writer, step, write)
        return [*found, *(send(writer, step, waiting[0].sink, waiting[0].value) if waiting else [])]
    offers = _Offers(writer, step, len(waiting), "OUTPUTS", f"writes_{name}")
    found = [*remark, *offers.begin()]
    for write in writes:
        if write in waiting:
            found.append(offers.offer(WRITES[write.sink.access], write.sink, write.value))
        else:
            found += _at_once(writer, step, write, offers)
    return [*found, offers.wait()]


def _at_once(writer: Writer, step: ir.Step, write: _Write, offers: _Offers | None = None) -> list[Statement]:
    sink, value = write.sink, write.value
    if sink.access == "discard":
        return []
    if sink.access == "variable":
        return [store(sink.pointer, value), *mark_written(sink)]
    looked = finite_checked(writer, sink, value, writer.where(step))
    return [*(offers.given_up(looked) if offers is not None else looked), hand_over(sink, value)]


class _Offers:
    """The offers of one step function, which are made one law after the other."""

    def __init__(self, writer: Writer, step: ir.Step, count: int, waiting: Waiting, state: str) -> None:
        self.writer = writer
        self.member = own(writer.offers(count))
        self.place = writer.place(step, state, waiting, self.member.member)

    def begin(self) -> list[Statement]:
        """Cancelled processes go no further."""
        begun = call("csp_offers_begin", "party", address(self.member))
        return choose(infix("==", EQUALITY, begun, code("CSP_FAILS")), [go(self.writer.failing())])

    def offer(self, operation: str, end: Spelling, value: Code) -> Plain:
        """One communication begins."""
        offers, failing = address(self.member), self.writer.failing()
        return run(call("CSP_OFFER", offers, operation, end.pointer, value, self.place, failing), "")

    def given_up(self, looked: Sequence[Plain]) -> list[Statement]:
        """What looks for a fault, once offers have begun: they are taken back if there is one."""
        if not looked:
            return []
        *before, fault = looked
        back = run(call("csp_offers_give_up", address(self.member)))
        return [*before, *choose(call("csp_faulted"), [back, fault])]

    def wait(self) -> Statement:
        """Until all are done."""
        again = call("csp_offers_again", "party", address(self.member))
        return self.writer.wait(call("csp_offers_wait", address(self.member)), again, self.place)
