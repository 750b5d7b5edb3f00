"""Resolves references inside a shape to instances, ports and channels, element by element."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Value
from cspdiag.network.diagnostics.arrays import IndexMissing, IndexOutOfRange
from cspdiag.network.elaborate.fewer.columns import Repetitions
from cspdiag.network.elaborate.sizes import Sizes
from cspdiag.network.shapes import ChannelShape, InstanceShape, Key, PortElement, PortShape, Shape, element_name
from cspdiag.syntax import ast

Values: TypeAlias = Mapping[ast.Node, Value]


@node
class ProcessPort:
    """A port of the process itself."""

    span: Span
    port: PortShape
    key: Key


@node
class InstancePort:
    """A port of an instance."""

    span: Span
    instance: InstanceShape
    port: PortShape
    element: PortElement

    @property
    def name(self) -> str:
        """The name of the port, such as ``servo.control``."""
        return f"{self.instance.name}.{element_name(*self.element)}"


@node
class ChannelPlace:
    """A channel, a variable or a label of the process."""

    span: Span
    channel: ChannelShape


Endpoint: TypeAlias = ProcessPort | InstancePort | ChannelPlace


class Places:
    """Resolves the references of one shape. A method that returns None has reported what is wrong, or it was reported
    before.
    """

    def __init__(self, sizes: Sizes, shape: Shape, loops: Mapping[ast.Node, tuple[ast.Replicator, ...]]) -> None:
        self.sizes = sizes
        self.program = sizes.program
        self.shape = shape
        self.loops = loops
        self.aliases: dict[str, ProcessPort] = {}
        """The ports of the process that labels on arrows mean, by label."""
        self.excused: set[tuple[str, str | None]] = set()
        """Instances and ports in references that could not be resolved; None if it could be any port."""
        self.arrays: dict[str, list[InstanceShape]] = {}

    def indexes(self, expressions: tuple[ast.Expression, ...], values: Values) -> list[int] | None:
        """The values of indexes; None if one is unknown."""
        found = [self.sizes.integer(expression, values) for expression in expressions]
        known = [index for index in found if index is not None]
        if len(known) < len(found):
            self.shape.incomplete = True
            return None
        return known

    def instance(self, reference: ast.Reference, values: Values) -> InstanceShape | None:
        """The single instance that a reference names."""
        symbol = self.program.bindings.get(reference)
        if not isinstance(symbol, ast.Instance) or not self.program.poisoned.isdisjoint((symbol, reference)):
            return None
        found = self._elements(reference, symbol, values)
        if found is None:
            return None
        instances, whole = found
        if whole:
            self._missing_index(reference)
            return None
        return instances[0]

    def endpoints(self, reference: ast.Reference, values: Values) -> tuple[list[Endpoint], bool] | None:
        """All ends that a reference in a relationship means, and whether it is a whole array."""
        if reference in self.program.poisoned:
            self._excuse(reference)
            return None
        symbol = self.program.bindings.get(reference)
        found: tuple[list[Endpoint], bool] | None = None
        match symbol:
            case PortSymbol():
                found = self._process_ports(reference, symbol, values)
            case ast.Instance() if reference.member is not None:
                found = self._instance_ports(reference, symbol, values)
            case ast.Variable() | ast.Channel() | EndLabelSymbol():
                channel = self.channel(reference, symbol, values)
                found = ([channel], False) if channel is not None else None
            case (
                ast.Constant() | ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition()
                | ast.ExceptionDefinition() | ast.ProcessDefinition() | ast.SubmodelDefinition()
                | ast.DriverDefinition() | ast.EnvironmentDefinition() | ast.Parameter() | ast.Instance() | ast.Let()
                | ast.State() | ast.Replicator() | EnumLiteralSymbol() | BuiltinSymbol() | None
            ):  # fmt: skip
                pass  # Not a part of the diagram, which was reported when the reference was bound.
            case _:
                assert_never(symbol)
        if found is None:
            self._excuse(reference)
        return found

    def in_all_repetitions(
        self, reference: ast.Reference, replicator: ast.Replicator, count: int
    ) -> Sequence[InstancePort] | None:
        """The port of an instance that a reference means in each repetition of an outermost ``for``; None if it means
        something else, or if it may be wrong in one of them.
        """
        symbol, member = self.program.bindings.get(reference), self.program.members.get(reference)
        if self.program.poisoned or not isinstance(symbol, ast.Instance):
            return None
        if not isinstance(member, PortSymbol) or self.loops.get(symbol):
            return None
        given, inside = reference.indexes, reference.member_indexes
        if len(given) != (symbol.size is not None) or len(inside) > 1:
            return None
        repetitions = Repetitions(self.program, {replicator: count})
        columns = [repetitions.column(index) for index in (*given, *inside)]
        instances = self.shape.instances
        name = symbol.name.text
        chosen = [instances.get(name)] * count
        if given:
            if columns[0] is None:
                return None
            chosen = [instances.get(f"{name}[{index}]") for index in columns[0]]
        within = columns[-1] if inside else None
        found: list[InstancePort] = []
        for position, instance in enumerate(chosen):
            port = None if instance is None else instance.shape.ports.get(member.name)
            if instance is None or port is None or (port.size is None) == bool(inside):
                return None
            element = None if within is None else within[position]
            if port.size is not None and not (element is not None and 0 <= element < port.size):
                return None
            found.append(InstancePort(span=reference.span, instance=instance, port=port, element=(port.name, element)))
        return found

    def single(self, reference: ast.Reference, values: Values) -> ProcessPort | ChannelPlace | None:
        """The single port or channel of this process that ``?``, ``!`` or a guard names."""
        found = self.endpoints(reference, values)
        if found is None:
            return None
        ends, whole = found
        if whole:
            self._missing_index(reference)
            return None
        return None if isinstance(ends[0], InstancePort) else ends[0]

    def channel(
        self, reference: ast.Reference | ast.Name, symbol: ast.Variable | ast.Channel | EndLabelSymbol, values: Values
    ) -> ProcessPort | ChannelPlace | None:
        """The channel, variable or label that a name means here; for an alias the port.

        Indexes beyond those of the ``for`` around the declaration choose elements of the value, and are ignored.
        """
        declaration = symbol.connection if isinstance(symbol, EndLabelSymbol) else symbol
        loops = self.loops.get(declaration, ())
        name = declaration.label.text if isinstance(declaration, ast.Connection) and declaration.label else ""
        if not isinstance(declaration, ast.Connection):
            name = declaration.name.text
        prefix: list[int] | None = [i for loop in loops if isinstance(i := values.get(loop), int)]
        if prefix is None or len(prefix) != len(loops):
            given = reference.indexes if isinstance(reference, ast.Reference) else ()
            prefix = self.indexes(given[: len(loops)], values)
            if prefix is None:
                return None
            if len(prefix) != len(loops):
                self._missing_index(reference)
                return None
        full = element_name(name, *prefix)
        if full in self.shape.channels:
            return ChannelPlace(span=reference.span, channel=self.shape.channels[full])
        return self.aliases.get(full)

    def indexes_beyond_loops(self, reference: ast.Reference, values: Values) -> tuple[ast.Expression, ...]:
        """The indexes of a reference to a variable that choose an element of its value."""
        symbol = self.program.bindings.get(reference)
        declaration = symbol.connection if isinstance(symbol, EndLabelSymbol) else symbol
        loops = self.loops.get(declaration, ()) if isinstance(declaration, ast.Node) else ()
        return reference.indexes if all(loop in values for loop in loops) else reference.indexes[len(loops) :]

    def _process_ports(
        self, reference: ast.Reference, symbol: PortSymbol, values: Values
    ) -> tuple[list[Endpoint], bool] | None:
        port = self.shape.ports.get(symbol.name)
        elements = None if port is None else self._port_elements(reference, reference.indexes, port, values)
        if port is None or elements is None:
            return None
        whole = port.size is not None and not reference.indexes
        return [ProcessPort(span=reference.span, port=port, key=element_name(*e)) for e in elements], whole

    def _instance_ports(
        self, reference: ast.Reference, symbol: ast.Instance, values: Values
    ) -> tuple[list[Endpoint], bool] | None:
        member = self.program.members.get(reference)
        found = self._elements(reference, symbol, values)
        if found is None or not isinstance(member, PortSymbol):
            return None
        instances, whole = found
        ends: list[Endpoint] = []
        for instance in instances:
            port = instance.shape.ports.get(member.name)
            indexes = reference.member_indexes
            elements = None if port is None else self._port_elements(reference, indexes, port, values)
            if port is None or elements is None:
                return None
            if whole and len(elements) > 1 and not reference.member_indexes:
                self._missing_index(reference)
                return None
            whole = whole or (port.size is not None and not reference.member_indexes)
            ends += [InstancePort(span=reference.span, instance=instance, port=port, element=e) for e in elements]
        return ends, whole

    def _port_elements(
        self, reference: ast.Reference, given: tuple[ast.Expression, ...], port: PortShape, values: Values
    ) -> Sequence[PortElement] | None:
        if not given:
            return port.elements
        indexes = self.indexes(given, values)
        if indexes is None or port.size is None:
            return None
        flat = 0
        sizes = [port.size]
        if len(indexes) != 1:
            sizes = [self.sizes.integer(d, self.shape.values) or 0 for d in port.symbol.port.dimensions]
        for expression, index, size in zip(given, indexes, sizes, strict=False):
            if not 0 <= index < size:
                self._out_of_range(expression, index, f"the array of ports `{port.name}`", size, port.span)
                return None
            flat = flat * size + index
        return [(port.name, flat)]

    def _elements(
        self, reference: ast.Reference, symbol: ast.Instance, values: Values
    ) -> tuple[list[InstanceShape], bool] | None:
        """The instances that a reference names, and whether that is a whole array."""
        given = self.indexes(reference.indexes, values) if reference.indexes else []
        if given is None:
            return None
        loops = self.loops.get(symbol, ())
        depth = len(loops) + (symbol.size is not None)
        around = [index for loop in loops if isinstance(index := values.get(loop), int)] if loops else []
        if len(around) == len(loops) and len(given) <= depth - len(loops):
            given = around + given
        full = element_name(symbol.name.text, *given)
        if len(given) == depth:
            instance = self.shape.instances.get(full)
            if instance is None:
                self._no_such_element(reference, symbol, given)
                return None
            return [instance], False
        if symbol.size is not None and len(given) == depth - 1:
            array = self._arrays().get(full)
            return (array, True) if array else None
        self._missing_index(reference)
        return None

    def _arrays(self) -> dict[str, list[InstanceShape]]:
        if not self.arrays:
            for instance in self.shape.instances.values():
                if instance.array is not None:
                    self.arrays.setdefault(instance.array, []).append(instance)
        return self.arrays

    def _no_such_element(self, reference: ast.Reference, symbol: ast.Instance, given: list[int]) -> None:
        array = self._arrays().get(element_name(symbol.name.text, *given[:-1]))
        if array is None or not reference.indexes:
            return
        what = f"the array of instances `{symbol.name.text}`"
        self._out_of_range(reference.indexes[-1], given[-1], what, len(array), symbol.name.span)

    def _missing_index(self, reference: ast.Reference | ast.Name) -> None:
        name = reference.name.text if isinstance(reference, ast.Reference) else reference.name
        self.sizes.report.add(IndexMissing(span=reference.span, name=name))

    def _out_of_range(self, expression: ast.Expression, index: int, what: str, size: int, declared: Span) -> None:
        self.sizes.report.add(
            IndexOutOfRange(span=expression.span, index=index, what=what, size=size, declared=declared)
        )

    def _excuse(self, reference: ast.Reference) -> None:
        symbol = self.program.bindings.get(reference)
        if reference.member is not None:
            known = isinstance(self.program.members.get(reference), PortSymbol)
            self.excused.add((reference.name.text, reference.member.text if known else None))
        elif isinstance(symbol, PortSymbol) and symbol.name in self.shape.ports:
            for element in self.shape.ports[symbol.name].elements:
                self.shape.port_spans.setdefault(element_name(*element), reference.span)
