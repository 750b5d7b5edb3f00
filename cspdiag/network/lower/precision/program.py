"""Networks whose program computes in single precision, for ``--real float32``.

``double`` becomes binary32 in everything that belongs to the program: its processes, control laws, channels and ports.
What is computed once, before the first sample (arguments, initial values, equations of laws over parameters alone), is
computed in double precision and rounded at the end. Environments stay in double
precision; values are rounded where they enter the program.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cspdiag.base import Report, Span
from cspdiag.base.record import replaced
from cspdiag.model.types import RealType, Type
from cspdiag.network.diagnostics.precision import ChangedArgument
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.ir.actions import CoreAction
from cspdiag.network.ir.equations import ExternalCall, LinearBlock, SubmodelEquation
from cspdiag.network.ir.expressions import (
    Expression,
    LiteralValue,
    ParameterValue,
    SignalValue,
    TunableValue,
    Value,
    VariableValue,
)
from cspdiag.network.ir.network import (
    ClassParameter,
    CoreNetwork,
    Environment,
    Instantiation,
    NamedConstant,
    ProcessClass,
    ProgramParameter,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts
from cspdiag.network.lower.precision.expressions import (
    NONE,
    Named,
    Outside,
    Precision,
    converts_whole_numbers,
    known_by_name,
    rounded,
    rounded_and_tested,
)
from cspdiag.network.lower.precision.types import outside_type, parts_of, program_type, rounded_to

CoreClass = ProcessClass[CoreAction] | SubmodelClass


def in_single_precision(network: CoreNetwork, report: Report) -> CoreNetwork | None:
    """The network with its program in single precision; None if an error was reported."""
    precision = Precision(report)
    made: dict[str, CoreClass] = {}
    for entry in network.classes:
        if isinstance(entry, SubmodelClass):
            made[entry.name] = _law(entry, precision)
        else:
            made[entry.name] = _process(entry, made, precision)
    classes = tuple(made.values())
    instances = _Instances(network, made, precision, report).found()
    of_program, of_environments = _constants_named(network.classes), _constants_named(network.environments)
    own = frozenset(of_environments - of_program)
    environments = tuple(_environment(entry, own) for entry in network.environments)
    ports = tuple(
        replaced(
            port,
            type=program_type(port.type),
            safe=None if port.safe is None else _checked(port.type, port.safe, port.span, precision),
            default=None if port.default is None else _checked(port.type, port.default, port.span, precision),
        )
        for port in network.external_ports
    )
    if report.has_errors:
        return None
    still_named = _constants_named(classes)
    return replaced(
        network,
        arguments=_arguments(network.arguments, made[network.top].parameters),
        constants=tuple(
            _constant(entry) if entry.name in still_named else entry
            for entry in network.constants
            if entry.name in still_named or entry.name in _constants_named(environments)
        ),
        parameters=tuple(_parameter(entry, precision) for entry in network.parameters),
        structs=precision.inside(network.structs),
        classes=classes,
        external_ports=ports,
        environments=environments,
        instances=instances,
        nets=precision.inside(network.nets),
    )


def _constants_named(item: object) -> set[str]:
    return {part.name for part in parts(item) if isinstance(part, LiteralValue) and part.name is not None}


def _constant(entry: NamedConstant) -> NamedConstant:
    kind = program_type(entry.type)
    return replaced(entry, type=kind, value=rounded_to(kind, entry.value))


def _parameter(entry: ProgramParameter, precision: Precision) -> ProgramParameter:
    kind = program_type(entry.type)
    return replaced(
        entry,
        type=kind,
        value=_checked(entry.type, entry.value, entry.span, precision),
        follows=None if entry.follows is None else _once(entry.follows, kind, precision),
    )


def _checked(kind: Type, value: Value, span: Span, precision: Precision) -> Value:
    precision.check(kind, value, span)
    return rounded_to(program_type(kind), value)


def _arguments(
    arguments: Iterable[tuple[str, Value]], parameters: Iterable[ClassParameter]
) -> tuple[tuple[str, Value], ...]:
    kinds = {parameter.name: parameter.type for parameter in parameters}
    return tuple((name, rounded_to(kinds[name], value) if name in kinds else value) for name, value in arguments)


def _once(value: Expression, kind: Type, precision: Precision, doubles: frozenset[str] = NONE) -> Expression:
    """What is computed once, as a value of this type: in double precision, and rounded at the end."""
    if isinstance(value, LiteralValue) and kind == program_type(value.type):
        return precision.literal(value)
    if isinstance(value, TunableValue) and kind == program_type(value.type):
        return replaced(value, type=kind)

    def declared(part: Named) -> Type:
        is_kept = not isinstance(part, VariableValue) and part.name in doubles
        return part.type if is_kept else program_type(part.type)

    return rounded(Outside(declared)(value), kind)


def _law(entry: SubmodelClass, precision: Precision) -> SubmodelClass:
    doubles = _doubles(entry)
    plain = precision.inside(replaced(entry, parameters=(), constants=(), states=()), doubles)
    return replaced(
        plain,
        parameters=tuple(item if item.name in doubles else precision.inside(item) for item in entry.parameters),
        constants=tuple(
            item
            if item.name in doubles
            else replaced(
                item, type=program_type(item.type), value=_once(item.value, program_type(item.type), precision, doubles)
            )
            for item in entry.constants
        ),
        states=tuple(
            replaced(
                state,
                type=program_type(state.type),
                initial=_once(state.initial, program_type(state.type), precision, doubles),
            )
            for state in entry.states
        ),
    )


def _doubles(entry: CoreClass) -> frozenset[str]:
    """The sample period of a law that integrates over it: rounded, it might have another number of sub-steps."""
    return frozenset({"sample"}) if isinstance(entry, SubmodelClass) and entry.derivatives else NONE


def _process(
    entry: ProcessClass[CoreAction], made: Mapping[str, CoreClass], precision: Precision
) -> ProcessClass[CoreAction]:
    instances = tuple(
        replaced(
            precision.inside(replaced(item, arguments=())),
            arguments=tuple((name, _once(value, kinds[name], precision)) for name, value in item.arguments),
        )
        for item in entry.instances
        for kinds in [{parameter.name: parameter.type for parameter in made[item.class_name].parameters}]
    )
    channels = tuple(
        replaced(
            channel,
            type=program_type(channel.type),
            initial=None if channel.initial is None else _once(channel.initial, program_type(channel.type), precision),
        )
        for channel in entry.channels
    )
    plain = precision.inside(replaced(entry, instances=(), channels=()))
    return replaced(plain, instances=instances, channels=channels)


class _Instances:
    """The values of parameters, which follow from each other from the outermost process inwards."""

    def __init__(
        self, network: CoreNetwork, classes: Mapping[str, CoreClass], precision: Precision, report: Report
    ) -> None:
        self._network = network
        self._classes = classes
        self._precision = precision
        self._report = report
        self._values: dict[str, tuple[str, dict[str, Value]]] = {}
        self._given = {
            (entry.name, instance.name): instance.arguments
            for entry in classes.values()
            if isinstance(entry, ProcessClass)
            for instance in entry.instances
        }
        self._computed: set[tuple[str, tuple[tuple[str, Value], ...]]] = set()
        self._reported: set[tuple[str, str]] = set()
        """Parameters, by the path of their instance, whose values were reported."""

    def found(self) -> tuple[Instantiation, ...]:
        """All instances, with the values of their parameters."""
        return tuple(map(self._instance, self._network.instances))

    def _instance(self, item: Instantiation) -> Instantiation:
        parameters = {entry.name: entry for entry in self._classes[item.class_name].parameters}
        before = dict(item.arguments)
        values = dict(_arguments(item.arguments, parameters.values()))
        outer, _, name = item.path.rpartition(".")
        if outer:
            around, known = self._values[outer]
            for parameter, expression in self._given[around, name]:
                if isinstance(expression, TunableValue):
                    continue
                place = expression.span or parameters[parameter].span
                value = constant_value(expression, known_by_name(known))
                self._check(item.path, parameters[parameter], before[parameter], place, expression)
                if value is not None and _differs(parameters[parameter].type, value, values[parameter]):
                    self._report.add(ChangedArgument(place, parameter, str(before[parameter]), str(value)))
                elif value is not None:
                    values[parameter] = value
        else:
            for parameter, given in item.arguments:
                self._check(item.path, parameters[parameter], given, parameters[parameter].span, None)
        self._values[item.path] = item.class_name, values
        self._compute(item, values, before)
        return replaced(item, arguments=tuple(values.items()))

    def _check(
        self, path: str, parameter: ClassParameter, value: Value, place: Span, expression: Expression | None
    ) -> None:
        """Report an argument that single precision does not have, unless it follows from one that was reported."""
        around = path.rpartition(".")[0]
        used = {part.name for part in parts(expression) if isinstance(part, ParameterValue)}
        is_exact = expression is None or isinstance(expression, LiteralValue) or converts_whole_numbers(expression)
        check = self._precision.check if is_exact else self._precision.check_size
        if any((around, name) in self._reported for name in used) or not check(parameter.type, value, place):
            self._reported.add((path, parameter.name))

    def _compute(self, item: Instantiation, values: Mapping[str, Value], before: Mapping[str, Value]) -> None:
        """Compute what a class computes once, and report numbers that are too large or too small."""
        key = (item.class_name, tuple(values.items()))
        if key in self._computed:
            return
        self._computed.add(key)
        known = {**before}
        doubtful = {name for path, name in self._reported if path == item.path}
        for old in _initials(self._network.class_named(item.class_name)):
            value = constant_value(old.value, known_by_name(known))
            if value is not None:
                known[old.name] = value
                named = {part.name for part in parts(old.value) if isinstance(part, ParameterValue | SignalValue)}
                if named & doubtful:
                    doubtful.add(old.name)
                elif not isinstance(old.value, LiteralValue):
                    is_exact = converts_whole_numbers(old.value)
                    check = self._precision.check if is_exact else self._precision.check_size
                    check(old.type, value, old.span)


def _initials(entry: CoreClass) -> Iterable[SubmodelEquation]:
    """What a class computes once, in this order."""
    if isinstance(entry, SubmodelClass):
        yield from entry.constants
        for state in entry.states:
            yield SubmodelEquation(name=state.name, span=state.span, type=state.type, value=state.initial)
        return
    for channel in entry.channels:
        if channel.initial is not None:
            yield SubmodelEquation(name=channel.name, span=channel.span, type=channel.type, value=channel.initial)


def _differs(kind: Type, one: Value, other: Value) -> bool:
    """Whether two values differ in a part that is not real."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return any(_differs(inner, a, b) for (inner, a), b in zip(parts_of(kind, one), other, strict=True))
    return one != other and not isinstance(kind, RealType)


