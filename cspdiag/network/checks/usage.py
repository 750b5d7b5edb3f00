"""Names that are not used, and channels that are read as if they kept a value."""

from __future__ import annotations

from collections.abc import Set

from cspdiag.base import Report
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.channels import ChannelReadAsVariable
from cspdiag.network.diagnostics.usage import PortUnused, VariableUnused
from cspdiag.network.ir.actions import (
    CoreAction,
)
from cspdiag.network.relations import UsesByKey, variables_read
from cspdiag.network.shapes import Shape, attached_key
from cspdiag.syntax import ast


def check_usage(
    shape: Shape,
    uses: UsesByKey,
    report: Report,
    agreement: Agreement,
    *,
    named: Set[ast.Node],
    is_specification: bool,
) -> None:
    """Find ports and variables of a process that are not used; refuse conditions on channels that keep no value.

    A specification allows no communication at a port that it does not use. ``named`` are the declarations that are
    named anywhere, even in a part that is repeated zero times in this shape.
    """
    if shape.body is None or shape.incomplete:
        return
    _check_values(shape, shape.body, report)
    if shape.has_unknown_uses:
        return
    for port, _, key in shape.port_elements():
        if is_specification:
            continue
        if key in uses or key in shape.port_spans:
            agreement.refute(PortUnused, port.span, key)
        else:
            unused = PortUnused(span=port.span, port=key, process=shape.name, direction=port.direction)
            agreement.claim(unused, key)
    connected = {attached_key(a) for instance in shape.instances.values() for a in instance.attachments.values()}
    for channel in shape.channels.values():
        use = uses.get(channel.name)
        if isinstance(channel.declaration, ast.Connection):
            continue
        is_one_of_several = bool(channel.replicators)
        if use is None and channel.name not in connected and (is_one_of_several or channel.declaration not in named):
            agreement.claim(VariableUnused(span=channel.span, name=channel.name), channel.name)
        else:
            agreement.refute(VariableUnused, channel.span, channel.name)


def _check_values(shape: Shape, body: CoreAction, report: Report) -> None:
    for value in variables_read(body):
        channel = shape.channels.get(value.channel)
        if channel is not None and channel.kind != "var" and not channel.excused and value.span is not None:
            refused = ChannelReadAsVariable(
                span=value.span, channel=channel.name, kind=channel.kind, declared=channel.span
            )
            report.add(refused)
