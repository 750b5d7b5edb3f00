"""Expressions, types and arguments of the tree."""

from __future__ import annotations

from typing import Any, cast

from cspdiag.base.record import replaced
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.common import Construction, as_tuple, chain, node
from cspdiag.syntax.diagnostics.tokens import NumberOutOfRange, ZeroFrequency
from cspdiag.syntax.parse.lexer import Token
from cspdiag.syntax.parse.numbers import nanoseconds, number_value


class ExpressionBuilder(Construction):
    """The rules of expressions."""

    def number(self, span: Span, token: Token) -> ast.Number:
        """``12``, ``0.5``."""
        return ast.Number(span=span, value=self._value(span, token.text), unit=None)

    def quantity(self, span: Span, token: Token) -> ast.Number:
        """``0.5<rad/s>``."""
        digits, _, unit = token.text.partition("<")
        return ast.Number(span=span, value=float(self._value(span, digits)), unit=unit[:-1])

    def _value(self, span: Span, digits: str) -> int | float:
        value = number_value(digits)
        if value is None:
            self.report.add(NumberOutOfRange(span))
            return 0
        return value

    def duration(self, span: Span, token: Token) -> ast.Duration:
        """``1 ms``, ``1 kHz``."""
        digits = token.text.rstrip("nusmiHzkM").rstrip()
        unit = cast("Any", token.text[len(digits) :].lstrip())
        magnitude = float(digits)
        value = nanoseconds(digits, unit)
        if value is None:
            self.report.add(ZeroFrequency(span) if magnitude == 0 else NumberOutOfRange(span))
            magnitude, value = 1.0, 1
        return ast.Duration(span=span, magnitude=magnitude, unit=unit, nanoseconds=value)

    def text(self, span: Span, token: Token) -> ast.Text:
        """A string."""
        return ast.Text(span=span, value=token.text[1:-1])

    true = node(ast.Boolean, value=True)
    false = node(ast.Boolean, value=False)

    def name(self, span: Span, name: ast.Identifier) -> ast.Name:
        """A name used as a value."""
        return ast.Name(span=span, name=name.text)

    member = node(ast.Member, "value", "name")  # value.name
    indexed = node(ast.Index, "value", "index")  # value[index]

    def unary(self, span: Span, operator: Token, operand: ast.Expression) -> ast.Unary:
        """``-x`` or ``not x``."""
        return ast.Unary(span=span, operator=cast("Any", operator.text), operand=operand)

    def binary(self, span: Span, left: ast.Expression, operator: Token, right: ast.Expression) -> ast.Binary:
        """An operator between two expressions."""
        return ast.Binary(span=span, operator=cast("Any", operator.text), left=left, right=right)

    conditional = node(ast.Conditional, "condition", "then", "otherwise")  # if condition then value else otherwise

    def parenthesized(self, span: Span, value: ast.Expression) -> ast.Expression:
        """``(value)``; the span of the value then includes the parentheses."""
        return replaced(value, span=span, parenthesized=True)

    array = chain(ast.ArrayValue, "elements")  # [1, 2]
    call = node(ast.Call, "function", "arguments")  # function(arguments)
    arguments = as_tuple  # Arguments in parentheses
    positional = node(ast.Argument, "value", name=None)  # An argument without a name
    named = node(ast.Argument, "name", "value")  # name = value

    def type_name(self, span: Span, name: ast.Identifier, unit: Token | None, *sizes: ast.Expression) -> ast.TypeName:
        """``double<rad>[3]``."""
        return ast.TypeName(
            span=span,
            name=name,
            unit=None if unit is None else unit.text[1:-1],
            unit_span=None if unit is None else unit.span,
            dimensions=sizes,
        )

    def dimension(self, span: Span, size: ast.Expression) -> ast.Expression:
        """``[size]``."""
        return size

    replicator = node(ast.Replicator, "name", "count")  # i < N

    def index(self, span: Span, value: ast.Expression) -> list[ast.Expression | ast.Identifier]:
        """One index of a reference; a list, so that ``reference`` can distinguish it from the member."""
        return [value]

    def reference(
        self, span: Span, name: ast.Identifier, *rest: ast.Identifier | list[ast.Expression] | None
    ) -> ast.Reference:
        """``cell[i].out[j]``."""
        member: ast.Identifier | None = None
        indexes: list[ast.Expression] = []
        member_indexes: list[ast.Expression] = []
        for part in rest:
            if isinstance(part, list):
                (indexes if member is None else member_indexes).extend(part)
            elif part is not None:
                member = part
        return ast.Reference(
            span=span, name=name, indexes=tuple(indexes), member=member, member_indexes=tuple(member_indexes)
        )