def _environment(entry: Environment, own: frozenset[str]) -> Environment:
    """An environment, with ports in single precision: what it hands to the program is rounded."""
    if entry.system is None:
        return entry
    ports = tuple(replaced(port, type=program_type(port.type)) for port in entry.system.ports)
    kinds = {port.name: port.type for port in ports}

    def declared(part: Named) -> Type:
        if isinstance(part, TunableValue):
            return program_type(part.type)
        return (
            kinds.get(part.name, outside_type(part.type)) if isinstance(part, SignalValue) else outside_type(part.type)
        )

    outside = Outside(declared, own)

    def equation(item: SubmodelEquation) -> SubmodelEquation:
        value = outside(item.value)
        if item.name in kinds:
            return replaced(item, type=kinds[item.name], value=rounded_and_tested(value, kinds[item.name]))
        return replaced(item, type=outside_type(item.type), value=value)

    def call(item: ExternalCall) -> ExternalCall:
        return replaced(
            item,
            arguments=tuple((name, outside(value)) for name, value in item.arguments),
            inputs=tuple((name, outside(value)) for name, value in item.inputs),
            outputs=tuple((port, name, outside_type(kind)) for port, name, kind in item.outputs),
        )

    def block(item: LinearBlock) -> LinearBlock:
        return replaced(
            item,
            matrix=tuple(tuple(None if cell is None else outside(cell) for cell in row) for row in item.matrix),
            equations=tuple(map(equation, item.equations)),
            held=tuple(None if value is None else outside(value) for value in item.held),
        )

    system = entry.system
    changed = replaced(
        system,
        ports=ports,
        constants=tuple(map(equation, system.constants)),
        states=tuple(
            replaced(state, type=outside_type(state.type), initial=outside(state.initial)) for state in system.states
        ),
        equations=tuple(call(item) if isinstance(item, ExternalCall) else equation(item) for item in system.equations),
        next_values=tuple((name, outside(value)) for name, value in system.next_values),
        derivative_equations=tuple(map(equation, system.derivative_equations)),
        derivatives=tuple((name, outside(value)) for name, value in system.derivatives),
        linear=tuple(map(block, system.linear)),
    )
    return replaced(entry, system=changed)
