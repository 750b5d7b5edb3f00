"""The layout of expressions, types and arguments."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar, assert_never

from cspdiag.syntax import ast
from cspdiag.syntax.format.layout import FILL, NOTHING, SPACE, Mark, Separator
from cspdiag.syntax.format.writer import Writer

T = TypeVar("T")

_LEVELS = (["or"], ["and"], ["==", "!=", "<", "<=", ">", ">="], ["+", "-"], ["*", "/", "%"], ["^"])
_PRECEDENCE = {operator: level for level, operators in enumerate(_LEVELS) for operator in operators}


class ExpressionFormatter:
    """Writes expressions; every method consumes exactly the tokens of its node.

    ``before`` is the separator between a node and the previous token.
    """

    def __init__(self, writer: Writer) -> None:
        self.writer = writer

    def token(self, before: Separator = "") -> None:
        """The next token, unchanged."""
        self.writer.take(before)

    def expression(self, node: ast.Expression, before: Separator = "") -> None:
        """An expression with its parentheses."""
        if not node.parenthesized:
            self._bare(node, before)
            return
        match node:
            case ast.Binary(left=first) | ast.Member(value=first) | ast.Index(value=first):
                pairs = self.writer.parentheses_before(first.span.start)
            case (
                ast.Number() | ast.Duration() | ast.Boolean() | ast.Text() | ast.Name() | ast.Unary()
                | ast.Conditional() | ast.Call() | ast.ArrayValue()
            ):  # fmt: skip
                pairs = self.writer.parentheses_before(node.span.end)
            case _:
                assert_never(node)
        self.enclosed(pairs, lambda separator: self._bare(node, separator), before)

    def enclosed(self, pairs: int, write: Callable[[Separator], None], before: Separator) -> None:
        """Write something inside this number of pairs of parentheses."""
        if pairs == 0:
            write(before)
            return
        self.token(before)
        with self.writer.group():
            with self.writer.indented():
                self.enclosed(pairs - 1, write, NOTHING)
                self.writer.comments()
            self.token(NOTHING)

    def _bare(self, node: ast.Expression, before: Separator) -> None:
        match node:
            case ast.Number() | ast.Duration() | ast.Boolean() | ast.Text() | ast.Name():
                self.token(before)
            case ast.Member(value=value):
                self.expression(value, before)
                self.token()
                self.token()
            case ast.Index(value=value, index=index):
                self.expression(value, before)
                self.token()
                self.expression(index)
                self.token()
            case ast.Unary(operator=operator, operand=operand):
                self.token(before)
                self.expression(operand, " " if operator == "not" else "")
            case ast.Binary():
                self._binary(node, before)
            case ast.Conditional():
                with self.writer.group(before):
                    self._conditional(node)
            case ast.Call(arguments=arguments):
                self.token(before)
                self.arguments(arguments)
            case ast.ArrayValue(elements=elements):
                self.token(before)
                self._bracketed(elements, self.expression)
            case _:
                assert_never(node)

    def _binary(self, node: ast.Binary, before: Separator) -> None:
        """A chain of operators with the same precedence, which are broken together."""
        precedence = _PRECEDENCE[node.operator]
        chain = [node]
        first: ast.Expression = node.left
        while isinstance(first, ast.Binary) and not first.parenthesized and _PRECEDENCE[first.operator] == precedence:
            chain.append(first)
            first = first.left
        if node.operator == "^":
            self.expression(node.left, before)
            self.token()
            self.expression(node.right)
            return
        with self.writer.group(before):
            self.expression(first)
            with self.writer.indented():
                for link in reversed(chain):
                    self.token(SPACE)
                    self.expression(link.right, " ")

    def _conditional(self, node: ast.Conditional) -> None:
        """A conditional expression; if it is broken, each ``else`` is on a line of its own, and ``else if`` is in the
        same column.
        """
        with self.writer.group():
            self.token()
            self.expression(node.condition, " ")
            with self.writer.indented():
                self.token(SPACE)
                self.expression(node.then, " ")
        self.token(SPACE)
        if isinstance(node.otherwise, ast.Conditional) and not node.otherwise.parenthesized:
            self.writer.separate(" ")
            self._conditional(node.otherwise)
        else:
            self.expression(node.otherwise, " ")

    def value(self, node: ast.Expression) -> None:
        """The right-hand side of an equation; a broken conditional expression begins on a line of its own."""
        if not isinstance(node, ast.Conditional) or node.parenthesized:
            self.expression(node, " ")
            return
        with self.writer.group():
            self.writer.keep_broken()
            with self.writer.indented():
                self.writer.separate(SPACE)
                self._conditional(node)

    def arguments(self, arguments: Sequence[ast.Argument]) -> None:
        """Arguments in parentheses."""
        self.token()
        self._bracketed(arguments, self._argument)

    def _argument(self, node: ast.Argument, before: Separator) -> None:
        if node.name is None:
            self.expression(node.value, before)
            return
        self.token(before)
        self.token(" ")
        self.expression(node.value, " ")

    def _bracketed(self, items: Sequence[T], write: Callable[[T, Separator], None]) -> None:
        """A list up to its closing bracket.

        It is broken if it does not fit, or if its author broke it after the bracket; then the author's other line
        breaks are kept, too.
        """
        with self.writer.group():
            broken = bool(items) and self.writer.keep_broken()
            with self.writer.indented():
                for position, item in enumerate(items):
                    if position:
                        self.token()
                    stays = position > 0 and broken and self.writer.new_line_before_next()
                    write(item, Mark.NEW_LINE if stays else FILL if position else NOTHING)
                self.writer.comments()
            self.token(NOTHING if items else "")

    def listed(self, items: Sequence[T], write: Callable[[T, Separator], None], before: Separator = "") -> None:
        """Items with commas between them."""
        for position, item in enumerate(items):
            if position:
                self.token()
            write(item, FILL if position else before)

    def type_name(self, node: ast.TypeName, before: Separator = "") -> None:
        """A type with its unit and dimensions."""
        self.token(before)
        if node.unit is not None:
            self.writer.take_unit()
        self.indexes(node.dimensions)

    def indexes(self, indexes: Sequence[ast.Expression]) -> None:
        """``[i][j]``."""
        for index in indexes:
            self.token()
            self.expression(index)
            self.token()

    def replicator(self, node: ast.Replicator, before: Separator = "") -> None:
        """``i < N``."""
        self.token(before)
        self.token(" ")
        self.expression(node.count, " ")

    def reference(self, node: ast.Reference | ast.Discard, before: Separator = "") -> None:
        """``cell[i].out[j]`` or ``_``."""
        self.token(before)
        if isinstance(node, ast.Discard):
            return
        self.indexes(node.indexes)
        if node.member is not None:
            self.token()
            self.token()
            self.indexes(node.member_indexes)

    def parameters(self, parameters: Sequence[ast.Parameter]) -> None:
        """Parameters in parentheses."""
        self.token()
        self._bracketed(parameters, self._parameter)

    def _parameter(self, node: ast.Parameter, before: Separator) -> None:
        self.token(before)
        self.token()
        self.type_name(node.type, " ")
        if node.default is not None:
            self.token(" ")
            self.expression(node.default, " ")
