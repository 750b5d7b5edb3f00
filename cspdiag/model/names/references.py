"""References to ports, instances, variables and channels: ``feedback``, ``cell[i]``, ``servo.control``."""

from __future__ import annotations

from cspdiag.model.diagnostics.names import UnknownMember, UnknownName
from cspdiag.model.diagnostics.types import NotIndexed
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.members import array_of_ports
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.fields import refuse_part
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Scope, Symbol
from cspdiag.model.symbols import declared_at
from cspdiag.model.types import INT, UNKNOWN, ArrayType, Type
from cspdiag.model.wording import noun
from cspdiag.syntax import ast


def find(typer: Typer, reference: ast.Reference, wanted: str, kinds: tuple[type, ...]) -> Symbol | None:
    """Bind the first name of a reference; None, and reported, if it is unknown.

    ``wanted`` and ``kinds`` are what would fit, for the name that was probably meant.
    """
    context, name = typer.context, reference.name.text
    symbol = typer.surroundings.scope.names.get(name) or typer.surroundings.replicators.get(name)
    if symbol is None:
        context.program.poisoned.add(reference)
        definition = context.program.definitions.get(name)
        if definition is not None:
            refuse_kind(typer, reference, definition, wanted)
        elif not (context.excuses_unknown_names or _excused(typer.surroundings.scope, name, wanted)):
            names = typer.surroundings.scope.names
            suggestion = context.speller.nearest(
                name, (other for other, found in names.items() if isinstance(found, kinds))
            )
            if suggestion is None and wanted == "instance":
                suggestion = context.speller.nearest(name, ("skip", "stop"))
            if suggestion is None:
                typer.surroundings.scope.undeclared.add(name)
            declared = declared_at(names[suggestion]) if suggestion in names else None
            missing = UnknownName(
                reference.name.span,
                name=name,
                wanted=wanted,
                suggestion=suggestion,
                declared=declared,
                advice=_advice_on_missing(name, wanted),
            )
            context.refuse(missing, reference)
        return None
    context.program.bindings[reference] = symbol
    return symbol


def _excused(scope: Scope, name: str, wanted: str) -> bool:
    return scope.incomplete or (wanted != "output" and name in scope.undeclared)


def _advice_on_missing(name: str, wanted: str) -> str | None:
    return {
        "sink": f"a label that ends an arrow has a type: `{name} : type`",
        "variable": f"declare it in the communication block: `var {name} : type`",
        "instance": f"declare it in the communication block: `{name} : Definition`",
        "output": f"declare `out {name} : type`, or write `let {name} = ...` for a local value",
    }.get(wanted)


def _advice_on_kind(name: str, symbol: Symbol, wanted: str) -> str | None:
    match symbol:
        case ast.ProcessDefinition() | ast.SubmodelDefinition():
            instance = f"{name[:1].lower()}{name[1:]}"
            return f"declare an instance in the communication block, such as `{instance} : {name}`, and name that"
        case ast.State() if wanted == "output":
            return f"write `next {name} = ...` or `der {name} = ...`"
        case ast.Let() if wanted == "output":
            return "its `let` is its equation"
        case ast.Parameter() | ast.Constant() if wanted in {"variable", "source", "sink"}:
            return f"its value never changes; declare a variable that begins with it: `var value : type = {name}`"
        case _:  # No advice would help.
            return None


def refuse_kind(typer: Typer, reference: ast.Reference, symbol: Symbol, wanted: str, advice: str | None = None) -> None:
    """Report that a reference names another kind of thing than is wanted."""
    name = reference.name.text
    article = "an" if wanted[0] in "aeiou" else "a"
    span = reference.span if reference.member is None else reference.name.span
    advice = advice or _advice_on_kind(name, symbol, wanted)
    typer.context.refuse_kind(span, name, symbol, f"{article} {wanted}", advice, reference)


def end_of_channel(typer: Typer, reference: ast.Reference, wanted: str) -> Type:
    """The type of what passes a port, a port of an instance, a channel, a variable or a label.

    Recorded in ``types``; ``members`` has the port of an instance. UNKNOWN, and reported, for anything else.
    """
    kinds = (PortSymbol, ast.Instance, ast.Variable, ast.Channel, EndLabelSymbol)
    symbol = find(typer, reference, wanted, kinds if reference.member is None else (ast.Instance,))
    found: Type = UNKNOWN
    _type_indexes(typer, reference)
    if reference.member is not None:
        match symbol:
            case ast.Instance():
                found = _port_of(typer, reference, symbol)
            case PortSymbol() | ast.Variable() | ast.Channel() | EndLabelSymbol():
                whole = _indexed(typer, reference, reference.indexes, _carried(typer, symbol))
                if whole is UNKNOWN:
                    typer.context.program.poisoned.add(reference)
                else:
                    refuse_part(typer, reference, symbol, whole, wanted)
            case None:
                pass
            case _:  # Nothing else has parts that diagrams name.
                refuse_kind(typer, reference, symbol, "instance")
    else:
        match symbol:
            case PortSymbol() | ast.Variable() | ast.Channel() | EndLabelSymbol():
                found = _indexed(typer, reference, reference.indexes, _carried(typer, symbol))
            case None:
                pass
            case ast.Instance():
                ports = typer.context.program.bindings.get(symbol.definition)
                advice = _port_advice(typer, reference, ports)
                refuse_kind(typer, reference, symbol, wanted, advice)
            case _:  # Nothing else is read, written or connected.
                refuse_kind(typer, reference, symbol, wanted)
    typer.context.program.types[reference] = found
    return found


