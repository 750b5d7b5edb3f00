"""Instances and their ports, gathered from declarations and from the relationships that name them."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.draw.elements import texts
from cspdiag.draw.elements.diagram import Box, BoxKind, BoxPort, End
from cspdiag.draw.elements.facts import Facts
from cspdiag.model.program import Program
from cspdiag.network.ir.network import Direction
from cspdiag.syntax import ast

WithPorts = ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition


class Boxes:
    """The boxes of one diagram; ``complete`` gives each its ports, those that relationships name and those that are not
    connected.
    """

    def __init__(self, program: Program, facts: Facts, around: ast.Node) -> None:
        self._program = program
        self._facts = facts
        self._around = around
        self._boxes: dict[str, Box] = {}
        self._definitions: dict[str, WithPorts] = {}
        self._declarations: dict[str, ast.Instance] = {}
        self._ports: dict[str, dict[str, BoxPort]] = {}
        self._named: dict[str, set[str]] = {}
        """The ports of each box that some relationship names, whichever element of an array it is."""

    def has(self, key: str) -> bool:
        """Whether there is a box of that name."""
        return key in self._boxes

    def definition_of(self, key: str) -> WithPorts | None:
        """The definition of a box, if it is known."""
        return self._definitions.get(key)

    def add(self, instance: ast.Instance, repeated: tuple[str, ...]) -> None:
        """The box of an instance; if two have one name, the first one."""
        key = instance.name.text
        if key in self._boxes:
            return
        found = self._program.bindings.get(instance.definition)
        sizes = list(repeated)
        match instance.size:
            case ast.Replicator():
                sizes.append(texts.replicator(instance.size))
            case ast.Node():
                sizes.append(texts.written(instance.size))
            case None:
                pass
            case _:
                assert_never(instance.size)
        box = Box(
            key=key,
            doc=instance.doc,
            spans=(instance.span,),
            kind="unknown",
            definition=instance.definition.text,
            arguments=texts.arguments(instance.arguments),
            size="][".join(sizes) or None,
        )
        if isinstance(found, WithPorts):
            self._definitions[key] = found
            self._declarations[key] = instance
            box = replaced(
                box,
                kind=_kind(found),
                language=None if found.external is None else found.external.language.text,
                definition_doc=found.doc,
                samples=self._facts.samples(self._around, instance),
            )
        self._put(box)

    def add_process(self, environment: ast.EnvironmentDefinition) -> str:
        """The box of the process that an environment is for; returns its key."""
        taken = {item.name.text for item in environment.declarations if isinstance(item, ast.Instance)}
        name = environment.process.text
        key = f"the {name}" if name in taken else name
        found = self._program.bindings.get(environment.process)
        box = Box(
            key=key,
            spans=(environment.process.span,),
            kind="unknown",
            definition=name,
            arguments=texts.arguments(environment.arguments),
        )
        if isinstance(found, ast.ProcessDefinition):
            self._definitions[key] = found
            language = None if found.external is None else found.external.language.text
            box = replaced(box, kind="process", definition_doc=found.doc, language=language)
        self._put(box)
        return key

    def add_unknown(self, reference: ast.Reference) -> None:
        """A box for a name that is not declared."""
        self._put(Box(key=reference.name.text, spans=(reference.span,), kind="unknown", definition="?"))

    def end(self, key: str, index: str, member: ast.Identifier, member_index: str, direction: Direction) -> End:
        """An end at a port of a box: ``[i + 1].input``; ``direction`` applies if the definition is unknown."""
        port = f"{f'{index}.' if index else ''}{member.text}{member_index}"
        ports = self._ports[key]
        if port not in ports:
            ports[port] = self._port(key, port, member.text, direction)
        self._named[key].add(member.text)
        return End(key, port)

    def complete(self) -> list[Box]:
        """All boxes with their ports, those in the order of the definition."""
        return [self._completed(box) for box in self._boxes.values()]

    def _put(self, box: Box) -> None:
        self._boxes[box.key] = box
        self._ports[box.key] = {}
        self._named[box.key] = set()

    def _completed(self, box: Box) -> Box:
        definition = self._definitions.get(box.key)
        ports = self._ports[box.key]
        if definition is None:
            return replaced(box, ports=tuple(ports.values()))
        ordered: list[BoxPort] = []
        declared: dict[str, ast.Ports] = {}
        for declaration in definition.ports:
            for port in declaration.names:
                declared.setdefault(port.name.text, declaration)
        for name, declaration in declared.items():
            ordered += [port for port in ports.values() if port.name == name]
            if name not in self._named[box.key]:
                alone = self._port(box.key, name, name, declaration.direction)
                ordered.append(replaced(alone, default=texts.optional(declaration.default), is_connected=False))
        ordered += [port for port in ports.values() if port.name not in declared]
        return replaced(box, ports=tuple(ordered))

    def _port(self, box: str, key: str, name: str, direction: Direction) -> BoxPort:
        definition = self._definitions.get(box)
        found = next(
            (
                (declaration, port)
                for declaration in (definition.ports if definition else ())
                for port in declaration.names
                if port.name.text == name
            ),
            None,
        )
        if definition is None or found is None:
            return BoxPort(key=key, direction=direction, type="?")
        declaration, port = found
        return BoxPort(
            key=key,
            doc=declaration.doc,
            spans=(port.span,),
            direction=declaration.direction,
            type=texts.written(declaration.type),
            period=texts.optional(declaration.sampling),
            periods=self._facts.stated_periods(self._declarations.get(box, definition), port.name.text),
        )


def _kind(definition: WithPorts) -> BoxKind:
    match definition:
        case ast.ProcessDefinition():
            return "process"
        case ast.SubmodelDefinition():
            return "submodel"
        case ast.DriverDefinition():
            return "driver"
