"""Named groups and flattened processes: notifications of observers, and reading ends that are closed."""

from __future__ import annotations

from cspdiag.codegen.c.process.flow import can_complete
from cspdiag.codegen.c.process.routines import Section
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import SUM, Aggregate, Parenthesized, address, call, code, infix, own, unsigned
from cspdiag.codegen.c.text.names import identifier
from cspdiag.codegen.c.text.numbered import Shifted
from cspdiag.codegen.c.text.statements import Directive, Plain, Remark, Statement, goto, run
from cspdiag.codegen.shared.trees import nodes
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import Group, ProcessScope, ReportCommunication


def group(writer: Writer, step: Group) -> list[Statement]:
    """A named group: observers are notified when it begins, and when it ends, also by an exception."""
    return _watched(writer, step, step.label, [])


def scope(writer: Writer, step: ProcessScope) -> list[Statement]:
    """The body of a flattened process; its reading ends are closed at its end."""
    samples = writer.members.samples_of_scope(step.instance)
    closing = [run(call("csp_ends_close", address(own(samples))))] if samples is not None else []
    outer = writer.inner, writer.scope
    writer.inner = writer.scope = step.instance
    statements = _watched(writer, step, step.instance, closing)
    writer.inner, writer.scope = outer
    if can_complete(step.body):
        section = Section(step.instance, writer.where(step), statements[0], statements[-1])
        writer.current.sections.append(section)
    return statements


def _watched(writer: Writer, step: Group | ProcessScope, name: str, closing: list[Plain]) -> list[Statement]:
    path = name if writer.inner is None or isinstance(step, ProcessScope) else f"{writer.inner}.{name}"
    writer.observed.append((path, step.class_name if isinstance(step, ProcessScope) else ""))
    number = infix("+", SUM, code("party->number"), unsigned(len(writer.observed)))
    outer = writer.handler
    inner = writer.handler = writer.new_handler(
        "fails" if isinstance(step, ProcessScope) else f"{identifier(name)}_fails"
    )
    body = writer.statements(step.body)
    writer.handler = outer
    ending: list[Statement] = [*closing, run(call("csp_observe_end", number))]
    passes = can_complete(step.body)
    doc = step.doc if isinstance(step, ProcessScope) else None
    text = f"{name}: {' '.join(doc.split())}" if doc else f"{name}:"
    begun: list[Statement] = [Remark(f"{text} ({writer.where(step)})"), run(call("csp_observe_begin", number))]
    whole = [*begun, *body, *(ending if passes else [])]
    failed = [*ending, goto(writer.failure_label())] if inner.is_jumped_to or inner.is_entered_by_kernel else []
    return writer.protected(whole, inner, failed, passes=passes, where=writer.where(step))


def report(writer: Writer, step: ReportCommunication) -> list[Statement]:
    """Reports a communication that became an assignment to the trace."""
    number = writer.members.report(step.channel, step.value.type)
    slot = writer.slot(_value_name(writer, step.value.type), step.value.type, "reported")
    channel = Shifted(own("first_report"), unsigned(number))
    if not writer.may_fault(step.value):
        value = writer.printed(step.value)
        has_braces = any(isinstance(node, Aggregate) for node in nodes(value))
        return [run(call("CSP_REPORT", channel, slot, Parenthesized(value) if has_braces else value))]
    statements = writer.evaluate_into(slot, step.value, writer.where(step))
    observed = run(call("csp_observe", channel, address(slot), "party->number", "party->number"))
    return [Directive("#if CSP_TRACE"), *statements, observed, Directive("#endif")]


def _value_name(writer: Writer, type_: Type) -> str:
    """The name of the member for values of a type that are reported: ``int64_value``."""
    name = writer.members.types.type_name(type_)
    return f"{name.removeprefix('struct ').removesuffix('_t')}_value"
