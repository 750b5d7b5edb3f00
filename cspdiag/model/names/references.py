"""References to ports, instances, variables and channels: ``feedback``, ``cell[i]``, ``servo.control``."""

from __future__ import annotations

from cspdiag.model.diagnostics.names import UnknownMember, UnknownName
from cspdiag.model.diagnostics.types import NotIndexed
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.members import array_of_ports
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.described import lacks_description
from cspdiag.model.names.fields import refuse_part
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Scope, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import INT, UNKNOWN, ArrayType, Type
from cspdiag.model.wording import noun
from cspdiag.syntax import ast


def find(typer: Typer, reference: ast.Reference, expected: str, kinds: tuple[type, ...]) -> Symbol | None:
    """Bind the first name of a reference; an unknown name is reported and gives None.

    ``expected`` and ``kinds`` are the kinds of things that are allowed, for the suggestion of a similar name.
    """
    context, name = typer.context, reference.name.text
    symbol = typer.surroundings.scope.names.get(name) or typer.surroundings.replicators.get(name)
    if symbol is None:
        context.program.poisoned.add(reference)
        definition = context.program.definitions.get(name)
        if definition is not None:
            refuse_kind(typer, reference, definition, expected)
        elif not (context.excuses_unknown_names or _is_excused(typer.surroundings.scope, name, expected)):
            names = typer.surroundings.scope.names
            suggestion = context.speller.nearest(
                name, (other for other, found in names.items() if isinstance(found, kinds))
            )
            if suggestion is None and expected == "instance":
                suggestion = context.speller.nearest(name, ("skip", "stop"))
            if suggestion is None:
                typer.surroundings.scope.undeclared.add(name)
            declared = declared_at(names[suggestion]) if suggestion in names else None
            missing = UnknownName(
                reference.name.span,
                name=name,
                expected=expected,
                suggestion=suggestion,
                declared=declared,
                advice=_advice_on_missing(name, expected),
            )
            context.refuse(missing, reference)
        return None
    context.program.bindings[reference] = symbol
    return symbol


def _is_excused(scope: Scope, name: str, expected: str) -> bool:
    return scope.incomplete or (expected != "output" and name in scope.undeclared)


def _advice_on_missing(name: str, expected: str) -> str | None:
    return {
        "sink": f"a label that ends an arrow has a type: `{name} : type`",
        "variable": f"declare it in the communication block: `var {name} : type`",
        "instance": f"declare it in the communication block: `{name} : Definition`",
        "output": f"declare `out {name} : type`, or write `let {name} = ...` for a local value",
    }.get(expected)


def _advice_on_kind(name: str, symbol: Symbol, expected: str) -> str | None:
    match symbol:
        case ast.ProcessDefinition() | ast.SubmodelDefinition():
            instance = f"{name[:1].lower()}{name[1:]}"
            return f"declare an instance in the communication block, such as `{instance} : {name}`, and name that"
        case ast.State() if expected == "output":
            return f"write `next {name} = ...` or `der {name} = ...`"
        case ast.Let() if expected == "output":
            return "its `let` is its equation"
        case ast.Parameter() | ast.Constant() if expected in {"variable", "source", "sink"}:
            return f"its value never changes; declare a variable that begins with it: `var value : type = {name}`"
        case _:  # There is no useful advice.
            return None


def refuse_kind(
    typer: Typer, reference: ast.Reference, symbol: Symbol, expected: str, advice: str | None = None
) -> None:
    """Report that a reference names a different kind of thing than expected."""
    name = reference.name.text
    article = "an" if expected[0] in "aeiou" else "a"
    span = reference.span if reference.member is None else reference.name.span
    advice = advice or _advice_on_kind(name, symbol, expected)
    typer.context.refuse_kind(span, name, symbol, f"{article} {expected}", advice, reference)


_CONNECTED = frozenset(("source", "sink", "port"))
"""What is expected where values pass as a whole."""


def end_of_channel(typer: Typer, reference: ast.Reference, expected: str) -> Type:
    """The type of the values that pass a port, a port of an instance, a channel, a variable or a label.

    It is recorded in ``types``, and the port of an instance in ``members``. Anything else is reported, and UNKNOWN.
    """
    kinds = (PortSymbol, ast.Instance, ast.Variable, ast.Channel, EndLabelSymbol)
    symbol = find(typer, reference, expected, kinds if reference.member is None else (ast.Instance,))
    found: Type = UNKNOWN
    _type_indexes(typer, reference)
    if reference.member is not None:
        match symbol:
            case ast.Instance():
                found = _port_of(typer, reference, symbol, expected)
            case PortSymbol() | ast.Variable() | ast.Channel() | EndLabelSymbol():
                whole = _indexed(typer, reference, reference.indexes, _carried(typer, symbol))
                if whole is UNKNOWN:
                    typer.context.program.poisoned.add(reference)
                else:
                    refuse_part(typer, reference, symbol, whole, expected)
            case None:
                pass
            case _:  # Nothing else has members that diagrams refer to.
                refuse_kind(typer, reference, symbol, "instance")
    else:
        match symbol:
            case PortSymbol() | ast.Variable() | ast.Channel() | EndLabelSymbol():
                found = _indexed(typer, reference, reference.indexes, _carried(typer, symbol))
                if expected in _CONNECTED:
                    found = _as_a_whole(typer, reference, reference.indexes, symbol, found, expected)
            case None:
                pass
            case ast.Instance():
                ports = typer.context.program.bindings.get(symbol.definition)
                advice = _port_advice(typer, reference, ports)
                refuse_kind(typer, reference, symbol, expected, advice)
            case _:  # Nothing else can be read, written or connected.
                refuse_kind(typer, reference, symbol, expected)
    typer.context.program.types[reference] = found
    return found


