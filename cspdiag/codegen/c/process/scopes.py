"""Named groups, and processes that were flattened into the one that ran them: what observers are told, and ends that close."""

from __future__ import annotations

from cspdiag.codegen.c.process.flow import ends
from cspdiag.codegen.c.process.members import SELF
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.names import identifier
from cspdiag.codegen.c.text.rows import Row, rows
from cspdiag.network.ir.actions import Group, ProcessScope, ReportCommunication


def group_rows(writer: Writer, step: Group) -> list[Row]:
    """A labelled part: observers are told when it begins and ends, in whatever way."""
    return _watched(writer, step, step.label, [])


def scope_rows(writer: Writer, step: ProcessScope) -> list[Row]:
    """The body of another process; its reading ends close with it."""
    samples = writer.members.samples_of_scope(step.instance)
    closing = rows(f"csp_ends_close(&{SELF}{samples});") if samples is not None else []
    outer, writer.inner = writer.inner, step.instance
    found = _watched(writer, step, step.instance, closing)
    writer.inner = outer
    return found


def _watched(writer: Writer, step: Group | ProcessScope, name: str, closing: list[Row]) -> list[Row]:
    path = name if writer.inner is None or isinstance(step, ProcessScope) else f"{writer.inner}.{name}"
    writer.observed.append((path, step.class_name if isinstance(step, ProcessScope) else ""))
    number = f"party->number + {len(writer.observed)}U"
    outer = writer.handler
    inner = writer.handler = writer.new_handler(f"{identifier(name)}_fails".upper())
    body = writer.rows(step.body)
    writer.handler = outer
    ending = [*closing, Row(f"csp_observe_end({number});")]
    passes = ends(step.body)
    doc = step.doc if isinstance(step, ProcessScope) else None
    told = f"{name}: {' '.join(doc.split())}" if doc else f"{name}:"
    begun = Row(f"csp_observe_begin({number});", comment=f"{told} ({writer.where(step)})")
    whole = [begun, *body, *(ending if passes else [])]
    failed = [*ending, Row(f"goto {writer.failing()};")] if inner.reached or inner.needed else []
    return writer.protected(whole, inner, failed, passes=passes, where=writer.where(step))


def report_rows(writer: Writer, step: ReportCommunication) -> list[Row]:
    """Tells the trace of a communication that is no more than an assignment."""
    number = writer.members.report(step.channel, step.value.type)
    slot = writer.slot(step.channel, step.value.type, "reported")
    value = writer.evaluated(f"{slot} = ", step.value, ";", writer.where(step))
    observed = f"csp_observe({SELF}first_report + {number}U, &{slot}, party->number, party->number);"
    return [Row("#if CSP_TRACE"), *value, Row(observed), Row("#endif")]
