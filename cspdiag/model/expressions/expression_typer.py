"""The interface through which the typing of calls, members and functions types the expressions inside them."""

from __future__ import annotations

from typing import Protocol

from cspdiag.model.context import Context, Surroundings
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.program import Symbol
from cspdiag.model.types import Type
from cspdiag.syntax import ast


class ExpressionTyper(Protocol):
    """Determines the types of expressions in one place of the program; see ``numbers.Typer``."""

    context: Context
    surroundings: Surroundings

    def before_running(self) -> ExpressionTyper:
        """The same place, for values that must be known before the program runs."""

    def infer(self, expression: ast.Expression) -> Type:
        """The type of an expression, recorded for it and all its parts."""

    def require(self, expression: ast.Expression, expected: Type, purpose: Purpose) -> Type:
        """The type of a value for a purpose; a value that does not agree is reported, and its type is unknown."""

    def constant(self, expression: ast.Expression, expected: Type | None, purpose: Purpose) -> Type:
        """The type of a value that must be known before the program runs; any type if ``expected`` is None."""

    def find(self, name: str) -> Symbol | None:
        """What a name means here, or None."""
