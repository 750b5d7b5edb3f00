"""Types of members and elements: ``pose.x``, ``Mode.idle``, ``pid.output``, ``values[2]``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.model.context import Context
from cspdiag.model.diagnostics.availability import NotConstant
from cspdiag.model.diagnostics.names import UnknownMember, WrongKind
from cspdiag.model.diagnostics.types import NotIndexed
from cspdiag.model.expressions.coercion import Purpose, require
from cspdiag.model.program import EnumLiteralSymbol, PortSymbol, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import INT, UNKNOWN, ArrayType, EnumType, StructType, Type, UnknownType
from cspdiag.model.wording import noun
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.expressions.expression_typer import ExpressionTyper


def member(typer: ExpressionTyper, node: ast.Member) -> Type:
    """The type of a field, a literal of an enum, or a port of an inner submodel, which is recorded in ``members``."""
    program = typer.context.program
    symbol = _owner_symbol(typer, node.value)
    if isinstance(symbol, ast.EnumDefinition):
        return _literal(typer, node, symbol)
    if isinstance(symbol, ast.Instance):
        return _port_of(typer, node, symbol)
    owner = typer.infer(node.value)
    if isinstance(owner, UnknownType):
        return UNKNOWN
    if not isinstance(owner, StructType):
        what = f"`{node.value.span.text}`"
        typer.context.refuse(
            NotIndexed(
                node.name.span, what=what, problem=f"is {noun(owner)} and has no fields", advice=None, declared=None
            ),
            node,
        )
        return UNKNOWN
    found = owner.field(node.name.text)
    if found is None:
        _refuse_member(typer, node, f"the struct `{owner.name}`", "field", [name for name, _ in owner.fields], None)
        return UNKNOWN
    program.members[node] = node.name.text
    return found


def index(typer: ExpressionTyper, node: ast.Index) -> Type:
    """The type of an element of an array."""
    owner = typer.infer(node.value)
    found = typer.infer(node.index)
    require(typer.context, node.index, found, INT, Purpose(what="an index"))
    if isinstance(owner, UnknownType):
        return UNKNOWN
    if not isinstance(owner, ArrayType):
        what = f"`{node.value.span.text}`"
        refused = NotIndexed(
            node.span, what=what, problem=f"is {noun(owner)} and has no elements", advice=None, declared=None
        )
        typer.context.refuse(refused, node)
        return UNKNOWN
    return owner.element


def _owner_symbol(typer: ExpressionTyper, value: ast.Expression) -> Symbol | None:
    """The enum or the instance that a member belongs to; None for values."""
    base = value
    while isinstance(base, ast.Index):
        base = base.value
    if not isinstance(base, ast.Name):
        return None
    symbol = typer.find(base.name)
    if isinstance(symbol, ast.Instance) or (isinstance(symbol, ast.EnumDefinition) and base is value):
        typer.context.program.bindings[base] = symbol
        return symbol
    return None


def _literal(typer: ExpressionTyper, node: ast.Member, enum: ast.EnumDefinition) -> Type:
    names = [literal.text for literal in enum.literals]
    if node.name.text not in names:
        _refuse_member(typer, node, f"the enum `{enum.name.text}`", "literal", names, enum.name)
        return UNKNOWN
    literal = EnumLiteralSymbol(definition=enum, index=names.index(node.name.text))
    typer.context.program.members[node] = literal
    typer.context.program.bindings[node.name] = literal
    return typer.context.program.types.get(enum, EnumType(enum.name.text, tuple(names)))


def _port_of(typer: ExpressionTyper, node: ast.Member, instance: ast.Instance) -> Type:
    """``pid.output`` in an equation."""
    program = typer.context.program
    for position in _indexes(node.value):
        typer.constant(position, INT, Purpose(what="an index"))
    definition = program.bindings.get(instance.definition)
    if not isinstance(definition, ast.SubmodelDefinition | ast.ProcessDefinition | ast.DriverDefinition):
        return UNKNOWN
    if typer.surroundings.place != "submodel":
        advice = f"connect it to a label and use that: `{node.span.text} -> value : type`"
        name = node.span.text
        typer.context.refuse(
            WrongKind(
                node.span, name=name, kind="a port of an instance", expected="a value", advice=advice, declared=None
            ),
            node,
        )
        return UNKNOWN
    ports = program.scopes[definition].ports
    port = ports.get(node.name.text)
    if port is None:
        outputs = [name for name, found in ports.items() if found.declaration.direction == "out"]
        owner = f"`{instance.name.text}`, an instance of `{instance.definition.text}`,"
        _refuse_member(typer, node, owner, "port", outputs, definition.name)
        return UNKNOWN
    program.members[node] = port
    program.bindings[node.name] = port
    if typer.surroundings.constant:
        found = NotConstant(node.span, name=node.span.text, kind=described(port), declared=declared_at(port))
        typer.context.refuse(found, node)
        return UNKNOWN
    return array_of_ports(typer.context, port)


def _refuse_member(
    typer: ExpressionTyper,
    node: ast.Member,
    owner: str,
    expected: str,
    options: list[str],
    declared: ast.Identifier | None,
) -> None:
    typer.context.refuse(
        UnknownMember(
            node.name.span,
            name=node.name.text,
            owner=owner,
            expected=expected,
            options=tuple(options),
            suggestion=typer.context.speller.nearest(node.name.text, options),
            declared=declared.span if declared else None,
        ),
        node,
    )


def array_of_ports(context: Context, port: PortSymbol) -> Type:
    """The type of a port; for an array of ports, an array type."""
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
