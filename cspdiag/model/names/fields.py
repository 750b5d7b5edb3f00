"""Diagnostics of fields of structs where only whole values are allowed."""

from __future__ import annotations

from cspdiag.model.diagnostics.fields import PartByItself
from cspdiag.model.diagnostics.names import UnknownMember
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.program import PortSymbol, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import StructType, Type
from cspdiag.syntax import ast

_MOST_FIELDS = 6


def refuse_part(typer: Typer, reference: ast.Reference, symbol: Symbol, whole: Type, wanted: str) -> None:
    """Report a reference to a field of what is not an instance: a variable, a port, a channel, a label.

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
                wanted="field",
                options=tuple(fields),
                suggestion=context.speller.nearest(member, fields),
                declared=declared_at(symbol),
            )
            context.refuse(unknown, reference)
            return
        kind = described(symbol).split(" ", 1)[1]
        problem = f"is a field of the {kind} `{owner}`, {_rule(wanted)}"
        advice = _advice(owner, symbol, whole, member, wanted)
    else:
        problem = f"cannot be: `{owner}` is {described(symbol)} of type {whole}, which has no fields"
        advice = f"name it as a whole: `{owner}`"
    refused = PartByItself(
        reference.span,
        name=name,
        problem=problem,
        advice=advice,
        declared=declared_at(symbol),
        whole=reference.name.text,
    )
    context.refuse(refused, reference)


def _rule(wanted: str) -> str:
    if wanted in {"variable", "output"}:
        return "which is set as a whole"
    return "through which the struct passes as a whole" if wanted == "port" else "which is connected as a whole"


def _advice(owner: str, symbol: Symbol, whole: StructType, changed: str, wanted: str) -> str:
    is_port = isinstance(symbol, PortSymbol)
    if isinstance(symbol, PortSymbol) and symbol.declaration.direction == "in":
        return f"read it into a variable, `{owner} ? value`, and use `value.{changed}`"
    built = _built(whole, changed, "..." if is_port or isinstance(symbol, ast.Channel) else f"{owner}.")
    if wanted == "output":
        return f"write `{owner} = {built}`"
    if wanted in {"source", "sink"}:
        return "connect the whole struct; a submodel can take it apart or put it together"
    if is_port or isinstance(symbol, ast.Channel):
        return f"write `{owner} ! {built}`"
    return f"write `{owner} := {built}`"


def _built(whole: StructType, changed: str, others: str) -> str:
    """The struct with one field new; the others as they are in ``others``, or given as well if that is not a place."""
    names = [field for field, _ in whole.fields]
    shown = names if len(names) <= _MOST_FIELDS else [changed]
    kept = [f"{name} = {'...' if name == changed or others == '...' else f'{others}{name}'}" for name in shown]
    return f"{whole.name}({', '.join(kept)}{', ...' if len(shown) < len(names) else ''})"
