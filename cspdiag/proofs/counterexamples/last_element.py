"""The last iteration of ``for i < N { … }``, written out."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base import Report, Span
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.proofs.counterexamples.surroundings import within
from cspdiag.syntax import ast


class LastElement:
    """The text of the declarations of a loop in its last iteration; ``count`` is the number of iterations, None if it
    depends on parameters.
    """

    def __init__(self, program: Program, replicator: ast.Replicator) -> None:
        self._program = program
        self._replicator = replicator
        self._size = replicator.count
        count = evaluate(program, replicator.count, {}, Report())
        self.count = count if isinstance(count, int) else None

    @property
    def fewer(self) -> str:
        """The number of the other iterations."""
        return self._text((1, -1))

    @property
    def index(self) -> str:
        """The index of the last iteration."""
        return self._text((1, -1))

    def text_of(self, part: ast.Node, changed: Mapping[Span, str]) -> str:
        """The text of a declaration of the loop in the last iteration, with some of its parts ``changed``."""
        found = dict(changed)
        for reference in within(part, ast.Reference):
            for index in (*reference.indexes, *reference.member_indexes):
                if any(self._program.bindings.get(name) is self._replicator for name in within(index, ast.Name)):
                    found[index.span] = self._last(index)
        return _changed(part, found)

    def _last(self, expression: ast.Expression) -> str:
        linear = self._linear(expression)
        if linear is not None:
            return self._text(linear)
        names = [name for name in within(expression, ast.Name) if self._program.bindings.get(name) is self._replicator]
        return _changed(expression, {name.span: f"({self.index})" for name in names})

    def _text(self, linear: tuple[int, int]) -> str:
        """The text of ``a`` times the number of iterations plus ``b``."""
        times, more = linear
        assert self.count is not None
        if times == 0 or isinstance(self._size, ast.Number):
            return str(times * self.count + more)
        size = self._size.span.text
        if isinstance(self._size, ast.Conditional):
            size = f"({size})"
        if times > 1:
            size = f"{times} * {size if isinstance(self._size, ast.Name) else f'({size})'}"
        return size if more == 0 else f"{size} {'+' if more > 0 else '-'} {abs(more)}"

    def _linear(self, expression: ast.Expression) -> tuple[int, int] | None:
        """The factors ``a`` and ``b`` of a value that is ``a`` times the number of iterations plus ``b``; None for
        other values.
        """
        if isinstance(expression, ast.Name) and self._program.bindings.get(expression) is self._replicator:
            return 1, -1
        if isinstance(expression, ast.Number) and isinstance(expression.value, int):
            return 0, expression.value
        if expression.span.text == self._size.span.text:
            return 1, 0
        if not isinstance(expression, ast.Binary):
            return None
        left, right = self._linear(expression.left), self._linear(expression.right)
        if left is None or right is None:
            return None
        match expression.operator:
            case "+":
                return left[0] + right[0], left[1] + right[1]
            case "-":
                return left[0] - right[0], left[1] - right[1]
            case "%" if right == (1, 0) and self.count:
                return left[0] - (left[0] * self.count + left[1]) // self.count, left[1]
        return None


def _changed(part: ast.Node, changed: Mapping[Span, str]) -> str:
    text, at = "", part.span.start
    source = part.span.source.text
    for span in sorted(changed, key=lambda span: span.start):
        if part.span.start <= span.start and span.end <= part.span.end:
            text, at = f"{text}{source[at : span.start]}{changed[span]}", span.end
    return text + source[at : part.span.end]
