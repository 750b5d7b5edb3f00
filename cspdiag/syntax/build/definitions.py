"""Definitions of the tree."""

from __future__ import annotations

from typing import Any, TypeAlias, cast

from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.communication import CommunicationBuilder
from cspdiag.syntax.build.composition import CompositionBuilder
from cspdiag.syntax.diagnostics.tokens import OptionNotHere, OptionTwice
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

    def start(self, span: Span, *items: ast.Item) -> tuple[ast.Item, ...]:
        """A file."""
        return items

    def import_file(self, span: Span, path: Token) -> ast.Import:
        """``import "laws.csp"``."""
        return ast.Import(span=span, path=path.text[1:-1], library=None)

    def import_library(self, span: Span, *names: ast.Identifier) -> ast.Import:
        """``import std.control``."""
        return ast.Import(span=span, path=None, library=".".join(name.text for name in names))

    def constant(
        self, span: Span, name: ast.Identifier, constant_type: ast.TypeName | None, value: ast.Expression
    ) -> ast.Constant:
        """``const name = value``."""
        return ast.Constant(span=span, doc=self.doc(span.start), name=name, type=constant_type, value=value)

    def type_alias(self, span: Span, name: ast.Identifier, meant: ast.TypeName) -> ast.TypeAliasDefinition:
        """``type Angle = double<rad>``."""
        return ast.TypeAliasDefinition(span=span, doc=self.doc(span.start), name=name, type=meant)

    def enum(self, span: Span, name: ast.Identifier, *literals: ast.Identifier) -> ast.EnumDefinition:
        """``enum Mode { idle, run }``."""
        return ast.EnumDefinition(span=span, doc=self.doc(span.start), name=name, literals=literals)

    def struct(self, span: Span, name: ast.Identifier, *fields: ast.Field) -> ast.StructDefinition:
        """``struct Pose { x: double  y: double }``."""
        return ast.StructDefinition(span=span, doc=self.doc(span.start), name=name, fields=fields)

    def field(self, span: Span, name: ast.Identifier, field_type: ast.TypeName) -> ast.Field:
        """A field of a struct."""
        return ast.Field(span=span, doc=self.doc(span.start), name=name, type=field_type)

    def exception(self, span: Span, name: ast.Identifier) -> ast.ExceptionDefinition:
        """``exception Overheated``."""
        return ast.ExceptionDefinition(span=span, doc=self.doc(span.start), name=name)

    def parameters(self, span: Span, *parameters: ast.Parameter) -> tuple[ast.Parameter, ...]:
        """Parameters in parentheses."""
        return parameters

    def parameter(
        self, span: Span, name: ast.Identifier, parameter_type: ast.TypeName, default: ast.Expression | None
    ) -> ast.Parameter:
        """``speed: double<rad/s> = 0.5<rad/s>``."""
        return ast.Parameter(span=span, doc=self.doc(span.start), name=name, type=parameter_type, default=default)

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

    def options(self, span: Span, *options: Option) -> tuple[Option, ...]:
        """The clauses of a head."""
        return options

    def environment_options(self, span: Span, *options: Option) -> tuple[Option, ...]:
        """The clauses of the head of an environment."""
        return options

    def _clauses(self, definition: str, options: tuple[Option, ...], *allowed: str) -> dict[str, Any]:
        """The clauses by name, None where absent; reports those that are given twice or that have no meaning here."""
        clauses: dict[str, Any] = dict.fromkeys(allowed)
        for option in options:
            if option.name not in clauses:
                self.report.add(OptionNotHere(option.span, _CLAUSES[option.name], definition))
            elif clauses[option.name] is not None:
                first = next(other.span.text for other in options if other.name == option.name)
                same = first == option.span.text
                self.report.add(OptionTwice(option.span, _CLAUSES[option.name], definition, same))
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
        options: tuple[Option, ...],
        declarations: tuple[ast.Declaration, ...],
    ) -> ast.EnvironmentDefinition:
        """An environment."""
        return ast.EnvironmentDefinition(
            span=span,
            doc=self.doc(span.start),
            name=name,
            process=process,
            arguments=arguments or (),
            **self._clauses("environment", options, "step", "on_miss"),
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

    def hidden(self, span: Span, *ports: ast.Identifier) -> Names:
        """``hide a, b``, or nothing."""
        return ports

    def equations(self, span: Span, *items: ast.SubmodelItem) -> tuple[ast.SubmodelItem, ...]:
        """What is in a submodel after its ports."""
        return items

    def let(self, span: Span, name: ast.Identifier, value: ast.Expression) -> ast.Let:
        """``let name = value``."""
        return ast.Let(span=span, doc=self.doc(span.start), name=name, value=value)

    def state(self, span: Span, name: ast.Identifier, state_type: ast.TypeName, initial: ast.Expression) -> ast.State:
        """``state name : type = initial``."""
        return ast.State(span=span, doc=self.doc(span.start), name=name, type=state_type, initial=initial)

    def next(self, span: Span, name: ast.Identifier, value: ast.Expression) -> ast.Next:
        """``next name = value``."""
        return ast.Next(span=span, name=name, value=value)

    def derivative(self, span: Span, name: ast.Identifier, value: ast.Expression) -> ast.Derivative:
        """``der name = value``."""
        return ast.Derivative(span=span, name=name, value=value)

    def equation(self, span: Span, target: ast.Reference, value: ast.Expression) -> ast.Equation:
        """``target = value``."""
        return ast.Equation(span=span, target=target, value=value)
