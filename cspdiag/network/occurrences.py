"""Occurrences: the instances of a program with the values of all their parameters; equal ones are one occurrence."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from cspdiag.base import Report
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program, Value
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.elaborate.definitions_to_shapes import Elaboration, argument_values
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.shapes import Default, InstanceShape
from cspdiag.network.submodels.classes import Flattened, LawUse, flatten
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names


class Occurrence:
    """A process in a context with the values of its parameters.

    ``derived`` are values of derived parameters that its class needs for instances inside it; ``tunable`` are the names
    of parameters that have no value, because they follow parameters of the program.
    """

    __slots__ = ("children", "derived", "placed", "tunable", "values")

    def __init__(self, placed: Placed, values: dict[ast.Node, Value], tunable: frozenset[str]) -> None:
        self.placed = placed
        self.values = values
        self.tunable = tunable
        self.children: dict[str, Occurrence | LawOccurrence] = {}
        self.derived: dict[str, Value] = {}

    @property
    def definition(self) -> ast.ProcessDefinition:
        """The definition that this is an instance of."""
        assert isinstance(self.placed.shape.definition, ast.ProcessDefinition)
        return self.placed.shape.definition

    def arguments(self) -> dict[str, Value]:
        """The values of all parameters by name, including derived ones."""
        return {**values_by_name(self.values), **self.derived}


class LawOccurrence:
    """A submodel instance: the values of its parameters and, once ``Occurrences.flatten`` has made it, its class.

    ``sample`` is its period in nanoseconds, if known; ``overrides`` are values set from outside for parameters inside
    it, by path; ``tunable`` is as for ``Occurrence``.
    """

    __slots__ = ("definition", "flattened", "overrides", "sample", "tunable", "values")

    flattened: Flattened

    def __init__(
        self,
        definition: ast.SubmodelDefinition,
        values: Mapping[ast.Node, Value],
        sample: int | None,
        overrides: Mapping[str, Value],
        tunable: frozenset[str],
    ) -> None:
        self.definition = definition
        self.values = values
        self.sample = sample
        self.overrides = overrides
        self.tunable = tunable

    @property
    def derived(self) -> Mapping[str, Value]:
        """The values of the derived parameters."""
        return self.flattened.derived

    @property
    def use(self) -> LawUse:
        """The data that the class is made from."""
        return LawUse(self.definition, values_by_name(self.values), self.sample, self.overrides, self.tunable)

    def arguments(self) -> dict[str, Value]:
        """The values of all parameters by name."""
        return {**values_by_name(self.values), **self.derived}


class Occurrences:
    """All occurrences below an outermost process, enclosing ones first."""

    def __init__(self, program: Program, elaboration: Elaboration, report: Report) -> None:
        self.program = program
        self.elaboration = elaboration
        self.report = report
        self.found: list[Occurrence] = []
        self._known: dict[object, Occurrence] = {}
        self._laws: dict[object, LawOccurrence] = {}
        self._pending: list[Occurrence] = []

    def outermost(self, placed: Placed, values: dict[ast.Node, Value], tunable: frozenset[str]) -> Occurrence:
        """The occurrence of the outermost process, with everything inside it."""
        top = self._occurrence(placed, values, tunable)
        while self._pending:
            self._fill(self._pending.pop())
        return top

    @property
    def laws(self) -> Iterable[LawOccurrence]:
        """The submodel instances, equal ones once."""
        return self._laws.values()

    def flatten(self) -> bool:
        """Makes the class of every submodel instance; returns False if errors were reported."""
        for law in self._laws.values():
            made = flatten(self.program, law.use, self.report)
            if made is not None:
                law.flattened = made
        return not self.report.has_errors

    def _occurrence(self, placed: Placed, values: dict[ast.Node, Value], tunable: frozenset[str]) -> Occurrence:
        key = (placed, tuple(values.items()), tunable)
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = Occurrence(placed, values, tunable)
            self.found.append(known)
            self._pending.append(known)
        return known

    def _fill(self, occurrence: Occurrence) -> None:
        placed = occurrence.placed
        self._examine_variables(occurrence)
        for name, instance in placed.shape.instances.items():
            tunable = self._tunable(occurrence, instance)
            values = self._values(occurrence, instance)
            if tunable:
                values = {
                    node: value
                    for node, value in values.items()
                    if not (isinstance(node, ast.Parameter) and node.name.text in tunable)
                }
            self._examine_defaults(instance, values)
            if instance.shape.is_submodel:
                occurrence.children[name] = self._law(instance, values, placed.samples.get(name), tunable)
            else:
                occurrence.children[name] = self._occurrence(placed.inside[name], values, tunable)

    def _examine_variables(self, occurrence: Occurrence) -> None:
        """Reports initial values of variables, which are computed before the program runs, that overflow or are not
        defined.
        """
        for channel in occurrence.placed.shape.channels.values():
            declaration = channel.declaration
            if isinstance(declaration, ast.Variable) and not isinstance(channel.initial, LiteralValue | None):
                assert declaration.initial is not None
                known: dict[ast.Node, Value] = dict(self.program.tunable.items())
                values = {**known, **occurrence.values, **channel.replicators}
                evaluate(self.program, declaration.initial, values, self.report)

    def _examine_defaults(self, instance: InstanceShape, values: dict[ast.Node, Value]) -> None:
        """Reports defaults of unconnected inputs that overflow or are not defined."""
        for element in instance.shape.defaults:
            if isinstance(instance.attachments[element].target, Default):
                default = instance.shape.ports[element[0]].symbol.declaration.default
                assert default is not None
                evaluate(self.program, default, values, self.report)

    def _values(self, occurrence: Occurrence, instance: InstanceShape) -> dict[ast.Node, Value]:
        definition = instance.shape.definition
        if not definition.parameters:
            return {}
        around = {**occurrence.values, **instance.replicators}
        return argument_values(self.elaboration, instance.declaration, definition, around, instance.overrides)

    def _tunable(self, occurrence: Occurrence, instance: InstanceShape) -> frozenset[str]:
        arguments, settings = instance.declaration.arguments, instance.overrides
        parameters = instance.shape.definition.parameters
        return tunable_parameters(self.program, parameters, arguments, settings, occurrence.tunable)

    def _law(
        self, instance: InstanceShape, values: dict[ast.Node, Value], sample: int | None, tunable: frozenset[str]
    ) -> LawOccurrence:
        definition = instance.shape.definition
        assert isinstance(definition, ast.SubmodelDefinition)
        inside = {path: value for path, value in instance.overrides.items() if "." in path}
        key = (definition, tuple(values.items()), sample, tuple(inside.items()), tunable)
        if key not in self._laws:
            self._laws[key] = LawOccurrence(definition, values, sample, inside, tunable)
        return self._laws[key]


def instance_names(outermost: Occurrence) -> Iterator[str]:
    """The paths of all instances in a process and in its submodels, in text order; those of submodels include other
    names, too.
    """
    pending: list[tuple[str, Occurrence | LawOccurrence]] = [("", outermost)]
    while pending:
        prefix, occurrence = pending.pop()
        if isinstance(occurrence, LawOccurrence):
            yield from (f"{prefix}{name}" for name in sorted(occurrence.flattened.names))
            continue
        for name in occurrence.children:
            yield f"{prefix}{name}"
        pending.extend((f"{prefix}{name}.", child) for name, child in occurrence.children.items())


def values_by_name(values: Mapping[ast.Node, Value]) -> dict[str, Value]:
    """The values of parameters by their names, in order."""
    return {node.name.text: value for node, value in values.items() if isinstance(node, ast.Parameter)}


def tunable_parameters(
    program: Program,
    parameters: tuple[ast.Parameter, ...],
    arguments: tuple[ast.Argument, ...],
    settings: Collection[str],
    around: frozenset[str] = frozenset(),
) -> frozenset[str]:
    """The names of the parameters of an instance whose arguments follow parameters of the program, given those
    ``around`` it; those that ``settings`` set do not.
    """
    if not program.tunable:
        return frozenset()
    given = dict(arguments_of(parameters, arguments))
    found: set[str] = set()
    for parameter in parameters:
        name = parameter.name.text
        if name in settings:
            continue
        if parameter in given:
            follows = _is_tunable(program, given[parameter], around)
        else:
            follows = _is_tunable(program, parameter.default, found)
        if follows:
            found.add(name)
    return frozenset(found)


def _is_tunable(program: Program, expression: ast.Expression | None, around: Collection[str]) -> bool:
    if isinstance(expression, ast.Number | ast.Duration | None):
        return False
    for name in names((expression,)):
        symbol = program.bindings.get(name)
        if symbol in program.tunable or (isinstance(symbol, ast.Parameter) and symbol.name.text in around):
            return True
    return False
