"""From definitions to shapes: evaluates sizes, unrolls arrays and ``for``, and resolves every reference to an element.

The work is done once for each shape, by a worklist, so deep hierarchies and many equal instances cost no more than
their text. What structurally depends on a parameter without a value (in a definition that is checked by itself) is left
out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cspdiag.base import Report, Span
from cspdiag.base.record import EMPTY
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import PortSymbol, Program, Value
from cspdiag.model.sampling import Sampling
from cspdiag.network.diagnostics.samples.periods import OffsetOutsidePeriod
from cspdiag.network.elaborate.compose import compose
from cspdiag.network.elaborate.connect import connect
from cspdiag.network.elaborate.definitions import Definitions, Instantiable, arguments_of
from cspdiag.network.elaborate.places import Places
from cspdiag.network.elaborate.sizes import Sizes
from cspdiag.network.shapes import UNKNOWN_SAMPLING, InstanceShape, Overrides, PortShape, Shape, element_name
from cspdiag.syntax import ast

Values = Mapping[ast.Node, Value]


class Elaboration:
    """Makes the shapes of a program, each one once."""

    def __init__(self, program: Program, definitions: Definitions, report: Report) -> None:
        self.program = program
        self.definitions = definitions
        self.report = report
        self.sizes = Sizes(program, report)
        self.shapes: list[Shape] = []
        """Callers before callees, in the order of discovery."""
        self.refused_periods: dict[Shape, list[tuple[ast.Expression, int]]] = {}
        """Expressions of port periods that are not longer than zero, with their values in nanoseconds."""
        self._refused_offsets: set[Span] = set()
        self._known: dict[object, Shape] = {}
        self._pending: list[Shape] = []

    def root(self, definition: ast.ProcessDefinition, values: Mapping[str, Value], overrides: Overrides) -> Shape:
        """The shape of an outermost process with the given values of parameters; makes the shapes of all instances
        inside it, too.
        """
        parameters: dict[ast.Node, Value] = {
            p: values[p.name.text] for p in definition.parameters if p.name.text in values
        }
        shape = self.shape(definition, parameters, overrides)
        while self._pending:
            self._fill(self._pending.pop())
        return shape

    def shape(self, definition: Instantiable, parameters: Values, overrides: Overrides) -> Shape:
        """The shape for these values of the structural parameters; at first it has only its ports."""
        structural = self.definitions.structural(definition)
        own: dict[ast.Node, Value] = {
            p: parameters[p] for p in definition.parameters if p.name.text in structural and p in parameters
        }
        key = (definition, tuple(own.items()), tuple(sorted(overrides.items())))
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = Shape(definition, own, overrides)
            self._ports(known)
            self.shapes.append(known)
            if isinstance(definition, ast.ProcessDefinition):
                self._pending.append(known)
        return known

    def sampling(self, ports: ast.Ports, shape: Shape) -> Sampling | None:
        """The sample instants of a port declaration; unknown if they are refused. A refused period is
        reported later.
        """
        if ports.sampling is None:
            return None
        period = self._time(ports.sampling.period, shape)
        offset = 0 if ports.sampling.offset is None else self._time(ports.sampling.offset, shape)
        if period is not None and period <= 0:
            self.refused_periods.setdefault(shape, []).append((ports.sampling.period, period))
        elif period is not None and offset is not None:
            if 0 <= offset < period:
                return Sampling(period, offset)
            assert ports.sampling.offset is not None
            self._refuse_offset(OffsetOutsidePeriod(ports.sampling.offset.span, offset=offset, period=period))
        return UNKNOWN_SAMPLING

    def _time(self, expression: ast.Expression, shape: Shape) -> int | None:
        """The value of a time in nanoseconds; None if it is not known."""
        if isinstance(expression, ast.Duration):
            return expression.nanoseconds
        value = evaluate(self.program, expression, shape.values, self.report)
        return value if isinstance(value, int) and not isinstance(value, bool) else None

    def _refuse_offset(self, diagnostic: OffsetOutsidePeriod) -> None:
        """Reports a refused offset, once for each place in the text."""
        if diagnostic.span not in self._refused_offsets:
            self._refused_offsets.add(diagnostic.span)
            self.report.add(diagnostic)

    def _ports(self, shape: Shape) -> None:
        scope = self.program.scopes.get(shape.definition)
        if scope is None:
            shape.incomplete = True
            return
        for symbol in scope.ports.values():
            port = self._port(symbol, shape)
            if port is not None:
                shape.ports[port.name] = port
            else:
                shape.incomplete = True

    def _port(self, symbol: PortSymbol, shape: Shape) -> PortShape | None:
        size: int | None = None
        if symbol.port.dimensions:
            total = 1
            for dimension in symbol.port.dimensions:
                known = self.sizes.size(dimension, f"the array of ports `{symbol.name}`", shape.values)
                if known is None:
                    return None
                total *= known
            size = total
        return PortShape(
            symbol=symbol,
            name=symbol.name,
            direction=symbol.declaration.direction,
            type=self.sizes.type_of(symbol.declaration.type, symbol.type, shape.values),
            size=size,
            sampling=self.sampling(symbol.declaration, shape),
        )

    def _fill(self, shape: Shape) -> None:
        definition = shape.definition
        assert isinstance(definition, ast.ProcessDefinition)
        if definition.external is not None or definition in self.definitions.recursive:
            shape.incomplete = shape.incomplete or definition in self.definitions.recursive
            return
        elements = _Declarations(self, shape)
        if definition.communication is not None:
            elements.instances(definition.communication.declarations, (), shape.values)
        places = Places(self.sizes, shape, elements.loops)
        if definition.communication is not None:
            connect(self.sizes, shape, places, definition.communication.declarations)
        if definition.composition is not None:
            shape.body = compose(self.sizes, shape, places, definition.composition)


class _Declarations:
    """Makes the instances of a shape, including those inside ``for``."""

    def __init__(self, elaboration: Elaboration, shape: Shape) -> None:
        self.elaboration = elaboration
        self.shape = shape
        self.loops: dict[ast.Node, tuple[ast.Replicator, ...]] = {}
        """The replicators around each declaration."""

    def instances(
        self, declarations: Iterable[ast.Declaration], loops: tuple[ast.Replicator, ...], values: Values
    ) -> None:
        for item in declarations:
            self.loops[item] = loops
            if isinstance(item, ast.Instance):
                self._instance(item, tuple(_index(values, loop) for loop in loops), values)
            elif isinstance(item, ast.RepeatedDeclarations):
                repetitions = self.elaboration.sizes.repeated(item.replicator, "`for`", values)
                self.shape.incomplete = self.shape.incomplete or repetitions is None
                for inner in repetitions or ():
                    self.instances(item.declarations, (*loops, item.replicator), inner)

    def _instance(self, item: ast.Instance, prefix: tuple[int, ...], values: Values) -> None:
        definition = self.elaboration.definitions.instantiated(item)
        if definition is None or item in self.elaboration.program.poisoned:
            self.shape.incomplete = True
            return
        name = item.name.text
        if item.size is None:
            self._element(item, definition, name, prefix, values)
            return
        replicator = item.size if isinstance(item.size, ast.Replicator) else None
        expression = item.size.count if isinstance(item.size, ast.Replicator) else item.size
        count = self.elaboration.sizes.size(expression, f"the array of instances `{name}`", values)
        if count is None:
            self.shape.incomplete = True
            return
        for index in range(count):
            inner = values if replicator is None else {**values, replicator: index}
            self._element(item, definition, name, (*prefix, index), inner)

    def _element(
        self, item: ast.Instance, definition: Instantiable, name: str, indexes: tuple[int, ...], values: Values
    ) -> None:
        full = element_name(name, *indexes)
        overrides = _below(self.shape.overrides, full)
        parameters = self._arguments(item, definition, values, overrides)
        self.shape.instances[full] = InstanceShape(
            name=full,
            array=element_name(name, *indexes[:-1]) if indexes else None,
            index=indexes[-1] if indexes else None,
            declaration=item,
            shape=self.elaboration.shape(definition, parameters, overrides),
            replicators={node: value for node, value in values.items() if isinstance(node, ast.Replicator)} or EMPTY,
            overrides=overrides,
            attachments={},
        )

    def _arguments(
        self, item: ast.Instance, definition: Instantiable, values: Values, overrides: Overrides
    ) -> dict[ast.Node, Value]:
        """The values of the structural parameters of an instance, as far as they are known."""
        structural = self.elaboration.definitions.structural(definition)
        if not structural:
            return {}
        return argument_values(self.elaboration, item, definition, values, overrides, structural)


def argument_values(
    elaboration: Elaboration,
    item: ast.Instance,
    definition: Instantiable,
    values: Values,
    overrides: Overrides,
    wanted: frozenset[str] | None = None,
) -> dict[ast.Node, Value]:
    """The values of the parameters of an instance (or of the ``wanted`` ones), including defaults, as far as they are
    known.
    """
    given = dict(arguments_of(definition.parameters, item.arguments))
    found: dict[ast.Node, Value] = {}
    for parameter in definition.parameters:
        name = parameter.name.text
        if wanted is not None and name not in wanted:
            continue
        value: Value | None = overrides.get(name)
        if value is None and parameter in given:
            value = parameter_value(elaboration, parameter, given[parameter], values)
        elif value is None and parameter.default is not None:
            value = parameter_value(elaboration, parameter, parameter.default, found)
        if value is not None:
            found[parameter] = value
    return found


def parameter_value(
    elaboration: Elaboration, parameter: ast.Parameter, expression: ast.Expression, values: Values
) -> Value | None:
    """The value of an argument or a default; a frequency literal for a ``time`` means its period."""
    if isinstance(expression, ast.Duration) and parameter.type.name.text == "time":
        return expression.nanoseconds
    return evaluate(elaboration.program, expression, values, elaboration.report)


def _index(values: Values, loop: ast.Replicator) -> int:
    index = values[loop]
    assert isinstance(index, int)
    return index


def _below(overrides: Overrides, instance: str) -> Overrides:
    """The overrides of an instance: ``{"alignL.speed": v}`` below ``alignL`` is ``{"speed": v}``."""
    if not overrides:
        return overrides
    prefix = instance + "."
    return {path[len(prefix) :]: value for path, value in overrides.items() if path.startswith(prefix)}
