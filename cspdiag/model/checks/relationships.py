"""Checks of relationships: the directions of their ends, and that all ends have the same type and unit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from cspdiag.base import Label, Report
from cspdiag.model.diagnostics.ports import DifferentEnds, MisusedName, WrongSink, WrongSource
from cspdiag.model.expressions.coercion import same
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Program
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import UNKNOWN, Type
from cspdiag.syntax import ast


def check_relationships(program: Program, report: Report) -> None:
    """Check every relationship of processes and environments."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition) and definition.communication is not None:
            _check_all(program, definition.communication.declarations, report, has_directions=True)
        elif isinstance(definition, ast.EnvironmentDefinition):
            # The directions in environments are checked when the environment is elaborated.
            _check_all(program, definition.declarations, report, has_directions=False)


def _check_all(
    program: Program, declarations: Iterable[ast.Declaration], report: Report, *, has_directions: bool
) -> None:
    pending = list(declarations)[::-1]
    while pending:
        item = pending.pop()
        match item:
            case ast.RepeatedDeclarations():
                pending += reversed(item.declarations)
            case ast.Connection():
                if has_directions:
                    _check_directions(program, item, report)
                _check_types(program, item, report)
            case ast.Instance() | ast.Variable() | ast.Channel():
                pass
            case _:
                assert_never(item)


def _check_directions(program: Program, connection: ast.Connection, report: Report) -> None:
    for source in connection.sources:
        wrong = _port_of_direction(program, source, own="out", inner="in")
        if wrong is not None:
            advice = _source_advice(program, connection, source, wrong)
            _refuse(program, report, WrongSource, connection, source, wrong, advice)
    if connection in program.poisoned:
        # Usually the whole arrow is the wrong way around.
        return
    for sink in connection.sinks:
        if not isinstance(sink, ast.Reference):
            continue
        wrong = _port_of_direction(program, sink, own="in", inner="out")
        if wrong is not None:
            _refuse(program, report, WrongSink, connection, sink, wrong, _sink_advice(sink, wrong))


def _refuse(
    program: Program,
    report: Report,
    misuse: type[MisusedName],
    connection: ast.Connection,
    end: ast.Reference,
    port: PortSymbol,
    advice: str,
) -> None:
    name, kind, declared = end.span.text, _kind(end, port), declared_at(port)
    report.add(misuse(end.span, name=name, kind=kind, advice=advice, declared=declared))
    program.poisoned.update((connection, end))


def _port_of_direction(program: Program, end: ast.Reference, *, own: str, inner: str) -> PortSymbol | None:
    """The port at an end, if it is one of this process with direction ``own`` or one of an instance with direction
    ``inner``.
    """
    if end in program.poisoned:
        return None
    member, symbol = program.members.get(end), program.bindings.get(end)
    if isinstance(member, PortSymbol):
        return member if member.declaration.direction == inner else None
    if isinstance(symbol, PortSymbol):
        return symbol if symbol.declaration.direction == own else None
    return None


def _kind(end: ast.Reference, port: PortSymbol) -> str:
    if end.member is not None:
        return f"{described(port)} of an instance"
    return f"{described(port)} of this process"


def _source_advice(program: Program, connection: ast.Connection, source: ast.Reference, port: PortSymbol) -> str:
    for sink in connection.sinks:
        if not isinstance(sink, ast.Reference):
            continue
        other = program.members.get(sink) or program.bindings.get(sink)
        expected = "in" if sink.member is None else "out"
        if isinstance(other, PortSymbol) and other.declaration.direction == expected:
            return f"turn the arrow around: `{sink.span.text} -> {source.span.text}`"
    if source.member is not None:
        return "an arrow begins at an out port of an instance or at an in port of this process"
    return f"begin at an out port of an instance, or declare `in {port.name} : {port.type}`"


def _sink_advice(sink: ast.Reference, port: PortSymbol) -> str:
    if sink.member is not None:
        return "an arrow ends at an in port of an instance or at an out port of this process"
    return f"end at an in port of an instance, or declare `out {port.name} : {port.type}`"


def _check_types(program: Program, connection: ast.Connection, report: Report) -> None:
    """Compare every end with the type of the label or, if that has none, with the first end."""
    ends = [*connection.sources, *(sink for sink in connection.sinks if isinstance(sink, ast.Reference))]
    known = [(end, program.types.get(end, UNKNOWN)) for end in ends if end not in program.poisoned]
    known = [(end, found) for end, found in known if found is not UNKNOWN]
    if connection.type is not None:
        expected = program.types.get(connection.type, UNKNOWN)
        name = connection.label.text if connection.label is not None else "the arrow"
        place = Label(connection.type.span, f"the arrow is declared to carry {expected}")
        reported: set[Type] = set()
        for end, found in known:
            if not same(found, expected) and found not in reported:
                reported.add(found)
                notes = (_declaration(program, end, found), place)
                report.add(_different(end, found, name, expected, notes))
        return
    if not known:
        return
    first, first_type = known[0]
    for end, found in known[1:]:
        if not same(found, first_type):
            notes = (_declaration(program, first, first_type), _declaration(program, end, found))
            report.add(_different(end, found, first.span.text, first_type, notes, turned=True))


def _different(
    end: ast.Reference,
    found: Type,
    other: str,
    other_type: Type,
    notes: tuple[Label, Label],
    *,
    turned: bool = False,
) -> DifferentEnds:
    if turned:
        return DifferentEnds(end.span, other, other_type, end.span.text, found, notes)
    return DifferentEnds(end.span, end.span.text, found, other, other_type, notes)


def _declaration(program: Program, end: ast.Reference, found: Type) -> Label:
    symbol = program.members.get(end) or program.bindings.get(end)
    place = end.span
    if isinstance(symbol, PortSymbol):
        place = symbol.declaration.span
    elif isinstance(symbol, ast.Variable | ast.Channel):
        place = symbol.span
    elif isinstance(symbol, EndLabelSymbol):
        place = symbol.connection.span
    return Label(place, f"`{end.span.text}` is declared as {found}")
