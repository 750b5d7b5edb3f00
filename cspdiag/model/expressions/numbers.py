"""Types of expressions: numbers and names; for members, calls and operators see the modules next to this one."""

from __future__ import annotations

from itertools import chain
from typing import assert_never

from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.context import Context, Surroundings
from cspdiag.model.diagnostics.availability import NotAvailableHere, NotConstant
from cspdiag.model.diagnostics.constants import NumberTooLarge
from cspdiag.model.diagnostics.names import UnknownName
from cspdiag.model.diagnostics.types import NotCondition
from cspdiag.model.expressions.calls import call
from cspdiag.model.expressions.coercion import Purpose, require
from cspdiag.model.expressions.members import array_of_ports, index, member
from cspdiag.model.expressions.operators import binary, unary, unified
from cspdiag.model.expressions.type_names import unit_of
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import (
    BOOL,
    DOUBLE,
    INT,
    TEXT,
    TIME,
    UNKNOWN,
    ArrayType,
    BoolType,
    RealType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import HERTZ, SECOND
from cspdiag.syntax import ast

SECONDS = RealType(unit=SECOND)
PI, SAMPLE, TIME_VALUE = BuiltinSymbol(name="pi"), BuiltinSymbol(name="sample"), BuiltinSymbol(name="time")
NOW = BuiltinSymbol(name="now")
_VALUES = {"pi": PI, "sample": SAMPLE, "time": TIME_VALUE, "now": NOW}


_SAMPLE_PERIODS = frozenset(["T", "Ts", "Tsample", "dt", "Δt"])


def _advice_on_missing(name: str, surroundings: Surroundings) -> str | None:
    if name in _SAMPLE_PERIODS and surroundings.place == "submodel" and not surroundings.constant:
        return "the sample period of a submodel is `sample`"
    return None


class Typer:
    """Determines the types of expressions in one place of the program, and records them and the meanings of names.

    ``in_seconds``: a ``time`` is a ``double<s>``, as in the equations of submodels.
    """

    def __init__(self, context: Context, surroundings: Surroundings, *, in_seconds: bool | None = None) -> None:
        self.context = context
        self.surroundings = surroundings
        self.in_seconds = surroundings.place == "submodel" if in_seconds is None else in_seconds

    def before_running(self) -> Typer:
        """The same place, for values that must be known before the program runs."""
        return Typer(self.context, self.surroundings.before_running(), in_seconds=self.in_seconds)

    def within(self, replicator: ast.Replicator) -> Typer:
        """The same place, inside a repetition."""
        return Typer(self.context, self.surroundings.within(replicator), in_seconds=self.in_seconds)

    def require(self, expression: ast.Expression, expected: Type, purpose: Purpose) -> Type:
        """The type of a value for a purpose; a value that does not agree is reported, and its type is unknown."""
        # Where a time is expected, durations remain durations, in submodels as well.
        typer = self
        if self.in_seconds and _is_of_time(expected):
            typer = Typer(self.context, self.surroundings, in_seconds=False)
        if isinstance(expression, ast.ArrayValue) and isinstance(expected, ArrayType):
            return typer._require_elements(expression, expected, purpose)
        if isinstance(expression, ast.Conditional) and not isinstance(expected, UnknownType):
            return typer._require_sides(expression, expected, purpose)
        return require(self.context, expression, typer.infer(expression), expected, purpose)

    def _require_elements(self, node: ast.ArrayValue, expected: ArrayType, purpose: Purpose) -> Type:
        """Require each element separately, so elements need not agree with each other."""
        found = [self.require(element, expected.element, purpose) for element in node.elements]
        if any(isinstance(element, UnknownType) for element in found):
            return self._refused(node)
        whole = ArrayType(found[0] if found else expected.element, len(found))
        self.context.program.types[node] = whole
        return require(self.context, node, whole, expected, purpose)

    def _require_sides(self, node: ast.Conditional, expected: Type, purpose: Purpose) -> Type:
        self.condition(node.condition)
        found = [self.require(side, expected, purpose) for side in (node.then, node.otherwise)]
        if any(isinstance(side, UnknownType) for side in found):
            return self._refused(node)
        self.context.program.types[node] = expected
        return expected

    def _refused(self, node: ast.Expression) -> Type:
        """Mark an expression that has a part with a reported mistake."""
        self.context.program.poisoned.add(node)
        self.context.program.types[node] = UNKNOWN
        return UNKNOWN

    def constant(self, expression: ast.Expression, expected: Type | None, purpose: Purpose) -> Type:
        """The type of a value that must be known before the program runs; any type if ``expected`` is None.

        Errors in evaluating it are reported.
        """
        typer = self.before_running()
        found = typer.infer(expression) if expected is None else typer.require(expression, expected, purpose)
        evaluate(self.context.program, expression, {}, self.context.report)
        return found

    def condition(self, expression: ast.Expression) -> None:
        """Require a bool."""
        found = self.infer(expression)
        if not isinstance(found, BoolType | UnknownType):
            self.context.refuse(NotCondition(expression.span, found=found), expression)

    def infer(self, expression: ast.Expression) -> Type:
        """The type of an expression, recorded for it and all its parts."""
        # Chains of operators are nested to the left and may be long, so they are typed without recursion.
        operations: list[ast.Binary] = []
        while isinstance(expression, ast.Binary):
            operations.append(expression)
            expression = expression.left
        types = self.context.program.types
        found = types[expression] = self._infer(expression)
        for operation in reversed(operations):
            right = self.infer(operation.right)
            found = types[operation] = binary(self.context, operation, types[operation.left], right)
        return found

    def _infer(self, expression: ast.Expression) -> Type:
        match expression:
            case ast.Number():
                return self._number(expression)
            case ast.Duration():
                if expression.is_frequency:
                    return RealType(unit=HERTZ)
                return SECONDS if self.in_seconds else TIME
            case ast.Boolean():
                return BOOL
            case ast.Text():
                return TEXT
            case ast.Name():
                return self._name(expression)
            case ast.Member():
                return self._value(member(self, expression))
            case ast.Index():
                return self._value(index(self, expression))
            case ast.Unary():
                return unary(self.context, expression, self.infer(expression.operand))
            case ast.Conditional():
                return self._conditional(expression)
            case ast.Call():
                return call(self, expression)
            case ast.ArrayValue():
                return self._array(expression)
            case ast.Binary():
                return self.infer(expression)
            case _:
                assert_never(expression)

    def _value(self, found: Type) -> Type:
        """The type of a value in the present place, where a ``time`` may be a number of seconds."""
        return SECONDS if self.in_seconds and isinstance(found, TimeType) else found

    def _number(self, expression: ast.Number) -> Type:
        if isinstance(expression.value, int) and expression.unit is None:
            self.context.literals.add(expression)
            # The most negative number is this one with a minus before it.
            if expression.value > INT.maximum + 1:
                self.context.refuse(NumberTooLarge(expression.span, type=INT), expression)
                return UNKNOWN
            return INT
        if expression.value in (float("inf"), float("-inf")):
            self.context.refuse(NumberTooLarge(expression.span, type=DOUBLE), expression)
            return UNKNOWN
        self.context.literals.add(expression)
        if expression.unit is None:
            return DOUBLE
        unit = unit_of(self.context, expression.unit, expression.span, expression)
        return UNKNOWN if unit is None else RealType(unit=unit)

    def _name(self, node: ast.Name) -> Type:
        symbol = self.find(node.name)
        if symbol is None:
            self._refuse_unknown(node)
            return UNKNOWN
        self.context.program.bindings[node] = symbol
        return self._value(self._symbol_type(node, symbol))

    def find(self, name: str) -> Symbol | None:
        """What a name means here, or None."""
        surroundings = self.surroundings
        return (
            surroundings.replicators.get(name)
            or surroundings.scope.names.get(name)
            or self.context.program.definitions.get(name)
            or _VALUES.get(name)
        )

    def _symbol_type(self, node: ast.Name, symbol: Symbol) -> Type:
        types = self.context.program.types
        match symbol:
            case ast.Constant() | ast.Parameter():
                return types.get(symbol, UNKNOWN)
            case ast.Replicator():
                return INT
            case BuiltinSymbol():
                return self._builtin(node, symbol)
            case ast.Variable() | ast.Let() | ast.State() | EndLabelSymbol() | PortSymbol() | ast.Channel():
                return self._signal(node, symbol)
            case (
                ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition() | ast.ExceptionDefinition()
                | ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition()
                | ast.EnvironmentDefinition() | ast.Instance() | EnumLiteralSymbol()
            ):  # fmt: skip
                self._refuse_kind(node, symbol, None)
                return UNKNOWN
            case _:
                assert_never(symbol)

    def _signal(
        self, node: ast.Name, symbol: ast.Variable | ast.Let | ast.State | EndLabelSymbol | PortSymbol | ast.Channel
    ) -> Type:
        """The type of something that changes while the program runs."""
        is_process = self.surroundings.place == "process"
        if isinstance(symbol, ast.Channel):
            self._refuse_kind(node, symbol, f"read it into a variable: `{node.name} ? x`")
            return UNKNOWN
        if isinstance(symbol, PortSymbol) and is_process and not self.surroundings.constant:
            if symbol.declaration.direction == "in":
                advice = f"read it into a variable: `{node.name} ? x`"
            else:
                advice = "an out port can only be written; keep the value in a variable as well"
            self._refuse_kind(node, symbol, advice)
            return UNKNOWN
        if self.surroundings.constant:
            found = NotConstant(node.span, name=node.name, kind=described(symbol), declared=declared_at(symbol))
            self.context.refuse(found, node)
            return UNKNOWN
        if isinstance(symbol, PortSymbol | EndLabelSymbol):
            return array_of_ports(self.context, symbol) if isinstance(symbol, PortSymbol) else symbol.type
        return self.context.program.types.get(symbol, UNKNOWN)

    def _builtin(self, node: ast.Name, symbol: BuiltinSymbol) -> Type:
        if symbol is PI:
            return DOUBLE
        place = self.surroundings.place
        if symbol is NOW and place == "process" and not self.surroundings.constant:
            return TIME
        if symbol is not NOW and place == "submodel" and (symbol is SAMPLE or not self.surroundings.constant):
            if symbol is TIME_VALUE:
                self.context.program.time_uses.setdefault(self.surroundings.owner, node.span)
            return SECONDS
        running = "the equations of a submodel" if place == "submodel" else f"the composition of a {place}"
        where = "a constant expression" if self.surroundings.constant else running
        advice = {
            "sample": "`sample` belongs to the equations of a submodel",
            "time": (
                "`time` belongs to the equations of submodels in an environment; in the composition of a process it is "
                "`now`"
            ),
            "now": (
                "`now` belongs to the composition of a process; in the equations of submodels in an environment it is "
                "`time`"
            ),
        }[symbol.name]
        self.context.refuse(NotAvailableHere(node.span, what=symbol.name, where=where, advice=advice), node)
        return UNKNOWN

    def _refuse_unknown(self, node: ast.Name) -> None:
        self.context.program.poisoned.add(node)
        undeclared = self.surroundings.scope.undeclared
        if self.context.excuses_unknown_names or node.name in undeclared:
            return
        surroundings, definitions = self.surroundings, self.context.program.definitions
        constants = (
            name for name, found in definitions.items() if isinstance(found, ast.Constant | ast.EnumDefinition)
        )
        known = chain(surroundings.replicators, surroundings.scope.names, constants)
        literals = self._literals(node.name)
        suggestion = None if literals else self.context.speller.nearest(node.name, known)
        if suggestion is None:
            undeclared.add(node.name)
        near = self.find(suggestion) if suggestion else None
        declared = declared_at(near) if near else None
        expected = "variable" if surroundings.place == "process" and not surroundings.constant else "value"
        self.context.refuse(
            UnknownName(
                node.span,
                name=node.name,
                expected=expected,
                suggestion=suggestion,
                declared=declared,
                advice=(
                    f"did you mean {' or '.join(literals)}?"
                    if literals
                    else _advice_on_missing(node.name, surroundings)
                ),
            ),
            node,
        )

    def _literals(self, name: str) -> list[str]:
        """The enum literals with this name, each with its enum."""
        enums = (found for found in self.context.program.definitions.values() if isinstance(found, ast.EnumDefinition))
        return [f"`{enum.name.text}.{name}`" for enum in enums if any(name == one.text for one in enum.literals)]

    def _refuse_kind(self, node: ast.Name, symbol: Symbol, advice: str | None) -> None:
        if isinstance(symbol, ast.EnumDefinition):
            advice = f"write one of its literals: `{node.name}.{symbol.literals[0].text}`" if symbol.literals else None
        if isinstance(symbol, ast.Instance) and self.surroundings.place == "submodel":
            advice = f"write which of its outputs: `{node.name}.output`"
        self.context.refuse_kind(node.span, node.name, symbol, "a value", advice, node)

    def _conditional(self, node: ast.Conditional) -> Type:
        self.condition(node.condition)
        parts = [node.then, node.otherwise]
        types = [self.infer(part) for part in parts]
        if all(part in self.context.literals for part in parts):
            self.context.literals.add(node)
        return unified(self.context, parts, types, "both sides of `if`", node)

    def _array(self, node: ast.ArrayValue) -> Type:
        elements = list(node.elements)
        types = [self.infer(element) for element in elements]
        return ArrayType(unified(self.context, elements, types, "the elements of an array", node), len(elements))


def _is_of_time(expected: Type) -> bool:
    while isinstance(expected, ArrayType):
        expected = expected.element
    return isinstance(expected, TimeType)