def _carried(typer: Typer, symbol: PortSymbol | ast.Variable | ast.Channel | EndLabelSymbol) -> Type:
    """The type of a port, a variable, a channel or a label, as a whole if it is an array."""
    match symbol:
        case PortSymbol():
            return array_of_ports(typer.context, symbol)
        case EndLabelSymbol():
            return symbol.type
        case _:  # Other declarations, with a type of their own.
            return typer.context.program.types.get(symbol, UNKNOWN)


def _port_advice(typer: Typer, reference: ast.Reference, definition: Symbol | None) -> str | None:
    scope = typer.context.program.scopes.get(definition) if isinstance(definition, ast.Node) else None
    if not scope or not scope.ports:
        return None
    return "name one of its ports: " + ", ".join(f"`{reference.span.text}.{name}`" for name in list(scope.ports)[:4])


def _type_indexes(typer: Typer, reference: ast.Reference) -> None:
    for index in (*reference.indexes, *reference.member_indexes):
        # The index of a port or an instance must be known when the diagram is expanded, that of a variable need not be.
        symbol = typer.context.program.bindings.get(reference)
        if isinstance(symbol, ast.Variable | EndLabelSymbol):
            typer.require(index, INT, Purpose(what="an index"))
        else:
            typer.constant(index, INT, Purpose(what="an index"))


def _port_of(typer: Typer, reference: ast.Reference, instance: ast.Instance, expected: str) -> Type:
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
            expected="port",
            options=tuple(scope.ports),
            suggestion=typer.context.speller.nearest(member.text, scope.ports),
            declared=declared_at(definition),
        )
        typer.context.refuse(refused, reference)
        return UNKNOWN
    program.members[reference] = port
    program.bindings[member] = port
    found = _indexed(typer, reference, reference.member_indexes, array_of_ports(typer.context, port))
    return _as_a_whole(typer, reference, reference.member_indexes, port, found, expected)


def ports_of(typer: Typer, instance: ast.Instance) -> Scope | None:
    """The ports of the definition of an instance; None if they are unknown, because that is unknown or poisoned, or is
    an FMU that cannot be read.
    """
    program = typer.context.program
    definition = program.bindings.get(instance.definition)
    if not isinstance(definition, ast.Node) or lacks_description(definition):
        return None
    return program.scopes.get(definition)


def check_instance_index(typer: Typer, reference: ast.Reference, instance: ast.Instance) -> None:
    """Check that an array of instances is used with one index, and a single instance without."""
    given, expected = len(reference.indexes), 0 if instance.size is None else 1
    if instance in typer.context.repeated or given == expected:
        return
    name = instance.name.text
    if expected:
        problem, advice = "is an array of instances and needs one index", f"write `{name}[0]`, `{name}[1]`, …"
    else:
        problem, advice = "is a single instance and takes no index", f"declare an array by `{name}[n] : …`"
    refused = NotIndexed(
        reference.name.span, what=f"`{name}`", problem=problem, advice=advice, declared=instance.name.span
    )
    typer.context.refuse(refused, reference)


def _as_a_whole(
    typer: Typer,
    reference: ast.Reference,
    indexes: tuple[ast.Expression, ...],
    symbol: PortSymbol | ast.Variable | ast.Channel | EndLabelSymbol,
    found: Type,
    expected: str,
) -> Type:
    """``found`` if the indexes choose one of several ports, not an element of the values that pass it."""
    ports = symbol.port.dimensions if isinstance(symbol, PortSymbol) else ()
    if found is UNKNOWN or len(indexes) <= len(ports):
        return found
    index = indexes[len(ports)]
    name = reference.span.text[: index.span.start - reference.span.start].rstrip().removesuffix("[").rstrip()
    if isinstance(symbol, PortSymbol):
        problem = "is one port, through which an array passes as a whole"
        own = name.rpartition(".")[2]
        if ports:
            advice = f"write `{name}`"
        elif expected == "port":
            advice = f"write `{name}`, with a variable or a value that is the whole array"
        else:
            advice = f"write `{name}`; to connect elements, declare an array of ports: `{own}[n] : …` of single values"
    else:
        problem = f"is {described(symbol)}, which is connected as a whole"
        advice = f"write `{name}`, and choose the element where it is used"
    refused = NotIndexed(index.span, what=f"`{name}`", problem=problem, advice=advice, declared=declared_at(symbol))
    typer.context.refuse(refused, reference)
    return UNKNOWN


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
