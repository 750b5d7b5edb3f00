"""Prints what the compiler has made from a text: its tree, or its resolved model."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base.record import field_names, is_record
from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.span import Span
from cspdiag.model.program import Program
from cspdiag.syntax import ast

_DETAILS = frozenset({"span", "unit_span", "target_span", "composition_span", "source", "inner_span", "parenthesized"})


def show_tree(tree: ast.SourceTree) -> str:
    """The syntax tree, with a node and its place on each line, indented by depth."""
    lines: list[str] = []
    pending: list[tuple[int, str, object]] = [(0, "", tree)]
    while pending:
        depth, name, value = pending.pop()
        head = f"{'  ' * depth}{name}"
        if isinstance(value, tuple):
            lines.append(f"{head}[]" if not value else head.rstrip())
            pending += [(depth + 1, "", element) for element in reversed(value)]
        elif is_record(value):
            simple, inner = _fields(value)
            lines.append(f"{head}{type(value).__name__}{simple} @{_place(value)}")
            pending += [(depth + 1, f"{field}: ", part) for field, part in reversed(inner)]
        else:
            lines.append(f"{head}{value!r}")
    return "\n".join(lines) + "\n"


def _fields(item: object) -> tuple[str, list[tuple[str, object]]]:
    simple = ""
    inner: list[tuple[str, object]] = []
    for name in field_names(item):
        value = getattr(item, name)
        if name in _DETAILS or value is None or value == ():
            continue
        if isinstance(value, tuple) or is_record(value):
            inner.append((name, value))
        else:
            simple += f" {name}={value!r}"
    return simple, inner


def _place(item: object) -> str:
    span = getattr(item, "span", None)
    return f"{span.line}:{span.column}" if isinstance(span, Span) else ""


def show_model(program: Program) -> str:
    """The definitions with the types and values that names and expressions were found to have."""
    lines: list[str] = []
    for tree in program.trees:
        lines.append(f"file {on_one_line(tree.source.name)}")
        for definition in program.definitions.values():
            if definition.span.source is tree.source:
                lines += [f"  {line}" for line in _definition(program, definition)]
    lines += [f"assert {assertion.process.text} {assertion.property}" for assertion in program.assertions]
    return "\n".join(lines) + "\n"


def _definition(program: Program, definition: ast.Definition) -> Iterator[str]:
    kind = type(definition).__name__.removesuffix("Definition").lower()
    name = definition.name.text
    if isinstance(definition, ast.Constant):
        value = program.constants.get(definition, program.tunable.get(definition, "?"))
        kind = "parameter" if definition.tunable else "constant"
        yield f"{kind} {name} : {program.types.get(definition, '?')} = {value}"
        return
    yield f"{kind} {name}"
    for parameter in getattr(definition, "parameters", ()):
        yield f"  parameter {parameter.name.text} : {program.types.get(parameter, '?')}"
    scope = program.scopes.get(definition)
    if scope is None:
        return
    for port in scope.ports.values():
        yield f"  {port.declaration.direction} {port.name} : {port.type}"
    for local, symbol in scope.names.items():
        if isinstance(symbol, ast.Instance):
            yield f"  {local} : {symbol.definition.text}"
        elif isinstance(symbol, ast.Variable | ast.Channel | ast.State | ast.Let):
            yield f"  {type(symbol).__name__.lower()} {local} : {program.types.get(symbol, '?')}"