def _carried(typer: Typer, symbol: PortSymbol | ast.Variable | ast.Channel | EndLabelSymbol) -> Type:
    """The type of what a port, a variable, a channel or a label has, all elements of an array together."""
    match symbol:
        case PortSymbol():
            return array_of_ports(typer.context, symbol)
        case EndLabelSymbol():
            return symbol.type
        case _:  # What is declared with its type.
            return typer.context.program.types.get(symbol, UNKNOWN)


def _port_advice(typer: Typer, reference: ast.Reference, definition: Symbol | None) -> str | None:
    scope = typer.context.program.scopes.get(definition) if isinstance(definition, ast.Node) else None
    if not scope or not scope.ports:
        return None
    return "name one of its ports: " + ", ".join(f"`{reference.span.text}.{name}`" for name in list(scope.ports)[:4])


def _type_indexes(typer: Typer, reference: ast.Reference) -> None:
    for index in (*reference.indexes, *reference.member_indexes):
        # Which port or instance is meant is fixed when the diagram is expanded; an element of a variable is not.
        symbol = typer.context.program.bindings.get(reference)
        if isinstance(symbol, ast.Variable | EndLabelSymbol):
            typer.require(index, INT, Purpose(what="an index"))
        else:
            typer.constant(index, INT, Purpose(what="an index"))


def _port_of(typer: Typer, reference: ast.Reference, instance: ast.Instance) -> Type:
    program = typer.context.program
    member = reference.member
    assert member is not None
    check_instance_index(typer, reference, instance)
    scope = ports_of(typer, instance)
    if scope is None:
        program.poisoned.add(reference)
        return UNKNOWN
    port = scope.ports.get(member.text)
    if port is None:
        definition = program.bindings[instance.definition]
        refused = UnknownMember(
            member.span,
            name=member.text,
            owner=f"`{instance.name.text}`, an instance of `{instance.definition.text}`,",
            wanted="port",
            options=tuple(scope.ports),
            suggestion=typer.context.speller.nearest(member.text, scope.ports),
            declared=declared_at(definition),
        )
        typer.context.refuse(refused, reference)
        return UNKNOWN
    program.members[reference] = port
    program.bindings[member] = port
    return _indexed(typer, reference, reference.member_indexes, array_of_ports(typer.context, port))


def ports_of(typer: Typer, instance: ast.Instance) -> Scope | None:
    """The ports of what an instance is made of; None where that is unknown or poisoned."""
    program = typer.context.program
    definition = program.bindings.get(instance.definition)
    return program.scopes.get(definition) if isinstance(definition, ast.Node) else None


def check_instance_index(typer: Typer, reference: ast.Reference, instance: ast.Instance) -> None:
    """An array of instances is named with one index, a single instance without."""
    given, wanted = len(reference.indexes), 0 if instance.size is None else 1
    if instance in typer.context.repeated or given == wanted:
        return
    name = instance.name.text
    if wanted:
        problem, advice = "is an array of instances and needs one index", f"write `{name}[0]`, `{name}[1]`, …"
    else:
        problem, advice = "is a single instance and takes no index", f"declare an array by `{name}[n] : …`"
    refused = NotIndexed(
        reference.name.span, what=f"`{name}`", problem=problem, advice=advice, declared=instance.name.span
    )
    typer.context.refuse(refused, reference)


def _indexed(typer: Typer, reference: ast.Reference, indexes: tuple[ast.Expression, ...], found: Type) -> Type:
    for index in indexes:
        if found is UNKNOWN:
            return UNKNOWN
        if not isinstance(found, ArrayType):
            name = reference.span.text.removesuffix(f"[{index.span.text}]")
            symbol = typer.context.program.bindings.get(reference)
            refused = NotIndexed(
                index.span,
                what=f"`{name}`",
                problem=f"is {noun(found)} and has no elements",
                advice=None,
                declared=declared_at(symbol) if symbol is not None else None,
            )
            typer.context.refuse(refused, reference)
            return UNKNOWN
        found = found.element
    return found
