"""Lowers the ports of the outermost process."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program, Value
from cspdiag.network.infer.kinds import RequestedKinds
from cspdiag.network.ir.network import ChannelKind, ExternalPort
from cspdiag.network.ir.zero import zero
from cspdiag.network.shapes import Key, PortShape, RequestedKind, Shape
from cspdiag.syntax import ast


def external_ports(
    program: Program, shape: Shape, requested: RequestedKinds, report: Report
) -> tuple[ExternalPort, ...]:
    """All ports of the outermost process, arrays of ports element by element."""
    return tuple(
        _external(program, shape, port, index, key, requested, report)
        for port, (_, index), key in shape.port_elements()
    )


def _external(
    program: Program,
    shape: Shape,
    port: PortShape,
    index: int | None,
    key: Key,
    requested: RequestedKinds,
    report: Report,
) -> ExternalPort:
    declaration = port.symbol.declaration

    def value(expression: ast.Expression | None) -> Value | None:
        return None if expression is None else evaluate(program, expression, shape.values, report)

    safe = value(declaration.safe)
    if port.direction == "out" and safe is None:
        safe = zero(port.type)
    return ExternalPort(
        name=key,
        doc=declaration.doc,
        span=port.span,
        direction=port.direction,
        type=port.type,
        index=index,
        sampling=port.sampling,
        immediate=declaration.immediate,
        safe=safe,
        default=value(declaration.default),
        kind=_kind(requested.get(key, {})),
    )


def _kind(requested: dict[str, RequestedKind]) -> ChannelKind:
    return "broadcast" if "broadcast" in requested else "any" if "any" in requested else "sync"
