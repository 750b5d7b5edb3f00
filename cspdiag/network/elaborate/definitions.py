"""The graph of definitions: which definition instantiates which, in what order they are elaborated, and which
parameters determine the shape of a definition.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.model.program import Program
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declared_in, names, nodes

Instantiable = ast.ProcessDefinition | ast.SubmodelDefinition


class Definitions:
    """The processes and submodels of a program, callees first."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.processes = [d for d in program.definitions.values() if isinstance(d, ast.ProcessDefinition)]
        self.recursive: set[ast.ProcessDefinition] = set()
        self.order: list[ast.ProcessDefinition] = []
        self._sort()
        self._structural: dict[Instantiable, frozenset[str]] = {}
        for definition in self.order:
            self._structural[definition] = self._with_defaults(definition, self._find_structural(definition))

    def instantiated(self, instance: ast.Instance) -> Instantiable | None:
        """The definition of an instance; None if it was reported as unknown."""
        found = self.program.bindings.get(instance.definition)
        return found if isinstance(found, ast.ProcessDefinition | ast.SubmodelDefinition) else None

    def structural(self, definition: Instantiable) -> frozenset[str]:
        """Names of the parameters that sizes, indexes, periods and capacities depend on."""
        known = self._structural.get(definition)
        if known is None:
            known = self._structural[definition] = self._with_defaults(
                definition, self._parameters_in(_port_expressions(definition))
            )
        return known

    def roots(self) -> list[ast.ProcessDefinition]:
        """The processes that no other process instantiates, in text order."""
        inner = {
            self.instantiated(item)
            for definition in self.processes
            for item in declared_in(definition)
            if isinstance(item, ast.Instance)
        }
        return [d for d in self.processes if d not in inner and d not in self.recursive]

    def outermost(self) -> ast.ProcessDefinition | None:
        """The outermost process of a program without an environment: the last one of the main file that is not
        instantiated and that no assertion names as a specification.

        If the main file has no such process, it is a specification, or else a process of an imported file.
        """
        roots = self.roots()
        main = set(self.program.main.items)
        own = [root for root in roots if root in main]
        candidates = [root for root in own if not self.is_specification(root)] or own or roots
        return candidates[-1] if candidates else None

    def is_specification(self, definition: ast.ProcessDefinition) -> bool:
        """Whether some assertion names the process as a specification."""
        return any(
            assertion.specification is not None and assertion.specification.text == definition.name.text
            for assertion in self.program.assertions
        )

    def _sort(self) -> None:
        """Sorts depth first, without recursion; a process found again on its own path contains itself, which the model
        reports.
        """
        finished: set[ast.ProcessDefinition] = set()
        for root in self.processes:
            if root in finished:
                continue
            path: dict[ast.ProcessDefinition, ast.Instance | None] = {root: None}
            stack: list[tuple[ast.ProcessDefinition, Iterator[ast.Instance]]] = [(root, self._inside(root))]
            while stack:
                definition, remaining = stack[-1]
                instance = next(remaining, None)
                if instance is None:
                    stack.pop()
                    del path[definition]
                    finished.add(definition)
                    self.order.append(definition)
                    continue
                callee = self.instantiated(instance)
                if not isinstance(callee, ast.ProcessDefinition) or callee in finished:
                    continue
                if callee in path:
                    cycle = list(path)
                    self.recursive.update(cycle[cycle.index(callee) :])
                else:
                    path[callee] = instance
                    stack.append((callee, self._inside(callee)))

    def _inside(self, definition: ast.ProcessDefinition) -> Iterator[ast.Instance]:
        return (item for item in declared_in(definition) if isinstance(item, ast.Instance))

    def _find_structural(self, definition: ast.ProcessDefinition) -> Iterator[str]:
        if not definition.parameters:
            return
        yield from self._parameters_in(_port_expressions(definition))
        for item in declared_in(definition):
            match item:
                case ast.Instance():
                    yield from self._parameters_in(self._instance_expressions(item))
                case ast.Variable():
                    yield from self._parameters_in(item.type.dimensions)
                case ast.Channel():
                    yield from self._parameters_in(item.type.dimensions)
                    if item.kind is not None:
                        yield from self._parameters_in((item.kind,))
                case ast.Connection():
                    yield from self._parameters_in(_connection_expressions(item))
                case ast.RepeatedDeclarations():
                    yield from self._parameters_in((item.replicator.count,))
        for part in nodes(definition.composition):
            match part:
                case ast.Reference():
                    yield from self._parameters_in((*part.indexes, *part.member_indexes))
                case ast.Replicator():
                    yield from self._parameters_in((part.count,))
                case _:
                    pass  # No other part has a size.

    def _with_defaults(self, definition: Instantiable, found: Iterable[str]) -> frozenset[str]:
        """The parameters found, with those that their defaults use, which precede them."""
        whole = set(found)
        for parameter in reversed(definition.parameters):
            if parameter.name.text in whole and parameter.default is not None:
                whole.update(self._parameters_in((parameter.default,)))
        return frozenset(whole)

    def _instance_expressions(self, instance: ast.Instance) -> Iterator[ast.Node]:
        size = instance.size
        if size is not None:
            yield size.count if isinstance(size, ast.Replicator) else size
        callee = self.instantiated(instance)
        if callee is None or callee in self.recursive:
            return
        structural = self.structural(callee)
        if not structural:
            return
        for parameter, argument in arguments_of(callee.parameters, instance.arguments):
            if parameter.name.text in structural:
                yield argument

    def _parameters_in(self, expressions: Iterable[ast.Node]) -> Iterator[str]:
        for name in names(expressions):
            symbol = self.program.bindings.get(name)
            if isinstance(symbol, ast.Parameter):
                yield symbol.name.text


def _port_expressions(definition: Instantiable) -> Iterator[ast.Expression]:
    for ports in definition.ports:
        yield from ports.type.dimensions
        if ports.sampling is not None:
            yield ports.sampling.period
            if ports.sampling.offset is not None:
                yield ports.sampling.offset
        for name in ports.names:
            yield from name.dimensions


def _connection_expressions(item: ast.Connection) -> Iterator[ast.Node]:
    for end in (*item.sources, *item.sinks):
        if isinstance(end, ast.Reference):
            yield from end.indexes
            yield from end.member_indexes
    if item.kind is not None:
        yield item.kind
    if item.type is not None:
        yield from item.type.dimensions


def arguments_of(
    parameters: tuple[ast.Parameter, ...], arguments: tuple[ast.Argument, ...]
) -> list[tuple[ast.Parameter, ast.Expression]]:
    """The parameters that get an argument, positional ones first, each with its argument.

    Arguments that do not fit have been reported by the model, and are left out.
    """
    by_name = {parameter.name.text: parameter for parameter in parameters}
    positional = iter(parameters)
    given: list[tuple[ast.Parameter, ast.Expression]] = []
    for argument in arguments:
        parameter = next(positional, None) if argument.name is None else by_name.get(argument.name.text)
        if parameter is not None:
            given.append((parameter, argument.value))
    return given
