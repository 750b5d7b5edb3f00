"""The parts of definitions whose changes are changes of the diagram."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import assert_never

from cspdiag.draw.communication.tooltips import WORDS
from cspdiag.draw.differences.change import DefinitionPart, Parts
from cspdiag.draw.elements import texts
from cspdiag.draw.elements.diagram import (
    Arrow,
    Box,
    CommunicationDiagram,
    FlowKind,
    ParentPort,
    Sink,
    Store,
    WrittenValue,
)
from cspdiag.syntax import ast

KINDS: dict[type[ast.Node], str] = {
    ast.Constant: "const",
    ast.TypeAliasDefinition: "type",
    ast.EnumDefinition: "enum",
    ast.StructDefinition: "struct",
    ast.ExceptionDefinition: "exception",
    ast.SubmodelDefinition: "submodel",
    ast.ProcessDefinition: "process",
    ast.DriverDefinition: "driver",
    ast.EnvironmentDefinition: "environment",
}
"""The names of the kinds of definitions, in the order in which changes are reported."""


def kind_of(definition: ast.Definition) -> str:
    """The name of the kind of a definition."""
    return "parameter" if isinstance(definition, ast.Constant) and definition.tunable else KINDS[type(definition)]


def definition_parts(definition: ast.Definition) -> Parts:
    """The parts of a definition that are not elements of a diagram."""
    parts: Parts = {}
    match definition:
        case ast.Constant():
            _add(
                parts,
                "",
                "",
                definition,
                {
                    "changes": "while the program runs" if definition.tunable else "never",
                    "type": texts.optional(definition.type),
                    "value": texts.written(definition.value),
                },
            )
        case ast.TypeAliasDefinition():
            _add(parts, "", "", definition, {"type": texts.written(definition.type)})
        case ast.EnumDefinition():
            _add(parts, "", "", definition, {"literals": ", ".join(item.text for item in definition.literals)})
        case ast.StructDefinition():
            for field in definition.fields:
                _add(parts, "field", field.name.text, field, {"type": texts.written(field.type)})
        case ast.ExceptionDefinition():
            pass
        case ast.EnvironmentDefinition():
            clauses = {
                "process": definition.process.text,
                "arguments": ", ".join(texts.arguments(definition.arguments)),
                "step": texts.optional(definition.step),
                "on miss": definition.on_miss.text if definition.on_miss else None,
                "places": ", ".join(
                    f"{place.name.text}: {' '.join(item.text for item in place.instances)}"
                    for place in definition.places
                )
                or None,
            }
            _add(parts, "", "", definition, clauses)
        case ast.ProcessDefinition():
            _add(
                parts, "", "", definition, {"body": _body(definition.external), "wcet": texts.optional(definition.wcet)}
            )
            _add_parameters(parts, definition.parameters)
        case ast.SubmodelDefinition():
            clauses = {
                "body": _body(definition.external),
                "wcet": texts.optional(definition.wcet),
                "step": texts.optional(definition.step),
                "method": definition.method.text if definition.method else None,
            }
            _add(parts, "", "", definition, clauses)
            _add_parameters(parts, definition.parameters)
            _add_ports(parts, definition.ports)
            _add_items(parts, definition.items)
        case ast.DriverDefinition():
            _add(parts, "", "", definition, {"body": _body(definition.external)})
            _add_parameters(parts, definition.parameters)
            _add_ports(parts, definition.ports)
    return parts


def diagram_parts(diagram: CommunicationDiagram, parameters: Mapping[str, tuple[str, ...]]) -> Parts:
    """The elements of a communication diagram that the text declares; ``parameters`` are the names of the parameters of
    each definition.
    """
    parts: Parts = {}
    own = {parameter.partition(":")[0].strip() for parameter in diagram.parameters}
    for vertex in diagram.vertices:
        place = vertex.spans[0] if vertex.spans else None
        match vertex:
            case ParentPort():
                aspects = _port_aspects(vertex, own)
                text = f"{vertex.direction} {vertex.key}{vertex.size or ''} : {vertex.type}"
                text += f" @ {vertex.period}" if vertex.period else ""
                parts["port", vertex.key] = DefinitionPart(text, aspects, vertex.key, place)
            case Box() if vertex.key != diagram.environment_of:
                arguments = _by_parameter(vertex, parameters.get(vertex.definition, ()))
                aspects = {"definition": vertex.definition, "size": vertex.size or "", **arguments}
                size = f"[{vertex.size}]" if vertex.size else ""
                written = f"({', '.join(vertex.arguments)})" if vertex.arguments else ""
                text = f"{vertex.key}{size} : {vertex.definition}{written}"
                parts["instance", vertex.key] = DefinitionPart(text, aspects, vertex.key, place)
            case Store():
                requested = " ".join(part for part in (vertex.requested, vertex.capacity) if part)
                aspects = {"type": vertex.type, "initial value": vertex.initial or "", "kind": requested}
                initial = f" = {vertex.initial}" if vertex.initial else ""
                subject = "channel" if vertex.form == "channel" else "variable"
                parts[subject, vertex.key] = DefinitionPart(
                    f"{vertex.key} : {vertex.type}{initial}", aspects, vertex.key, place
                )
            case Box() | WrittenValue() | Sink():
                pass
            case _:
                assert_never(vertex)
    for arrow in diagram.arrows:
        if not arrow.by_composition:
            parts["connection", arrow.key] = _arrow_part(arrow)
    return parts


def _arrow_part(arrow: Arrow) -> DefinitionPart:
    sources, sinks = (", ".join(_end(str(end)) for end in ends) for ends in (arrow.sources, arrow.sinks))
    requested = " ".join(part for part in (arrow.requested, arrow.capacity) if part)
    medium = (
        f"{arrow.label or ''}{f' : {arrow.type}' if arrow.type else ''}{f' {requested}' if requested else ''}".strip()
    )
    repeated = ", ".join(arrow.repeated)
    text = f"{sources} -> {f'{medium} -> ' if medium else ''}{sinks}{f' for {repeated}' if repeated else ''}"
    aspects = {
        "label": arrow.label or "",
        "from": sources,
        "to": sinks,
        "type": arrow.type or "",
        "kind": requested,
        "inferred kind": _words(arrow.kinds) if not requested else "",
        "replicator": repeated,
    }
    return DefinitionPart(text, aspects, arrow.key, arrow.spans[0] if arrow.spans else None)


def _end(name: str) -> str:
    return "_" if name.endswith(" -> _") else name


def _words(kinds: Iterable[FlowKind]) -> str:
    return ", ".join(WORDS[kind] for kind in kinds)


def _port_aspects(port: ParentPort, own: set[str]) -> dict[str, str]:
    aspects = {
        "direction": port.direction,
        "type": port.type,
        "size": port.size or "",
        "default": port.default or "",
        "period": port.period or "",
        "immediate": "immediate" if port.immediate else "",
        "safe value": port.safe or "",
    }
    if port.period and port.period not in own:
        # The value of the period, which may change with a constant elsewhere; a period given by a parameter is reported
        # where the parameter gets its value.
        aspects["period"] = " or ".join(map(str, port.periods)) or port.period
    return aspects


def _by_parameter(box: Box, names: tuple[str, ...]) -> dict[str, str]:
    """The arguments of an instance by parameter, including positional ones."""
    found: dict[str, str] = {}
    for position, argument in enumerate(box.arguments):
        name, sign, value = argument.partition(" = ")
        if not (sign and name.isidentifier()):
            name, value = names[position] if position < len(names) else str(position + 1), argument
        found[f"argument {name}"] = value
    return found


def _body(external: ast.External | None) -> str:
    return "" if external is None else f'{external.language.text} "{external.target}"'


def _add(parts: Parts, subject: str, name: str, item: ast.Node, aspects: Mapping[str, str | None]) -> None:
    parts[subject, name] = DefinitionPart(
        texts.written(item), {key: value or "" for key, value in aspects.items()}, "", item.span
    )


def _add_parameters(parts: Parts, parameters: Iterable[ast.Parameter]) -> None:
    for item in parameters:
        aspects = {"type": texts.written(item.type), "default": texts.optional(item.default)}
        _add(parts, "parameter", item.name.text, item, aspects)


def _add_ports(parts: Parts, ports: Iterable[ast.Ports]) -> None:
    for item in ports:
        for port in item.names:
            aspects = {
                "direction": item.direction,
                "type": texts.written(item.type),
                "size": texts.indexes(port.dimensions),
                "default": texts.optional(item.default),
                "period": texts.optional(item.sampling),
            }
            text = f"{item.direction} {texts.written(port)} : {texts.written(item.type)}"
            kept = {key: value or "" for key, value in aspects.items()}
            parts["port", port.name.text] = DefinitionPart(text, kept, "", port.span)


def _add_items(parts: Parts, items: Iterable[ast.SubmodelItem]) -> None:
    for item in items:
        match item:
            case ast.Let():
                _add(parts, "let", item.name.text, item, {"value": texts.written(item.value)})
            case ast.State():
                initial = texts.written(item.initial)
                _add(parts, "state", item.name.text, item, {"type": texts.written(item.type), "initial value": initial})
            case ast.Next():
                _add(parts, "equation", f"next {item.name.text}", item, {"value": texts.written(item.value)})
            case ast.Derivative():
                _add(parts, "equation", f"der {item.name.text}", item, {"value": texts.written(item.value)})
            case ast.Equation():
                target = texts.spaced(texts.written(item.target))
                _add(parts, "equation", target, item, {"value": texts.written(item.value)})
            case ast.Instance():
                arguments = ", ".join(texts.arguments(item.arguments))
                _add(
                    parts,
                    "instance",
                    item.name.text,
                    item,
                    {"definition": item.definition.text, "arguments": arguments},
                )
