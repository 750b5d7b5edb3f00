"""Types of expressions: names, members, indexes and values; operators and functions are next door."""

from __future__ import annotations

from itertools import chain
from typing import assert_never

from cspdiag.model.arguments import matched, report_missing
from cspdiag.model.coercion import Purpose, require
from cspdiag.model.context import Context, Surroundings
from cspdiag.model.diagnostics_availability import NotAvailableHere, NotConstant
from cspdiag.model.diagnostics_constants import NumberTooLarge
from cspdiag.model.diagnostics_names import UnknownMember, UnknownName, WrongKind
from cspdiag.model.diagnostics_types import NotCondition, NotIndexed
from cspdiag.model.functions import FUNCTIONS, call, conversion
from cspdiag.model.operators import binary, unary, unified
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Symbol
from cspdiag.model.symbols import CONVERSIONS, declared_at, described
from cspdiag.model.type_names import unit_of
from cspdiag.model.types import (
    BOOL,
    DOUBLE,
    INT,
    TEXT,
    TIME,
    UNKNOWN,
    ArrayType,
    BoolType,
    EnumType,
    RealType,
    StructType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.model.units import HERTZ, SECOND
from cspdiag.model.wording import noun
from cspdiag.syntax import ast

SECONDS = RealType(unit=SECOND)
PI, SAMPLE, TIME_VALUE = BuiltinSymbol(name="pi"), BuiltinSymbol(name="sample"), BuiltinSymbol(name="time")
_VALUES = {"pi": PI, "sample": SAMPLE, "time": TIME_VALUE}


class Typer:
    """Finds the types of expressions in one place of the program and records them with what names mean.

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
        """The same place inside something that is repeated."""
        return Typer(self.context, self.surroundings.within(replicator), in_seconds=self.in_seconds)

    def require(self, expression: ast.Expression, wanted: Type, purpose: Purpose) -> Type:
        """The type of a value that is wanted for a purpose; reported and unknown where it does not agree."""
        # Where a time is wanted, durations are computed with as durations, in submodels too.
        typer = self
        if self.in_seconds and _is_of_time(wanted):
            typer = Typer(self.context, self.surroundings, in_seconds=False)
        return require(self.context, expression, typer.infer(expression), wanted, purpose)

    def constant(self, expression: ast.Expression, wanted: Type | None, purpose: Purpose) -> Type:
        """The type of a value that must be known before the program runs; any type where ``wanted`` is None."""
        typer = self.before_running()
        return typer.infer(expression) if wanted is None else typer.require(expression, wanted, purpose)

    def condition(self, expression: ast.Expression) -> None:
        """Require a bool."""
        found = self.infer(expression)
        if not isinstance(found, BoolType | UnknownType):
            self.context.refuse(NotCondition(expression.span, found=found), expression)

    def infer(self, expression: ast.Expression) -> Type:
        """The type of an expression, recorded for it and all its parts."""
        # Chains of operators lean to the left and may be long: they are followed without recursion.
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
                return self._value(self._member(expression))
            case ast.Index():
                return self._value(self._index(expression))
            case ast.Unary():
                return unary(self.context, expression, self.infer(expression.operand))
            case ast.Conditional():
                return self._conditional(expression)
            case ast.Call():
                return self._call(expression)
            case ast.ArrayValue():
                return self._array(expression)
            case ast.Binary():
                return self.infer(expression)
            case _:
                assert_never(expression)

    def _value(self, found: Type) -> Type:
        """A ``time`` as equations see it."""
        return SECONDS if self.in_seconds and isinstance(found, TimeType) else found

    def _number(self, expression: ast.Number) -> Type:
        if isinstance(expression.value, int) and expression.unit is None:
            self.context.literals.add(expression)
            # The most negative number is written as this one with a minus before it.
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
            case _:
                self._refuse_kind(node, symbol, None)
                return UNKNOWN

    def _signal(
        self, node: ast.Name, symbol: ast.Variable | ast.Let | ast.State | EndLabelSymbol | PortSymbol | ast.Channel
    ) -> Type:
        """What changes while the program runs."""
        is_process = self.surroundings.place == "process"
        if isinstance(symbol, ast.Channel):
            self._refuse_kind(node, symbol, f"read it into a variable: `{node.name} ? x`")
            return UNKNOWN
        if isinstance(symbol, PortSymbol) and is_process and not self.surroundings.constant:
            if symbol.declaration.direction == "in":
                advice = f"read it into a variable: `{node.name} ? x`"
            else:
                advice = "an out port is written only; keep the value in a variable as well"
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
        if place == "submodel" and (symbol is SAMPLE or not self.surroundings.constant):
            if symbol is TIME_VALUE:
                self.context.program.time_uses.setdefault(self.surroundings.owner, node.span)
            return SECONDS
        where = "a constant expression" if self.surroundings.constant else f"the composition of a {place}"
        advice = (
            "`sample` belongs to the equations of a submodel"
            if symbol is SAMPLE
            else "`time` belongs to the equations of submodels in an environment"
        )
        self.context.refuse(NotAvailableHere(node.span, what=symbol.name, where=where, advice=advice), node)
        return UNKNOWN

    def _refuse_unknown(self, node: ast.Name) -> None:
        self.context.program.poisoned.add(node)
        if self.context.excuses_unknown_names:
            return
        surroundings, definitions = self.surroundings, self.context.program.definitions
        constants = (
            name for name, found in definitions.items() if isinstance(found, ast.Constant | ast.EnumDefinition)
        )
        suggestion = self.context.speller.nearest(
            node.name, chain(surroundings.replicators, surroundings.scope.names, constants)
        )
        near = self.find(suggestion) if suggestion else None
        declared = declared_at(near) if near else None
        wanted = (
            "value"
            if surroundings.constant
            else {"process": "variable", "submodel": "value"}.get(surroundings.place, "value")
        )
        self.context.refuse(
            UnknownName(node.span, name=node.name, wanted=wanted, suggestion=suggestion, declared=declared), node
        )

    def _refuse_kind(self, node: ast.Name, symbol: Symbol, advice: str | None) -> None:
        if isinstance(symbol, ast.EnumDefinition):
            advice = f"write one of its literals: `{node.name}.{symbol.literals[0].text}`" if symbol.literals else None
        if isinstance(symbol, ast.Instance) and self.surroundings.place == "submodel":
            advice = f"write which of its outputs: `{node.name}.output`"
        self.context.refuse(
            WrongKind(
                node.span,
                name=node.name,
                kind=described(symbol),
                wanted="a value",
                advice=advice,
                declared=declared_at(symbol),
            ),
            node,
        )

    def _member(self, node: ast.Member) -> Type:
        program = self.context.program
        symbol = self._owner_symbol(node.value)
        if isinstance(symbol, ast.EnumDefinition):
            return self._literal(node, symbol)
        if isinstance(symbol, ast.Instance):
            return self._port_of(node, symbol)
        owner = self.infer(node.value)
        if isinstance(owner, UnknownType):
            return UNKNOWN
        if not isinstance(owner, StructType):
            what = f"`{node.value.span.text}`"
            self.context.refuse(
                NotIndexed(
                    node.name.span, what=what, problem=f"is {noun(owner)} and has no fields", advice=None, declared=None
                ),
                node,
            )
            return UNKNOWN
        found = owner.field(node.name.text)
        if found is None:
            self._refuse_member(node, f"the struct `{owner.name}`", "field", [name for name, _ in owner.fields], None)
            return UNKNOWN
        program.members[node] = node.name.text
        return found

    def _owner_symbol(self, value: ast.Expression) -> Symbol | None:
        """The enum or the instance that a member is asked of; None for values."""
        base = value
        while isinstance(base, ast.Index):
            base = base.value
        if not isinstance(base, ast.Name):
            return None
        symbol = self.find(base.name)
        if isinstance(symbol, ast.Instance) or (isinstance(symbol, ast.EnumDefinition) and base is value):
            self.context.program.bindings[base] = symbol
            return symbol
        return None

    def _literal(self, node: ast.Member, enum: ast.EnumDefinition) -> Type:
        names = [literal.text for literal in enum.literals]
        if node.name.text not in names:
            self._refuse_member(node, f"the enum `{enum.name.text}`", "literal", names, enum.name)
            return UNKNOWN
        literal = EnumLiteralSymbol(definition=enum, index=names.index(node.name.text))
        self.context.program.members[node] = literal
        self.context.program.bindings[node.name] = literal
        return self.context.program.types.get(enum, EnumType(enum.name.text, tuple(names)))

    def _port_of(self, node: ast.Member, instance: ast.Instance) -> Type:
        """``pid.output`` in an equation."""
        program = self.context.program
        for index in _indexes(node.value):
            self.constant(index, INT, Purpose(what="an index"))
        definition = program.bindings.get(instance.definition)
        if not isinstance(definition, ast.SubmodelDefinition | ast.ProcessDefinition | ast.DriverDefinition):
            return UNKNOWN
        if self.surroundings.place != "submodel":
            advice = f"connect it to a label and use that: `{node.span.text} -> value : type`"
            name = node.span.text
            self.context.refuse(
                WrongKind(
                    node.span, name=name, kind="a port of an instance", wanted="a value", advice=advice, declared=None
                ),
                node,
            )
            return UNKNOWN
        ports = program.scopes[definition].ports
        port = ports.get(node.name.text)
        if port is None:
            outputs = [name for name, found in ports.items() if found.declaration.direction == "out"]
            owner = f"`{instance.name.text}`, an instance of `{instance.definition.text}`,"
            self._refuse_member(node, owner, "port", outputs, definition.name)
            return UNKNOWN
        program.members[node] = port
        program.bindings[node.name] = port
        if self.surroundings.constant:
            found = NotConstant(node.span, name=node.span.text, kind=described(port), declared=declared_at(port))
            self.context.refuse(found, node)
            return UNKNOWN
        return array_of_ports(self.context, port)

    def _refuse_member(
        self, node: ast.Member, owner: str, wanted: str, options: list[str], declared: ast.Identifier | None
    ) -> None:
        self.context.refuse(
            UnknownMember(
                node.name.span,
                name=node.name.text,
                owner=owner,
                wanted=wanted,
                options=tuple(options),
                suggestion=self.context.speller.nearest(node.name.text, options),
                declared=declared.span if declared else None,
            ),
            node,
        )

    def _index(self, node: ast.Index) -> Type:
        owner = self.infer(node.value)
        found = self.infer(node.index)
        require(self.context, node.index, found, INT, Purpose(what="an index"))
        if isinstance(owner, UnknownType):
            return UNKNOWN
        if not isinstance(owner, ArrayType):
            what = f"`{node.value.span.text}`"
            refused = NotIndexed(
                node.span, what=what, problem=f"is {noun(owner)} and has no elements", advice=None, declared=None
            )
            self.context.refuse(refused, node)
            return UNKNOWN
        return owner.element

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

    def _call(self, node: ast.Call) -> Type:
        name = node.function.text
        program = self.context.program
        definition = program.definitions.get(name)
        structure = program.types.get(definition) if definition is not None else None
        if definition is not None and isinstance(structure, StructType):
            program.bindings[node.function] = definition
            return self._structure(node, structure)
        if name in FUNCTIONS:
            program.bindings[node.function] = BuiltinSymbol(name=name)
            return call(self, node)
        if name in CONVERSIONS:
            program.bindings[node.function] = BuiltinSymbol(name=name)
            return conversion(self, node)
        for argument in node.arguments:
            self.infer(argument.value)
        self._refuse_function(node, definition)
        return UNKNOWN

    def _structure(self, node: ast.Call, structure: StructType) -> Type:
        definition = self.context.program.definitions[structure.name]
        if not isinstance(definition, ast.StructDefinition):
            return UNKNOWN
        declared, types = definition.name.span, dict(structure.fields)
        matches = matched(self.context, structure.name, definition.fields, node.arguments, declared)
        example = f"{structure.name}({', '.join(f'{name} = ...' for name in types)})"
        report_missing(self.context, structure.name, matches, tuple(types), node, example, declared)
        for field in definition.fields:
            argument = matches.values.get(field.name.text)
            if argument is not None:
                purpose = Purpose(
                    what=f"the field `{field.name.text}`", declared=field.name.span, declared_text="declared here"
                )
                self.require(argument.value, types[field.name.text], purpose)
        return structure

    def _refuse_function(self, node: ast.Call, definition: ast.Definition | None) -> None:
        name = node.function.text
        self.context.program.poisoned.add(node)
        if isinstance(definition, ast.StructDefinition):
            # Its own fields were refused.
            return
        if definition is not None:
            advice = (
                f"declare an instance: `{name.lower()} : {name}(...)`"
                if isinstance(definition, ast.SubmodelDefinition | ast.ProcessDefinition)
                else None
            )
            refused = WrongKind(
                node.function.span,
                name=name,
                kind=described(definition),
                wanted="a function",
                advice=advice,
                declared=declared_at(definition),
            )
            self.context.refuse(refused, node)
        elif not self.context.excuses_unknown_names:
            structs = (
                found
                for found, given in self.context.program.definitions.items()
                if isinstance(given, ast.StructDefinition)
            )
            suggestion = self.context.speller.nearest(name, chain(FUNCTIONS, CONVERSIONS, structs))
            self.context.refuse(
                UnknownName(node.function.span, name=name, wanted="function", suggestion=suggestion, declared=None),
                node,
            )


def array_of_ports(context: Context, port: PortSymbol) -> Type:
    """The type of a port; of an array of ports, an array of it."""
    found = port.type
    for dimension in reversed(port.port.dimensions):
        size = context.sizes.get(dimension)
        found = ArrayType(found, size)
    return found


def _indexes(value: ast.Expression) -> list[ast.Expression]:
    found = []
    while isinstance(value, ast.Index):
        found.append(value.index)
        value = value.value
    return found


def _is_of_time(wanted: Type) -> bool:
    while isinstance(wanted, ArrayType):
        wanted = wanted.element
    return isinstance(wanted, TimeType)
