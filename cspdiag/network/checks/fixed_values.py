"""Where a value has to be known when a program is compiled, and so cannot follow a parameter of the program."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial

from cspdiag.base import Report
from cspdiag.model.program import Program
from cspdiag.model.remembered import ALWAYS, Checks
from cspdiag.network.diagnostics.usage import MayChange
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes

_OPERATORS = {"delay": (1,), "transfer": (0, 1), "statespace": (0, 1, 2, 3)}
"""The arguments of operators whose coefficients are computed when the program is compiled, by position."""

_CHECKED = {**_OPERATORS, "lag": (1,)}
"""Those, and the arguments for which some values are refused when the program is compiled."""

_Place = tuple[ast.Node, str]
"""An expression, and what its value is."""


def check_fixed_values(program: Program, report: Report, checks: Checks = ALWAYS) -> None:
    """Report parameters of the program, and constants that follow from them, where a value must not change."""
    if not program.tunable:
        return
    search = FixedPlaces(program)
    for definition in program.definitions.values():
        checks.result("fixed values", definition, "", partial(_check, program, search, definition), report)


def _check(program: Program, search: FixedPlaces, definition: ast.Definition, report: Report) -> None:
    for expression, what in search.places(definition):
        for name in names((expression,)):
            symbol = program.bindings.get(name)
            if isinstance(symbol, ast.Constant) and symbol in program.tunable and name not in program.poisoned:
                program.poisoned.add(name)
                origin = _origin(program, symbol)
                report.add(
                    MayChange(
                        name.span,
                        name=symbol.name.text,
                        what=what,
                        parameter=origin.name.text,
                        declared=origin.name.span,
                    )
                )


def _origin(program: Program, constant: ast.Constant) -> ast.Constant:
    """The parameter that a constant follows from, the first one in its text."""
    while not constant.tunable:
        symbols = (program.bindings.get(name) for name in names((constant.value,)))
        constant = next(one for one in symbols if isinstance(one, ast.Constant) and one in program.tunable)
    return constant


class FixedPlaces:
    """The places of a program where values have to be known when it is compiled; if ``checked`` also those where some
    values are refused then, and would not be later.
    """

    def __init__(self, program: Program, *, checked: bool = False) -> None:
        self.program = program
        self._operators = _CHECKED if checked else _OPERATORS
        self._fixed: dict[ast.Node, dict[ast.Parameter, str]] = {}
        """For each definition its parameters that need fixed values, with what they are."""

    def places(self, definition: ast.Definition) -> Iterator[_Place]:
        """The expressions of a definition that need fixed values."""
        yield from self._clauses(definition)
        for part in nodes(definition):
            yield from self._of(part)
        if isinstance(definition, ast.EnvironmentDefinition):
            callee = self.program.bindings.get(definition.process)
            yield from self._arguments(callee, definition.arguments)

    def _clauses(self, definition: ast.Definition) -> Iterator[_Place]:
        match definition:
            case ast.ProcessDefinition(wcet=wcet):
                yield from _given((wcet,), "a computing time, which only analyses use")
            case ast.SubmodelDefinition(wcet=wcet, step=step):
                yield from _given((wcet,), "a computing time, which only analyses use")
                yield from _given((step,), "the step of an integration")
            case ast.EnvironmentDefinition(step=step):
                yield from _given((step,), "the step of an environment")
            case _:  # Other definitions have no clauses.
                pass

    def _of(self, part: ast.Node) -> Iterator[_Place]:
        match part:
            case ast.TypeName(dimensions=sizes):
                yield from _given(sizes, "the size of an array")
            case ast.PortName(dimensions=sizes):
                yield from _given(sizes, "the size of an array of ports")
            case ast.Sampling(period=period, offset=offset):
                yield from _given((period, offset), "a sample instant, on which the schedule depends")
            case ast.Ports(default=default, safe=safe):
                yield from _given((default,), "the default of a port, which is made part of the connections")
                yield from _given((safe,), "a safe value, which has to be known whatever happens")
            case ast.Replicator(count=count):
                yield from _given((count,), "a number of elements")
            case ast.Channel(kind=kind) | ast.Connection(kind=kind):
                yield from _given((kind,), "the size of a buffer")
            case ast.Reference(indexes=indexes, member_indexes=inner):
                if not isinstance(self.program.bindings.get(part), ast.Variable):
                    yield from _given(indexes, "the index of an element of the diagram")
                yield from _given(inner, "the index of an element of the diagram")
            case ast.Member(value=ast.Index(value=ast.Name() as owner, index=index)):
                if isinstance(self.program.bindings.get(owner), ast.Instance):
                    yield from _given((index,), "the index of an element of the diagram")
            case ast.Call(function=function, arguments=arguments):
                wanted = self._operators.get(function.text, ())
                chosen = [argument.value for at, argument in enumerate(arguments) if at in wanted]
                yield from _given(chosen, "a coefficient that is computed when the program is compiled")
            case ast.Instance():
                if part.size is not None and not isinstance(part.size, ast.Replicator):
                    yield from _given((part.size,), "a number of elements")
                yield from self._arguments(self.program.bindings.get(part.definition), part.arguments)
            case _:  # No other part needs a fixed value.
                pass

    def _arguments(self, callee: object, arguments: tuple[ast.Argument, ...]) -> Iterator[_Place]:
        if not isinstance(callee, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
            return
        fixed = self.parameters(callee)
        for parameter, argument in arguments_of(callee.parameters, arguments):
            if parameter in fixed:
                yield argument, f"`{parameter.name.text}` of `{callee.name.text}`: {fixed[parameter]}"

    def parameters(
        self, definition: ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition
    ) -> dict[ast.Parameter, str]:
        """The parameters of a definition that need fixed values, with what they are."""
        known = self._fixed.get(definition)
        if known is not None:
            return known
        found: dict[ast.Parameter, str] = {}
        self._fixed[definition] = found
        if definition.external is not None:
            what = "an argument of a body in another language, which is given it once"
            found.update(dict.fromkeys(definition.parameters, what))
            return found
        for expression, what in self.places(definition):
            for name in names((expression,)):
                symbol = self.program.bindings.get(name)
                if isinstance(symbol, ast.Parameter) and symbol in definition.parameters:
                    found.setdefault(symbol, what.partition("`: ")[2] or what)
        for parameter in reversed(definition.parameters):
            if parameter in found and parameter.default is not None:
                for name in names((parameter.default,)):
                    symbol = self.program.bindings.get(name)
                    if isinstance(symbol, ast.Parameter):
                        found.setdefault(symbol, found[parameter])
        return found


def _given(expressions: Iterable[ast.Node | None], what: str) -> Iterator[_Place]:
    for expression in expressions:
        if expression is not None:
            yield expression, what
