"""Definitions of the tree."""

from __future__ import annotations

from typing import Any, TypeAlias, cast

from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.common import as_tuple, declared, node
from cspdiag.syntax.build.communication import CommunicationBuilder
from cspdiag.syntax.build.composition import CompositionBuilder
from cspdiag.syntax.diagnostics.tokens import MisplacedClause, RepeatedClause
from cspdiag.syntax.parse.lexer import Token


@record
class Option:
    """One clause of the head of a definition."""

    span: Span
    name: str
    value: Any


_CLAUSES = {
    "external": "an external body",
    "wcet": "`wcet`",
    "step": "`step`",
    "method": "`method`",
    "on_miss": "`on miss`",
}


Names: TypeAlias = tuple[ast.Identifier, ...]


class DefinitionBuilder(CommunicationBuilder, CompositionBuilder):
    """The rules of definitions and of the equations of submodels."""

    start = as_tuple  # A file

    def import_file(self, span: Span, path: Token) -> ast.Import:
        """``import "laws.csp"``."""
        return ast.Import(span=span, path=path.text[1:-1], library=None)

    def import_library(self, span: Span, *names: ast.Identifier) -> ast.Import:
        """``import std.control``."""
        return ast.Import(span=span, path=None, library=".".join(name.text for name in names))

    constant = declared(ast.Constant, "name", "type", "value")  # const name = value
    tunable = declared(ast.Constant, "name", "type", "value", tunable=True)  # parameter name = value
    type_alias = declared(ast.TypeAliasDefinition, "name", "type")  # type Angle = double<rad>

    def enum(self, span: Span, name: ast.Identifier, *literals: ast.Identifier) -> ast.EnumDefinition:
        """``enum Mode { idle, run }``."""
        return ast.EnumDefinition(span=span, doc=self.doc(span.start), name=name, literals=literals)

    def struct(self, span: Span, name: ast.Identifier, *fields: ast.Field) -> ast.StructDefinition:
        """``struct Pose { x: double  y: double }``."""
        return ast.StructDefinition(span=span, doc=self.doc(span.start), name=name, fields=fields)

    field = declared(ast.Field, "name", "type")  # A field of a struct
    exception = declared(ast.ExceptionDefinition, "name")  # exception Overheated
    parameters = as_tuple  # Parameters in parentheses
    parameter = declared(ast.Parameter, "name", "type", "default")  # speed: double<rad/s> = 0.5<rad/s>

    def external(self, span: Span, language: ast.Identifier, target: Token) -> Option:
        """``python "plant.py:Joint"``."""
        body = ast.External(span=span, language=language, target=target.text[1:-1], target_span=target.span)
        return Option(span, "external", body)

    def wcet(self, span: Span, duration: ast.Expression) -> Option:
        """``wcet 120 us``."""
        return Option(span, "wcet", duration)

    def step(self, span: Span, duration: ast.Expression) -> Option:
        """``step 1 ms``."""
        return Option(span, "step", duration)

    def method(self, span: Span, name: ast.Identifier) -> Option:
        """``method = tustin``."""
        return Option(span, "method", name)

    def on_miss(self, span: Span, reaction: ast.Identifier) -> Option:
        """``on miss count``."""
        return Option(span, "on_miss", reaction)

    def place(self, span: Span, name: ast.Identifier, *instances: ast.Identifier) -> ast.Place:
        """``place pan : horizontal``."""
        return ast.Place(span=span, name=name, instances=instances)

    options = as_tuple  # The clauses of a head
    environment_options = as_tuple  # The clauses of the head of an environment

    def _clauses(self, definition: str, options: tuple[Option, ...], *allowed: str) -> dict[str, Any]:
        """The clauses by name, None if absent; repeated clauses and clauses that are not allowed here are reported."""
        clauses: dict[str, Any] = dict.fromkeys(allowed)
        for option in options:
            if option.name not in clauses:
                self.report.add(MisplacedClause(option.span, _CLAUSES[option.name], definition))
            elif clauses[option.name] is not None:
                first = next(other.span.text for other in options if other.name == option.name)
                same = first == option.span.text
                self.report.add(RepeatedClause(option.span, _CLAUSES[option.name], definition, same))
            else:
                clauses[option.name] = option.value
        return clauses

    def process(
        self,
        span: Span,
        name: ast.Identifier,
        parameters: tuple[ast.Parameter, ...] | None,
        options: tuple[Option, ...],
        ports: tuple[ast.Ports, ...],
        communication: ast.Communication | None,
        composition: tuple[Span, ast.Composition] | None,
    ) -> ast.ProcessDefinition:
        """A process."""
        return ast.ProcessDefinition(
            span=span,
            doc=self.doc(span.start),
            name=name,
            parameters=parameters or (),
            **self._clauses("process", options, "external", "wcet"),
            ports=ports,
            communication=communication,
            composition=None if composition is None else composition[1],
            composition_span=None if composition is None else composition[0],
        )

    def submodel(
        self,
        span: Span,
        name: ast.Identifier,
        parameters: tuple[ast.Parameter, ...] | None,
        options: tuple[Option, ...],
        ports: tuple[ast.Ports, ...],
        items: tuple[ast.SubmodelItem, ...],
    ) -> ast.SubmodelDefinition:
        """A submodel."""
        return ast.SubmodelDefinition(
            span=span,
            doc=self.doc(span.start),
            name=name,
            parameters=parameters or (),
            **self._clauses("submodel", options, "external", "wcet", "step", "method"),
            ports=ports,
            items=items,
        )

    def driver(
        self,
        span: Span,
        name: ast.Identifier,
        parameters: tuple[ast.Parameter, ...] | None,
        options: tuple[Option, ...],
        ports: tuple[ast.Ports, ...],
    ) -> ast.DriverDefinition:
        """A driver."""
        return ast.DriverDefinition(
            span=span,
            doc=self.doc(span.start),
            name=name,
            parameters=parameters or (),
            **self._clauses("driver", options, "external"),
            ports=ports,
        )

    def environment(
        self,
        span: Span,
        name: ast.Identifier,
        process: ast.Identifier,
        arguments: tuple[ast.Argument, ...] | None,
        options: tuple[Option | ast.Place, ...],
        declarations: tuple[ast.Declaration, ...],
    ) -> ast.EnvironmentDefinition:
        """An environment."""
        clauses = tuple(option for option in options if isinstance(option, Option))
        return ast.EnvironmentDefinition(
            span=span,
            doc=self.doc(span.start),
            name=name,
            process=process,
            arguments=arguments or (),
            **self._clauses("environment", clauses, "step", "on_miss"),
            places=tuple(option for option in options if isinstance(option, ast.Place)),
            declarations=declarations,
        )

    def assertion(self, span: Span, process: ast.Identifier, claim: tuple[Any, ...]) -> ast.Assertion:
        """``assert P deadlock free``."""
        claimed, *rest = claim
        specification, model, hidden = cast("Any", rest or (None, "traces", ()))
        return ast.Assertion(
            span=span,
            doc=self.doc(span.start),
            process=process,
            property=claimed,
            specification=specification,
            model=model,
            hidden=hidden,
        )

    def deadlock_free(self, span: Span) -> tuple[str]:
        """``deadlock free``."""
        return ("deadlock free",)

    def livelock_free(self, span: Span) -> tuple[str]:
        """``livelock free``."""
        return ("livelock free",)

    def terminates(self, span: Span) -> tuple[str]:
        """``terminates``."""
        return ("terminates",)

    def schedulable(self, span: Span) -> tuple[str]:
        """``schedulable``."""
        return ("schedulable",)

    def refines_traces(self, span: Span, specification: ast.Identifier, hidden: Names) -> tuple[object, ...]:
        """``refines Q``."""
        return "refines", specification, "traces", hidden

    def refines_failures(self, span: Span, specification: ast.Identifier, hidden: Names) -> tuple[object, ...]:
        """``refines Q in failures``."""
        return "refines", specification, "failures", hidden

    hidden = as_tuple  # hide a, b, or nothing
    equations = as_tuple  # The contents of a submodel after its ports
    let = declared(ast.Let, "name", "value")  # let name = value
    state = declared(ast.State, "name", "type", "initial")  # state name : type = initial
    next = node(ast.Next, "name", "value")  # next name = value
    derivative = node(ast.Derivative, "name", "value")  # der name = value
    equation = node(ast.Equation, "target", "value")  # target = value
