"""Control laws in processes: inputs are read concurrently, the law runs once, outputs are written concurrently."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import body_name, kernel_of, law_may_fault, law_members, law_verbs
from cspdiag.codegen.c.laws.equations import (
    Check,
    EquationWriter,
    LocalVariable,
    Target,
    leave_if_faulted,
    without_last_return,
)
from cspdiag.codegen.c.laws.inlined_laws import reset_states, run_law, run_law_signals
from cspdiag.codegen.c.process.routines import Waiting
from cspdiag.codegen.c.process.steps.kept_values import kept_values
from cspdiag.codegen.c.process.steps.plain_steps import (
    READS,
    WRITES,
    check_cancelled,
    check_finite,
    check_written,
    hand_over,
    mark_written,
    receive,
    send,
)
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import (
    CSP,
    EQUALITY,
    Code,
    address,
    call,
    cast,
    code,
    ignored,
    infix,
    own,
)
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.media import EndInC
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.statements import (
    If,
    Remark,
    Return,
    Statement,
    choose,
    goto,
    goto_if,
    in_block,
    mentions_kernel,
    run,
    store,
)
from cspdiag.codegen.shared.laws.equations import finite_signals
from cspdiag.codegen.shared.trees import nodes
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expressions import Expression, SignalValue
from cspdiag.network.ir.network import Connection, ConstantEnd, DiscardEnd, SubmodelClass

EXTERNAL = ("latched", "direct")

_LONGEST_BLOCK = 10
"""A run of more equations than this becomes a function of its own, to keep the step function short."""


@record
class _Read:
    source: EndInC | None
    """None if ``constant`` is read instead."""
    into: Code
    constant: Expression | None = None


@record
class _Write:
    sink: EndInC
    value: Code
    """An lvalue that exists during the wait."""
    finite: bool = False
    """Whether it cannot be NaN or infinite, because the law has tested it."""


# ---- Submodels that are classes of their own


def call_law(writer: Writer, step: ir.RunInstance, class_: SubmodelClass) -> list[Statement]:
    """One run of a submodel."""
    instance = writer.members.instances[step.instance]
    member = own(writer.members.member(step.instance))
    names = law_members(class_, writer.names)
    struct = writer.names.classes[class_.name]
    reads = [
        _law_read(writer, c, member.field(names[_port(c)])) for c in _connections_of(class_, instance.connections, "in")
    ]
    tested = finite_signals(class_.equations)
    writes: list[_Write] = []
    for connection in _connections_of(class_, instance.connections, "out"):
        end = connection.attachment
        if not isinstance(end, ConstantEnd | DiscardEnd):
            port = _port(connection)
            finite = port in tested or class_.external is not None
            writes.append(_Write(writer.members.sink(end), member.field(names[port]), finite))
    outer, writer.inner = writer.inner, step.instance
    law = ir.SkipStep(span=class_.span)  # the place at which -O0 reports the communications of a law
    called = call(f"{struct}_calculate", *kernel_of(law_verbs(class_), "calculate"), address(member))
    noted = _test_outputs(writer, class_, member, names) if class_.external is not None else []
    check = [writer.raise_noted_fault(writer.where(law))] if law_may_fault(class_) or noted else []
    ran = [run(called), *noted, *check]
    statements = [*_read_all(writer, law, step.instance, reads), *ran, *_write_all(writer, law, step.instance, writes)]
    writer.inner = outer
    return [writer.remark(step), *statements]


def _test_outputs(writer: Writer, class_: SubmodelClass, member: Code, names: Names) -> list[Statement]:
    """What notes a fault if a law that is written by hand has calculated a real that is not finite, or what is no value
    of an enumeration.
    """
    types, ports = writer.members.types, [port for port in class_.ports if port.direction == "out"]
    finite = (types.finite_check(port.type, member.field(names[port.name]), code("NULL")) for port in ports)
    enumerators = (types.enumerator_checks(port.type, member.field(names[port.name])) for port in ports)
    return [run(test) for test in (*finite, *chain.from_iterable(enumerators)) if test is not None]


def _connections_of(class_: SubmodelClass, connections: Sequence[Connection], direction: str) -> Iterator[Connection]:
    """The connections of the inputs or outputs, in the order of the ports."""
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
    """Resets the states of a submodel."""
    class_ = writer.class_of(step.instance)
    assert isinstance(class_, SubmodelClass)
    kernel = kernel_of(law_verbs(class_), "reset")
    member = address(own(writer.members.member(step.instance)))
    called = call(f"{writer.names.classes[class_.name]}_reset", *kernel, member)
    if not kernel:
        return [writer.remark(step), run(called)]
    return [writer.remark(step), run(called), writer.raise_noted_fault(writer.where(step))]


# ---- Control laws that were inlined


def read_inputs(writer: Writer, step: ir.ReadInputs) -> list[Statement]:
    """Reads the inputs of an inlined law; they are members, because reading can wait."""
    reads = [_Read(writer.members.source(read.source), writer.printer.signal(read.name)) for read in step.reads]
    return _read_all(writer, step, "inputs", reads, with_remark=True)


def write_outputs(writer: Writer, step: ir.WriteOutputs) -> list[Statement]:
    """Writes the outputs of an inlined law: first evaluates all values, which may fault, then communicates."""
    statements: list[Statement] = []
    writes: list[_Write] = []
    for number, write in enumerate(step.writes, 1):
        sink = writer.members.sink(write.sink)
        if isinstance(write.value, SignalValue):
            name = write.value.name
            writes.append(_Write(sink, writer.printer.signal(name), name in writer.members.finite_signals))
            continue
        slot = writer.slot(sink.name, sink.type, "sent" if number == 1 else f"sent_{number}")
        statements += writer.evaluate_into(slot, write.value, writer.where(step))
        writes.append(_Write(sink, slot))
    return [*statements, *_write_all(writer, step, "outputs", writes, with_remark=True)]


def run_inlined_law(writer: Writer, step: ir.RunLaw) -> list[Statement]:
    """One run of an inlined law: a function if it is long, else a block. Signals that only the run needs are local
    variables.
    """

    def fault_check(where: str) -> list[Statement]:
        return [goto_if(call("csp_raised_in", "party", quoted(step.law), quoted(where)), writer.failure_label())]

    outside = writer.members.local_signals
    local = {name: outside[name] for name, _ in run_law_signals(step) if name in outside}
    text = f"{step.law}: {' '.join(step.doc.split())}" if step.doc else step.law
    remark = Remark(f"{text} ({writer.where(step)})")
    if len(step.equations) + len(step.next_values) + len(step.derivatives) <= _LONGEST_BLOCK:
        return [remark, *in_block(_law_statements(writer, step, fault_check, local))]
    if not step.derivatives:  # Their integration has local variables of its own.
        names = Names({*writer.members.types.names.globals, "self"})
        local = {name: names[name.removeprefix(f"{step.law}.")] for name in local}
    body = _law_statements(writer, step, leave_if_faulted, local)
    name = writer.law_function(step.law, without_last_return(body), remark)
    called = call(name, *([CSP] if mentions_kernel(body) else []), "self")
    check = fault_check(writer.where(step)) if any(isinstance(node, Return) for node in nodes(body)) else []
    return [Remark(f"{step.law} ({writer.where(step)})"), run(called), *check]


def _law_statements(writer: Writer, step: ir.RunLaw, check: Check, local: Mapping[str, str]) -> list[Statement]:
    """``local`` are the names of the signals that are local variables."""
    members = writer.members
    kept = kept_values(writer, step)

    def signal(name: str) -> Code:
        if kept is not None and name in kept.members:
            return kept.members[name]
        return code(local[name]) if name in local else members.signal(name)

    def target(name: str) -> Target:
        if name in local:
            return LocalVariable(f"const {members.types.type_name(members.signal_types[name])}", local[name])
        return members.signal(name)

    printer = replace(writer.printer, signal=signal)
    first: list[Statement] = []
    if kept is not None:
        first = kept.statements(EquationWriter(printer, _place_by(writer), check, own, body_name), target)
    law = run_law(
        step if kept is None else kept.law,
        members.process,
        owner=writer.struct,
        printer=printer,
        place=_place_by(writer),
        check=check,
        types_of=members.signal_types if kept is None else {**members.signal_types, **kept.types},
        local=local,
    )
    writer.add_function(law.functions)
    return [
        *first,
        *law.statements,
        *(run(ignored(code(name))) for signal, name in local.items() if signal in law.unread),
    ]


def _place_by(writer: Writer) -> Callable[[Declared], str]:
    """The place of a declaration in the source text."""
    return lambda item: writer.names.place(item.span.file, item.span.line)


def reset_law_states(writer: Writer, step: ir.ResetStates) -> list[Statement]:
    """Resets states of the class."""

    def fault_check(where: str) -> list[Statement]:
        return [writer.raise_noted_fault(where)]

    equations = EquationWriter(writer.printer, _place_by(writer), fault_check, own, body_name)
    return [writer.remark(step), *reset_states(step.states, writer.members.process, equations)]


# ---- Concurrent communications


def _read_all(
    writer: Writer, step: ir.Step, name: str, reads: Sequence[_Read], *, with_remark: bool = False
) -> list[Statement]:
    """Reads all inputs concurrently; if at most one can wait, that one is a plain communication."""
    remark = [writer.remark(step)] if with_remark else []
    waiting = [read for read in reads if read.source is not None and not read.source.never_waits]
    at_once = [
        statement for read in reads if read not in waiting for statement in _read_without_waiting(writer, step, read)
    ]
    if not waiting:
        return [*remark, check_cancelled(writer), *at_once]
    if len(waiting) == 1:
        source = waiting[0].source
        assert source is not None
        return [*remark, *at_once, *receive(writer, step, source, waiting[0].into)]
    offers = _Offers(writer, step, len(waiting), "INPUTS", f"reads_{name}")
    statements = [*remark, *offers.begin()]
    for read in reads:
        if read in waiting and read.source is not None:
            statements.append(offers.offer(READS[read.source.access], read.source, read.into))
        else:
            statements += _read_without_waiting(writer, step, read, offers)
    return [*statements, offers.wait()]


def _read_without_waiting(writer: Writer, step: ir.Step, read: _Read, offers: _Offers | None = None) -> list[Statement]:
    """Reads an input that never waits; a variable may turn out not to have been written."""
    if read.source is None:
        assert read.constant is not None
        return writer.evaluate_into(read.into, read.constant, writer.where(step))
    checks = check_written(writer, read.source, writer.where(step))
    return [*(offers.take_back_if(checks) if offers is not None else checks), store(read.into, read.source.pointer)]


def _write_all(
    writer: Writer, step: ir.Step, name: str, writes: Sequence[_Write], *, with_remark: bool = False
) -> list[Statement]:
    """Writes all outputs concurrently; see ``_read_all``. An output of the program that is written after another
    communication has begun needs offers, too.
    """
    remark = [writer.remark(step)] if with_remark else []
    waiting = [write for write in writes if not write.sink.never_waits]
    first = writes.index(waiting[0]) if waiting else len(writes)
    late = any(write.sink.access in EXTERNAL for write in writes[first:])
    if len(waiting) <= 1 and not late:
        statements: list[Statement] = [*remark]
        if not waiting or any(write.sink.access in EXTERNAL for write in writes):
            statements.append(check_cancelled(writer))
        for write in writes:
            if write not in waiting:
                statements += _write_without_waiting(writer, step, write)
        return [*statements, *(send(writer, step, waiting[0].sink, waiting[0].value) if waiting else [])]
    offers = _Offers(writer, step, len(waiting), "OUTPUTS", f"writes_{name}")
    statements = [*remark, *offers.begin()]
    for write in writes:
        if write in waiting:
            statements.append(offers.offer(WRITES[write.sink.access], write.sink, write.value))
        else:
            statements += _write_without_waiting(writer, step, write, offers)
    return [*statements, offers.wait()]


def _write_without_waiting(
    writer: Writer, step: ir.Step, write: _Write, offers: _Offers | None = None
) -> list[Statement]:
    sink, value = write.sink, write.value
    if sink.access == "discard":
        return []
    if sink.access == "variable":
        return [store(sink.pointer, value), *mark_written(sink)]
    checks = [] if write.finite else check_finite(writer, sink, value, writer.where(step))
    return [*(offers.take_back_if(checks) if offers is not None else checks), hand_over(sink, value)]


class _Offers:
    """The offers for the concurrent communications of one step; all steps of a step function share their memory."""

    def __init__(self, writer: Writer, step: ir.Step, count: int, waiting: Waiting, state: str) -> None:
        self.writer = writer
        self.member = own(writer.offers(count))
        self.place = writer.place(step, state, waiting, self.member.member)

    def begin(self) -> list[Statement]:
        """Begins the offers, unless the process was cancelled."""
        begun = call("csp_offers_begin", "party", address(self.member))
        return choose(infix("==", EQUALITY, begun, code("CSP_FAILS")), [goto(self.writer.failure_label())])

    def offer(self, operation: str, end: EndInC, value: Code) -> If:
        """Begins one communication."""
        made = call("CSP_OFFER", address(self.member), operation, end.pointer, value)
        failed = (store("party->state", cast("uint16_t", code(self.place))), goto(self.writer.failure_label()))
        return If(infix("==", EQUALITY, made, code("CSP_FAILS")), failed)

    def take_back_if(self, checks: Sequence[Statement]) -> list[Statement]:
        """The check for a fault after offers have begun: it takes them back if there is one."""
        if not checks:
            return []
        *before, fault = checks
        assert isinstance(fault, If)
        back = run(call("csp_offers_give_up", address(self.member)))
        return [*before, If(fault.condition, (back, *fault.then))]

    def wait(self) -> Statement:
        """Waits until all communications are complete."""
        again = call("csp_offers_again", "party", address(self.member))
        return self.writer.wait(call("csp_offers_wait", address(self.member)), again, self.place)
