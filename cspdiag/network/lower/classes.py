"""Makes process classes from shapes: one class for all occurrences that differ only in the values of constants.

What the compiler adds to a submodel (its sample period, coefficients of discretized operators) are derived parameters
of its class. The process around it provides the value: by its own parameter that is the period of a port, by a literal
if all occurrences agree, by any ``time`` parameter with the same value, or else by a derived parameter of its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias, assert_never

from cspdiag.base import Report
from cspdiag.base.record import replaced
from cspdiag.model.program import Program, Value
from cspdiag.model.types import UNKNOWN, TimeType
from cspdiag.network.elaborate.definitions import Definitions, arguments_of
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression, lower_period
from cspdiag.network.infer.ends import ReadingEnds, with_ends
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import Expression, FunctionCall, LiteralValue, ParameterValue, TunableValue
from cspdiag.network.ir.network import (
    Attachment,
    ClassParameter,
    Connection,
    ConstantEnd,
    CoreClass,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    Port,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.lower.distinct_names import DistinctNames
from cspdiag.network.occurrences import LawOccurrence, Occurrence
from cspdiag.network.relations import Relations
from cspdiag.network.shapes import (
    Attached,
    ChannelShape,
    Default,
    Discarded,
    InstanceShape,
    OwnChannel,
    OwnPort,
    PortElement,
    PortShape,
    Shape,
    Unresolved,
    element_name,
)
from cspdiag.network.submodels.inline import external_body
from cspdiag.syntax import ast

Arguments: TypeAlias = "dict[ast.Parameter, Expression]"
"""The values of the parameters of an instance, in terms of the parameters of the class around it."""


class Classes:
    """The classes of a network, each after those of its instances."""

    def __init__(self, program: Program, definitions: Definitions, relations: Relations, report: Report) -> None:
        self.program = program
        self.definitions = definitions
        self.relations = relations
        self.report = report
        self.made: dict[str, CoreClass | SubmodelClass] = {}
        self._distinct = DistinctNames(program.definitions)
        self.class_of: dict[Occurrence | LawOccurrence, str] = {}
        self._laws: dict[SubmodelClass, str] = {}
        self._ends: dict[Shape, ReadingEnds] = {}

    def make(self, occurrences: list[Occurrence]) -> None:
        """Makes the classes of all occurrences, those of submodels first."""
        for occurrence in occurrences:
            for child in occurrence.children.values():
                if isinstance(child, LawOccurrence) and child not in self.class_of:
                    self.class_of[child] = self._law_name(child.flattened.cls)
        grouped: dict[ast.ProcessDefinition, list[Occurrence]] = {}
        for occurrence in occurrences:
            grouped.setdefault(occurrence.definition, []).append(occurrence)
        for definition in self.definitions.order:
            if definition in grouped:
                self._make_processes(grouped[definition])

    def ends(self, shape: Shape) -> ReadingEnds:
        """The reading ends of a shape."""
        known = self._ends.get(shape)
        if known is None:
            known = self._ends[shape] = ReadingEnds(shape)
        return known

    def _law_name(self, law: SubmodelClass) -> str:
        """The name of the class of a law; equal ones are one class."""
        name = self._laws.get(law)
        if name is None:
            name = self._laws[law] = self._fresh(law.name)
            self.made[name] = replaced(law, name=name)
        return name

    def _fresh(self, name: str) -> str:
        """The name of a new class; further shapes of a definition are numbered: ``Ring_2``."""
        return self._distinct.fresh(name, lambda number: f"{name}_{number}") if name in self.made else name

    def _make_processes(self, occurrences: list[Occurrence]) -> None:
        """Makes the classes of one definition: one for equal shapes, with the derived parameters of all its
        occurrences.
        """
        sketches: dict[object, CoreClass] = {}
        members_of: dict[object, list[Occurrence]] = {}
        for occurrence in occurrences:
            inside = tuple(self.class_of[child] for child in occurrence.children.values())
            key = (occurrence.placed, inside, occurrence.tunable)
            if key not in sketches:
                sketches[key] = _Sketch(self, occurrence).process_class()
            members_of.setdefault(key, []).append(occurrence)
        for sketch, members in _alike(sketches, members_of):
            name = self._fresh(sketch.name)
            self.made[name] = replaced(_Derivation(self, sketch, members).complete(), name=name)
            for occurrence in members:
                self.class_of[occurrence] = name


def _alike(
    sketches: Mapping[object, CoreClass], members_of: Mapping[object, list[Occurrence]]
) -> Iterable[tuple[CoreClass, list[Occurrence]]]:
    """Each of the sketches that differ, with the occurrences of all that are equal to it."""
    if len(sketches) == 1:  # There is nothing to compare, and a class may have very many parts.
        return [(sketch, members_of[key]) for key, sketch in sketches.items()]
    groups: dict[CoreClass, list[Occurrence]] = {}
    for key, sketch in sketches.items():
        groups.setdefault(sketch, []).extend(members_of[key])
    return groups.items()


class _Sketch:
    """The class of an occurrence before its derived parameters are known."""

    def __init__(self, classes: Classes, occurrence: Occurrence) -> None:
        self.classes = classes
        self.program = classes.program
        self.occurrence = occurrence
        self.shape = occurrence.placed.shape
        self.plain = LoweringContext(values={})

    def process_class(self) -> CoreClass:
        definition = self.occurrence.definition
        external = definition.external
        body = self.shape.body
        made: CoreClass = ProcessClass(
            name=definition.name.text,
            definition=definition.name.text,
            doc=definition.doc,
            span=definition.name.span,
            parameters=tuple(self._parameter(parameter) for parameter in definition.parameters),
            ports=tuple(map(self._port, self.shape.ports.values())),
            channels=tuple(map(self._channel, self.shape.channels.values())),
            instances=tuple(
                self._instance(instance, self.occurrence.children[name])
                for name, instance in self.shape.instances.items()
            ),
            body=None if body is None else with_ends(body, self.classes.ends(self.shape)),
            external=None if external is None else external_body(external),
            wcet=self._wcet(definition.wcet),
        )
        return rewritten(made, self._tunable) if self.occurrence.tunable else made

    def _tunable(self, part: Any) -> Any:
        """A use of a parameter that follows parameters of the program."""
        if isinstance(part, ParameterValue) and part.name in self.occurrence.tunable:
            return TunableValue(type=part.type, name=part.name, span=part.span)
        return part

    def _wcet(self, expression: ast.Expression | None) -> int | None:
        if expression is None:
            return None
        lowered = lower_expression(self.program, expression, self.plain)
        value = lowered.value if isinstance(lowered, LiteralValue) else None
        return value if isinstance(value, int) else None

    def _parameter(self, parameter: ast.Parameter) -> ClassParameter:
        return ClassParameter(
            name=parameter.name.text,
            doc=parameter.doc,
            span=parameter.name.span,
            type=self.program.types.get(parameter, UNKNOWN),
            tunable=parameter.name.text in self.occurrence.tunable,
        )

    def _port(self, port: PortShape) -> Port:
        declaration = port.symbol.declaration
        return Port(
            name=port.name,
            doc=declaration.doc,
            span=port.span,
            direction=port.direction,
            type=port.type,
            size=port.size,
            period=lower_period(self.program, declaration.sampling, self.plain),
        )

    def _channel(self, channel: ChannelShape) -> LocalChannel:
        ends = 1
        if channel.kind == "broadcast":
            ends = reading_ends(self.classes, self.shape, channel.name)
        return LocalChannel(
            name=channel.name,
            doc=None if isinstance(channel.declaration, ast.Replicator) else channel.declaration.doc,
            span=channel.span,
            type=channel.type,
            kind=channel.kind,
            initial=channel.initial,
            capacity=channel.capacity,
            iterations=channel.iterations,
            ends=ends,
        )

    def _instance(self, instance: InstanceShape, child: Occurrence | LawOccurrence) -> InstanceOf:
        arguments = self._arguments(instance)
        return InstanceOf(
            name=instance.name,
            doc=instance.declaration.doc,
            span=instance.span,
            class_name=self.classes.class_of[child],
            array=instance.array,
            index=instance.index,
            arguments=tuple((parameter.name.text, value) for parameter, value in arguments.items()),
            connections=tuple(
                self._connection(instance, port, element, arguments)
                for port, element, _ in instance.shape.port_elements()
            ),
        )

    def _connection(
        self, instance: InstanceShape, port: PortShape, element: PortElement, arguments: Arguments
    ) -> Connection:
        """The connection of a port; the elements of an array of ports of a control law become single ports."""
        name, index = element
        attachment = self._attachment(instance, port, element, arguments)
        if index is not None and instance.shape.is_submodel and not instance.shape.is_external:
            return Connection(port=f"{name}[{index}]", index=None, attachment=attachment)
        return Connection(port=port.name, index=index, attachment=attachment)

    def _arguments(self, instance: InstanceShape) -> Arguments:
        """The arguments in terms of the parameters of the enclosing class; a default may use earlier parameters."""
        definition = instance.shape.definition
        known: Arguments = {}
        if not definition.parameters:
            return known
        given = dict(arguments_of(definition.parameters, instance.declaration.arguments))
        outside = LoweringContext(values=instance.replicators)
        inside = self._inside(known)
        for parameter in definition.parameters:
            name = parameter.name.text
            if name in instance.overrides:
                type_ = self.program.types.get(parameter, UNKNOWN)
                value: Expression = LiteralValue(type=type_, value=instance.overrides[name])
            elif parameter in given:
                value = lower_expression(self.program, given[parameter], outside)
            elif parameter.default is not None:
                value = lower_expression(self.program, parameter.default, inside)
            else:
                continue
            known[parameter] = value
        return known

    def _inside(self, arguments: Arguments) -> LoweringContext:
        """The context that lowers expressions over the parameters of an instance in terms of the class around it."""

        def own_parameter(name: ast.Name | ast.Member | ast.Reference) -> Expression | None:
            symbol = self.program.bindings.get(name)
            return arguments.get(symbol) if isinstance(symbol, ast.Parameter) else None

        return LoweringContext(values={}, lower_name=own_parameter)

    def _attachment(
        self, instance: InstanceShape, port: PortShape, element: PortElement, arguments: Arguments
    ) -> Attachment:
        attached: Attached = instance.attachments[element]
        end = 0
        if instance.shape.is_submodel and port.direction == "in":
            end = self.classes.ends(self.shape).of_input.get((instance.name, element), 0)
        match attached.target:
            case OwnPort(key=key):
                name, _, index = key.partition("[")
                return PortEnd(name, int(index[:-1]) if index else None, end)
            case OwnChannel(key=key):
                return ChannelEnd(key, end)
            case Default():
                assert port.symbol.declaration.default is not None
                default = port.symbol.declaration.default
                return ConstantEnd(lower_expression(self.program, default, self._inside(arguments)))
            case Discarded() | Unresolved():
                return DiscardEnd()
            case _:
                assert_never(attached.target)


def reading_ends(classes: Classes, shape: Shape, key: str) -> int:
    """The number of ends that read a port or channel, in this process and inside its process instances."""
    total = 0
    pending = [(shape, key)]
    while pending:
        present, name = pending.pop()
        if present.is_external:
            total += 1
            continue
        total += classes.ends(present).count.get(name, 0)
        for instance in present.instances.values():
            if instance.shape.is_submodel:
                continue
            for element, attached in instance.attachments.items():
                target = attached.target
                inside = instance.shape.ports[element[0]].direction == "in"
                if inside and isinstance(target, OwnPort | OwnChannel) and target.key == name:
                    pending.append((instance.shape, element_name(*element)))
    return total


class _Derivation:
    """Determines the values of the derived parameters of the instances in a class, for all occurrences of the class."""

    def __init__(self, classes: Classes, sketch: CoreClass, members: list[Occurrence]) -> None:
        self.classes = classes
        self.sketch = sketch
        self.members = members
        self.lifted: list[ClassParameter] = []

    def complete(self) -> CoreClass:
        instances = tuple(map(self._instance, self.sketch.instances))
        return replaced(self.sketch, instances=instances, parameters=(*self.sketch.parameters, *self.lifted))

    def _instance(self, instance: InstanceOf) -> InstanceOf:
        derived = [p for p in self.classes.made[instance.class_name].parameters if p.derived]
        if not derived:
            return instance
        arguments = dict(instance.arguments)
        for parameter in derived:
            values = [member.children[instance.name].derived[parameter.name] for member in self.members]
            arguments[parameter.name] = self._value(instance, parameter, values)
        return replaced(instance, arguments=tuple(arguments.items()))

    def _value(self, instance: InstanceOf, parameter: ClassParameter, values: list[Value]) -> Expression:
        own = self._own_times(values) if parameter.name == "sample" else []
        periods = [p for p in own if p.name in self._port_periods()]
        if periods:
            return _seconds(periods[0], parameter)
        if all(value == values[0] for value in values):
            return LiteralValue(type=parameter.type, value=values[0])
        if own:
            return _seconds(own[0], parameter)
        return self._lift(instance, parameter, values)

    def _own_times(self, values: list[Value]) -> list[ClassParameter]:
        """The ``time`` parameters of the class whose values in seconds are these, in all occurrences."""
        times = [p for p in self.sketch.parameters if isinstance(p.type, TimeType)]
        return [p for p in times if all(map(_is_seconds, self._values_of(p), values))]

    def _values_of(self, parameter: ClassParameter) -> list[Value | None]:
        return [member.arguments().get(parameter.name) for member in self.members]

    def _port_periods(self) -> set[str]:
        return {port.period.name for port in self.sketch.ports if isinstance(port.period, ParameterValue)}

    def _lift(self, instance: InstanceOf, parameter: ClassParameter, values: list[Value]) -> Expression:
        name = f"{instance.name}_{parameter.name}".replace("[", "_").replace("]", "").replace(".", "_")
        taken = {p.name for p in (*self.sketch.parameters, *self.lifted)} | {p.name for p in self.sketch.ports}
        while name in taken:
            name += "_"
        for member, value in zip(self.members, values, strict=True):
            member.derived[name] = value
        self.lifted.append(replaced(parameter, name=name, span=instance.span, derived=True))
        return ParameterValue(type=parameter.type, name=name)


def _is_seconds(nanoseconds: Value | None, seconds: Value) -> bool:
    return isinstance(nanoseconds, int) and nanoseconds / 1_000_000_000 == seconds


def _seconds(own: ClassParameter, parameter: ClassParameter) -> Expression:
    value = ParameterValue(type=own.type, name=own.name)
    return FunctionCall(type=parameter.type, function="seconds", arguments=(value,))
