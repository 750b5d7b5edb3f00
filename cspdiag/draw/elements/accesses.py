"""Reads and writes of a process itself: ``?``, ``!`` and the guards of its composition."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.draw.elements import texts
from cspdiag.model.program import EndLabelSymbol, Program
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes


@record(kw_only=True)
class Access:
    """One communication of the process itself with ``channel``, or with an element of it, ``[i + 1]``.

    ``stores`` are the variables that receive or supply the value; a write is ``is_plain`` if it writes (a part of) a
    variable unchanged. ``text`` is the written expression.
    """

    channel: str
    index: str
    is_write: bool
    stores: tuple[str, ...]
    is_plain: bool = True
    text: str = ""
    span: Span


def accesses(program: Program, composition: ast.Composition) -> Iterator[Access]:
    """Every communication of a composition, in text order."""
    for item in nodes(composition):
        match item:
            case ast.Read(channel=channel, target=target) | ast.InputGuard(channel=channel, target=target):
                yield Access(
                    channel=channel.name.text,
                    index=texts.indexes(channel.indexes),
                    is_write=False,
                    stores=(target.name.text,),
                    span=item.span,
                )
            case ast.Write(channel=channel, value=value) | ast.OutputGuard(channel=channel, value=value):
                plain = _variable(program, value)
                stores = (plain,) if plain is not None else _variables(program, value)
                yield Access(
                    channel=channel.name.text,
                    index=texts.indexes(channel.indexes),
                    is_write=True,
                    stores=stores,
                    is_plain=plain is not None,
                    text=texts.written(value),
                    span=item.span,
                )
            case _:  # Any other node of the composition communicates nothing.
                pass


def _variable(program: Program, value: ast.Expression) -> str | None:
    """The variable that the expression is, or is an element or a field of."""
    while isinstance(value, ast.Member | ast.Index):
        value = value.value
    return value.name if isinstance(value, ast.Name) and _is_store(program, value) else None


def _variables(program: Program, value: ast.Expression) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name.name for name in names((value,)) if _is_store(program, name)))


def _is_store(program: Program, name: ast.Name) -> bool:
    match program.bindings.get(name):
        case ast.Variable():
            return True
        case EndLabelSymbol(ends_arrow=ends_arrow):
            return ends_arrow
        case _:  # Other names have a value, but no place in the diagram.
            return False
