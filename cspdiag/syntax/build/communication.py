"""Ports, instances, channels and communication relationships of the tree."""

from __future__ import annotations

from typing import Any, cast

from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.common import as_tuple, declared, node
from cspdiag.syntax.build.expressions import ExpressionBuilder
from cspdiag.syntax.diagnostics.tokens import LabelNotAName, NotAnInstanceName, SourceDiscarded
from cspdiag.syntax.parse.lexer import Token


@record
class ArrowMiddle:
    """The middle of a communication relationship: label, type and kind, between its two arrows."""

    label: ast.Identifier | None
    type: ast.TypeName | None
    kind: ast.Kind | None


@record
class Timing:
    """``@ T [immediate]``."""

    sampling: ast.Sampling | None
    immediate: bool


class CommunicationBuilder(ExpressionBuilder):
    """The rules of ports and of the communication diagram."""

    port_list = as_tuple  # All port declarations of a definition

    def ports(self, span: Span, direction: Token, first: ast.PortName, *rest: Any) -> ast.Ports:
        """A port declaration."""
        *names, port_type, default, timing, safe = rest
        return ast.Ports(
            span=span,
            doc=self.doc(span.start),
            direction=cast("Any", direction.text),
            names=(first, *names),
            type=port_type,
            default=default,
            sampling=timing.sampling,
            immediate=timing.immediate,
            safe=safe,
        )

    def port_name(self, span: Span, name: ast.Identifier, *sizes: ast.Expression) -> ast.PortName:
        """``request[N]``."""
        return ast.PortName(span=span, name=name, dimensions=sizes)

    def untimed(self, span: Span) -> Timing:
        """No period."""
        return Timing(None, False)

    def sampled(self, span: Span, sampling: ast.Sampling) -> Timing:
        """``@ T``."""
        return Timing(sampling, False)

    def sampled_immediate(self, span: Span, sampling: ast.Sampling) -> Timing:
        """``@ T immediate``."""
        return Timing(sampling, True)

    def sampling(self, span: Span, period: ast.Expression, offset: ast.Expression | None) -> ast.Sampling:
        """``T [offset d]``."""
        return ast.Sampling(span=span, period=period, offset=offset)

    communication_block = node(ast.Communication, "declarations")  # communication { ... }
    declarations = as_tuple  # The contents of a communication block

    def instance(
        self,
        span: Span,
        reference: ast.Reference,
        definition: ast.Identifier,
        arguments: tuple[ast.Argument, ...] | None,
    ) -> ast.Instance:
        """``cell[i < 8] : Cell(id = i)``."""
        if reference.member is not None or len(reference.indexes) > 1:
            self.report.add(NotAnInstanceName(reference.span))
        size: ast.Expression | ast.Replicator | None = reference.indexes[0] if reference.indexes else None
        if isinstance(size, ast.Binary) and size.operator == "<" and isinstance(size.left, ast.Name):
            counter = ast.Identifier(span=size.left.span, text=size.left.name)
            size = ast.Replicator(span=size.span, name=counter, count=size.right)
        return ast.Instance(
            span=span,
            doc=self.doc(span.start),
            name=reference.name,
            size=size,
            definition=definition,
            arguments=arguments or (),
        )

    variable = declared(ast.Variable, "name", "type", "initial")  # var name : type = initial
    channel = declared(ast.Channel, "name", "type", "kind")  # channel name : type kind
    repeated_declarations = node(ast.RepeatedDeclarations, "replicator", "declarations")  # for i < N { ... }

    def connection_direct(
        self,
        span: Span,
        sources: tuple[ast.Reference | ast.Discard, ...],
        sinks: tuple[ast.Reference | ast.Discard, ...],
    ) -> ast.Connection:
        """``sources -> sinks``."""
        return self._connection(span, sources, ArrowMiddle(None, None, None), sinks)

    def connection_through(
        self,
        span: Span,
        sources: tuple[ast.Reference | ast.Discard, ...],
        medium: ArrowMiddle,
        sinks: tuple[ast.Reference | ast.Discard, ...],
    ) -> ast.Connection:
        """``sources -> label : type kind -> sinks``."""
        return self._connection(span, sources, medium, sinks)

    def connection_to_label(
        self, span: Span, sources: tuple[ast.Reference | ast.Discard, ...], medium: ArrowMiddle
    ) -> ast.Connection:
        """``sources -> label : type``."""
        return self._connection(span, sources, medium, ())

    def _connection(
        self,
        span: Span,
        sources: tuple[ast.Reference | ast.Discard, ...],
        medium: ArrowMiddle,
        sinks: tuple[ast.Reference | ast.Discard, ...],
    ) -> ast.Connection:
        for source in sources:
            if isinstance(source, ast.Discard):
                self.report.add(SourceDiscarded(source.span))
        return ast.Connection(
            span=span,
            doc=self.doc(span.start),
            sources=tuple(source for source in sources if isinstance(source, ast.Reference)),
            label=medium.label,
            type=medium.type,
            kind=medium.kind,
            sinks=sinks,
        )

    references = as_tuple  # Ends of an arrow
    discard = node(ast.Discard)  # _

    def medium(self, span: Span, label: ast.Reference, kind: ast.Kind | None) -> ArrowMiddle:
        """``label kind``."""
        return ArrowMiddle(self._label(label), None, kind)

    def medium_kind(self, span: Span, kind: ast.Kind) -> ArrowMiddle:
        """``kind``."""
        return ArrowMiddle(None, None, kind)

    def medium_typed(self, span: Span, medium: ArrowMiddle) -> ArrowMiddle:
        """``label : type kind``."""
        return medium

    def medium_type(self, span: Span, channel_type: ast.TypeName, kind: ast.Kind | None) -> ArrowMiddle:
        """``: type kind``."""
        return ArrowMiddle(None, channel_type, kind)

    def end_label(
        self, span: Span, label: ast.Reference, channel_type: ast.TypeName, kind: ast.Kind | None
    ) -> ArrowMiddle:
        """``label : type kind``."""
        return ArrowMiddle(self._label(label), channel_type, kind)

    def _label(self, reference: ast.Reference) -> ast.Identifier:
        if reference.member is not None or reference.indexes:
            self.report.add(LabelNotAName(reference.span))
        return reference.name

    def kind(self, span: Span, name: Token, capacity: ast.Expression | None = None) -> ast.Kind:
        """``broadcast``, ``buffer 4``."""
        return ast.Kind(span=span, name=cast("Any", name.text), capacity=capacity)
