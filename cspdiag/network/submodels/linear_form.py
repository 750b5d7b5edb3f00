"""The linear form of expressions: coefficients of states, and what remains of the value without them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import assert_never

from cspdiag.base.record import record
from cspdiag.model.types import DOUBLE, is_double
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    TunableValue,
    UnaryOperation,
    Value,
    VariableValue,
)

ONE = LiteralValue(type=DOUBLE, value=1.0)
_MINUS_ONE = LiteralValue(type=DOUBLE, value=-1.0)

LARGEST_TEXT = 24
"""Of how many parts a coefficient may consist; a larger one becomes its value."""


class NotLinearError(Exception):
    """An expression has no linear form with constant coefficients."""


@record
class LinearForm:
    """The sum of ``terms``, coefficients by state, and ``rest``, which contains no state; None if nothing remains."""

    terms: Mapping[str, Expression]
    rest: Expression | None


Form = LinearForm | tuple["Form", ...]
"""The form of a real number, or those of the numbers in an array."""


@record
class LinearForms:
    """Makes linear forms of expressions over the signals in ``known``, which move, and any others, which are held.

    ``value_of`` returns the value of an expression over constants, None of any other; ``probed`` does so where nothing
    but the existence of the value, or a zero, matters.
    """

    known: dict[str, Form]
    moving: frozenset[str]
    value_of: Callable[[Expression], Value | None]
    probed: Callable[[Expression], Value | None]

    def form(self, expression: Expression) -> Form:
        """The form of an expression.

        Coefficients are computed as the expression computes its value: those of a sum are added, of a difference
        subtracted or negated, and a factor or divisor is applied to each, and to the rest. Raises NotLinearError.
        """
        if not self._moves(expression):
            return LinearForm({}, expression)
        match expression:
            case SignalValue():
                if expression.name not in self.known:
                    raise NotLinearError
                return self.known[expression.name]
            case UnaryOperation(operator="-"):
                form = self._number(expression.operand)
                return LinearForm({name: _minus(part) for name, part in form.terms.items()}, _minus_any(form.rest))
            case BinaryOperation(operator="+" | "-"):
                return self._sum(expression)
            case BinaryOperation(operator="*"):
                return self._product(expression)
            case BinaryOperation(operator="/"):
                divisor = self._constant(expression.right)
                if self.probed(divisor) == 0.0:
                    raise NotLinearError
                return self._scaled(expression.left, lambda part: _made(expression, part, divisor))
            case ArrayElements():
                return tuple(self.form(part) for part in expression.values)
            case ElementValue():
                return self._element(expression)
            case (
                LiteralValue()
                | ParameterValue()
                | TunableValue()
                | VariableValue()
                | PresentTime()
                | UnaryOperation()
                | BinaryOperation()
                | ConditionalValue()
                | FunctionCall()
                | Conversion()
                | FieldValue()
                | StructValue()
            ):
                raise NotLinearError
            case _:
                assert_never(expression)

    def _moves(self, expression: Expression) -> bool:
        return any(
            isinstance(part, PresentTime) or (isinstance(part, SignalValue) and part.name in self.moving)
            for part in walk(expression)
        )

    def _number(self, expression: Expression) -> LinearForm:
        form = self.form(expression)
        if isinstance(form, tuple) or not is_double(expression.type):
            raise NotLinearError
        return form

    def _constant(self, expression: Expression) -> Expression:
        if self._moves(expression) or self.probed(expression) is None:
            raise NotLinearError
        return expression

    def _sum(self, whole: BinaryOperation) -> LinearForm:
        left, right = self._number(whole.left), self._number(whole.right)
        subtracts = whole.operator == "-"

        def joined(first: Expression | None, second: Expression | None) -> Expression | None:
            if first is None:
                return _minus_any(second) if subtracts else second
            return first if second is None else _made(whole, first, second)

        names = dict.fromkeys((*left.terms, *right.terms))
        terms = {name: joined(left.terms.get(name), right.terms.get(name)) for name in names}
        kept = {name: self._short(part) for name, part in terms.items() if part is not None}
        return LinearForm(kept, joined(left.rest, right.rest))

    def _product(self, whole: BinaryOperation) -> LinearForm:
        if not self._moves(whole.left):
            factor = self._constant(whole.left)
            return self._scaled(whole.right, lambda part: factor if part is ONE else _made(whole, factor, part))
        factor = self._constant(whole.right)
        return self._scaled(whole.left, lambda part: factor if part is ONE else _made(whole, part, factor))

    def _scaled(self, expression: Expression, scale: Callable[[Expression], Expression]) -> LinearForm:
        form = self._number(expression)
        terms = {name: self._short(scale(part)) for name, part in form.terms.items()}
        return LinearForm(terms, None if form.rest is None else scale(form.rest))

    def _element(self, expression: ElementValue) -> Form:
        whole, index = self.form(expression.operand), self.value_of(expression.index)
        if not isinstance(whole, tuple) or not isinstance(index, int) or not 0 <= index < len(whole):
            raise NotLinearError
        return whole[index]

    def _short(self, coefficient: Expression) -> Expression:
        if sum(1 for _ in walk(coefficient)) <= LARGEST_TEXT:
            return coefficient
        value = self.value_of(coefficient)
        if value is None:
            raise NotLinearError
        return LiteralValue(type=DOUBLE, value=value)


def _made(whole: BinaryOperation, left: Expression, right: Expression) -> Expression:
    """The operation with other operands."""
    return BinaryOperation(type=DOUBLE, operator=whole.operator, left=left, right=right, span=whole.span)


def _minus(part: Expression) -> Expression:
    if isinstance(part, UnaryOperation):
        return part.operand
    if part is ONE or part is _MINUS_ONE:
        return _MINUS_ONE if part is ONE else ONE
    return UnaryOperation(type=DOUBLE, operator="-", operand=part)


def _minus_any(part: Expression | None) -> Expression | None:
    return None if part is None else _minus(part)
