"""References to fields of structs where only whole structs are allowed."""

from __future__ import annotations

from cspdiag.model.diagnostics.fields import PartOfStruct
from cspdiag.model.diagnostics.names import UnknownMember
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.program import PortSymbol, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import StructType, Type
from cspdiag.syntax import ast

_MOST_FIELDS = 6


def refuse_part(typer: Typer, reference: ast.Reference, symbol: Symbol, whole: Type, expected: str) -> None:
    """Report a reference to a field of something other than an instance: a variable, a port, a channel or a label.

    ``whole`` is its type.
    """
    assert reference.member is not None
    context, member = typer.context, reference.member.text
    name = reference.span.text
    owner = name[: reference.member.span.start - reference.span.start].rstrip().removesuffix(".").rstrip()
    if isinstance(whole, StructType):
        fields = [field for field, _ in whole.fields]
        if member not in fields:
            unknown = UnknownMember(
                reference.member.span,
                name=member,
                owner=f"`{owner}`, a {whole.name},",
                expected="field",
                options=tuple(fields),
                suggestion=context.speller.nearest(member, fields),
                declared=declared_at(symbol),
            )
            context.refuse(unknown, reference)
            return
        kind = described(symbol).split(" ", 1)[1]
        problem = f"is a field of the {kind} `{owner}`, {_rule(expected)}"
        advice = _advice(owner, symbol, whole, member, expected)
    else:
        problem = f"cannot be: `{owner}` is {described(symbol)} of type {whole}, which has no fields"
        advice = f"name it as a whole: `{owner}`"
    refused = PartOfStruct(
        reference.span,
        name=name,
        problem=problem,
        advice=advice,
        declared=declared_at(symbol),
        whole=reference.name.text,
    )
    context.refuse(refused, reference)


def _rule(expected: str) -> str:
    if expected in {"variable", "output"}:
        return "which is set as a whole"
    return "through which the struct passes as a whole" if expected == "port" else "which is connected as a whole"


def _advice(owner: str, symbol: Symbol, whole: StructType, changed: str, expected: str) -> str:
    is_port = isinstance(symbol, PortSymbol)
    if isinstance(symbol, PortSymbol) and symbol.declaration.direction == "in":
        return f"read it into a variable, `{owner} ? value`, and use `value.{changed}`"
    built = _built(whole, changed, "..." if is_port or isinstance(symbol, ast.Channel) else f"{owner}.")
    if expected == "output":
        return f"write `{owner} = {built}`"
    if expected in {"source", "sink"}:
        return "connect the whole struct; a submodel can take it apart or put it together"
    if is_port or isinstance(symbol, ast.Channel):
        return f"write `{owner} ! {built}`"
    return f"write `{owner} := {built}`"


def _built(whole: StructType, changed: str, others: str) -> str:
    """The text of a struct with one new field; the other fields are those of ``others``, if that is a variable."""
    names = [field for field, _ in whole.fields]
    shown = names if len(names) <= _MOST_FIELDS else [changed]
    kept = [f"{name} = {'...' if name == changed or others == '...' else f'{others}{name}'}" for name in shown]
    return f"{whole.name}({', '.join(kept)}{', ...' if len(shown) < len(names) else ''})"
