"""Names and types in the equations of submodels."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base import Report
from cspdiag.base.graphs import is_circular, strong_components
from cspdiag.model.context import Context, Surroundings
from cspdiag.model.diagnostics.names import UnknownName
from cspdiag.model.expressions.coercion import Purpose, agrees
from cspdiag.model.expressions.declared_types import declared_type
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.instances import resolve_instance
from cspdiag.model.names.references import end_of_channel
from cspdiag.model.names.scopes import declare, definition_text
from cspdiag.model.symbols import declared_at
from cspdiag.model.types import UNKNOWN, ArrayType, IntType, RealType, Type
from cspdiag.model.units import DIMENSIONLESS, SECOND, divide
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


def resolve_submodel(context: Context, definition: ast.SubmodelDefinition) -> None:
    """Bind every name of a submodel and type its equations, which may be in any order."""
    scope = context.program.scopes[definition]
    typer = Typer(context, Surroundings(place="submodel", owner=definition, scope=scope, replicators={}))
    where = definition_text(definition)
    for item in definition.items:
        if isinstance(item, ast.Let | ast.State | ast.Instance):
            declare(context, scope, item.name, item, where)
    scope.undeclared.update(_defined_names(definition) - scope.names.keys())
    for item in definition.items:
        match item:
            case ast.State():
                found = context.program.types[item] = declared_type(typer, item.type)
                typer.constant(item.initial, found, _purpose("state", item.name, item.type))
            case ast.Instance():
                resolve_instance(typer, item, (ast.SubmodelDefinition,), "a submodel")
            case ast.Let() | ast.Next() | ast.Derivative() | ast.Equation():
                pass
            case _:
                assert_never(item)
    _resolve_lets(typer, [item for item in definition.items if isinstance(item, ast.Let)])
    for item in definition.items:
        match item:
            case ast.Equation():
                expected = end_of_channel(typer, item.target, "output")
                what = f"`{item.target.span.text}`"
                symbol = context.program.members.get(item.target) or context.program.bindings.get(item.target)
                declared = declared_at(symbol) if symbol is not None and not isinstance(symbol, str) else None
                typer.require(item.value, expected, Purpose(what=what, declared=declared))
            case ast.Next():
                state = _bind_state(typer, item.name)
                expected = context.program.types.get(state, UNKNOWN) if state else UNKNOWN
                typer.require(item.value, expected, _state_purpose(f"`next {item.name.text}`", state))
            case ast.Derivative():
                _resolve_derivative(typer, item)
            case ast.Let() | ast.State() | ast.Instance():
                pass
            case _:
                assert_never(item)


def _defined_names(definition: ast.SubmodelDefinition) -> set[str]:
    """The names that equations define, declared or not."""
    names = set()
    for item in definition.items:
        match item:
            case ast.Equation(target=ast.Reference(member=None) as target):
                names.add(target.name.text)
            case ast.Next() | ast.Derivative():
                names.add(item.name.text)
            case ast.Let() | ast.State() | ast.Equation() | ast.Instance():
                pass
            case _:
                assert_never(item)
    return names


def _purpose(kind: str, name: ast.Identifier, type_name: ast.TypeName) -> Purpose:
    return Purpose(what=f"the {kind} `{name.text}`", declared=type_name.span, declared_text="its type")


def _state_purpose(what: str, state: ast.State | None) -> Purpose:
    return Purpose(what=what, declared=state.name.span if state else None, declared_text="the state is declared here")


def _bind_state(typer: Typer, name: ast.Identifier) -> ast.State | None:
    context, names = typer.context, typer.surroundings.scope.names
    symbol = names.get(name.text)
    if isinstance(symbol, ast.State):
        context.program.bindings[name] = symbol
        return symbol
    if symbol is not None:
        advice = f"declare it by `state {name.text} : double = 0`" if isinstance(symbol, ast.Let) else None
        context.refuse_kind(name.span, name.text, symbol, "a state", advice, name)
    elif not context.excuses_unknown_names:
        suggestion = context.speller.nearest(
            name.text, (other for other, found in names.items() if isinstance(found, ast.State))
        )
        declared = declared_at(names[suggestion]) if suggestion else None
        advice = f"declare it by `state {name.text} : double = 0`"
        missing = UnknownName(
            name.span, name=name.text, expected="state", suggestion=suggestion, declared=declared, advice=advice
        )
        context.refuse(missing, name)
    return None


def _resolve_derivative(typer: Typer, item: ast.Derivative) -> None:
    """Type ``der s``, which has the unit of ``s`` per second; for a state without a unit, a bare number is accepted."""
    state = _bind_state(typer, item.name)
    found = typer.context.program.types.get(state, UNKNOWN) if state else UNKNOWN
    value = typer.infer(item.value)
    element = _innermost(found)
    is_bare = agrees(value, found) or isinstance(_innermost(value), IntType)
    if not isinstance(element, RealType) or (element.unit == DIMENSIONLESS and is_bare):
        typer.require(item.value, found, _state_purpose(f"`der {item.name.text}`", state))
        return
    expected = _per_second(found)
    typer.require(item.value, expected, _state_purpose(f"`der {item.name.text}`", state))


def _innermost(found: Type) -> Type:
    return _innermost(found.element) if isinstance(found, ArrayType) else found


def _per_second(found: Type) -> Type:
    if isinstance(found, ArrayType):
        return ArrayType(_per_second(found.element), found.size)
    return RealType(found.bits, divide(found.unit, SECOND)) if isinstance(found, RealType) else found


def _resolve_lets(typer: Typer, lets: list[ast.Let]) -> None:
    """Type local values in the order of their dependencies.

    A cycle through an operator with memory is legal; its types are found by a first trial and then determined. (A cycle
    without memory is an algebraic loop, which is detected when equations are sorted.)
    """
    context, names = typer.context, typer.surroundings.scope.names
    needs: dict[ast.Let, list[ast.Let]] = {}
    for let in lets:
        used = [names.get(part.name) for part in nodes(let.value) if isinstance(part, ast.Name)]
        needs[let] = [symbol for symbol in used if isinstance(symbol, ast.Let)]
    types = context.program.types
    for component in strong_components(lets, needs.__getitem__):
        if is_circular(component, needs.__getitem__):
            _guess_types(context, typer, component)
        for let in component:
            types[let] = typer.infer(let.value)


def _guess_types(context: Context, typer: Typer, component: list[ast.Let]) -> None:
    report, poisoned = context.report, set(context.program.poisoned)
    context.report, context.guessing = Report(), True
    for _ in range(2):
        for let in component:
            context.program.types[let] = typer.infer(let.value)
    context.report, context.guessing = report, False
    context.program.poisoned.clear()
    context.program.poisoned.update(poisoned)
