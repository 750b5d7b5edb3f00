"""Assertions: the processes that they name, and the ports that a specification observes."""

from __future__ import annotations

from cspdiag.model.context import Context, Surroundings
from cspdiag.model.diagnostics.assertions import UnspecifiedPort
from cspdiag.model.diagnostics.names import UnknownMember
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.instances import bind_definition
from cspdiag.model.program import Scope
from cspdiag.model.symbols import declared_at
from cspdiag.syntax import ast


def resolve_assertion(context: Context, assertion: ast.Assertion) -> None:
    """Bind the names of an assertion; each port of the process must be a port of the specification, or hidden."""
    surroundings = Surroundings(place="constant", owner=assertion, scope=Scope(), replicators={}, constant=True)
    typer = Typer(context, surroundings)
    for name in (assertion.process, assertion.specification):
        if name is not None:
            bind_definition(typer, name, (ast.ProcessDefinition,), "a process")
    if assertion.specification is None:
        return
    process, specification = (_scope_of(context, name) for name in (assertion.process, assertion.specification))
    if process is not None and specification is not None and _hides_ports(context, assertion, process):
        _check_ports(context, assertion, process, specification)


def _scope_of(context: Context, name: ast.Identifier) -> Scope | None:
    definition = context.program.bindings.get(name)
    scope = context.program.scopes.get(definition) if isinstance(definition, ast.ProcessDefinition) else None
    return None if scope is None or scope.incomplete else scope


def _hides_ports(context: Context, assertion: ast.Assertion, process: Scope) -> bool:
    """Whether every hidden name is a port; other names are reported."""
    unknown = [name for name in assertion.hidden if name.text not in process.ports]
    for name in unknown:
        missing = UnknownMember(
            name.span,
            name=name.text,
            owner=f"`{assertion.process.text}`",
            expected="port",
            options=tuple(process.ports),
            suggestion=context.speller.nearest(name.text, process.ports),
            declared=declared_at(context.program.bindings[assertion.process]),
        )
        context.refuse(missing, name)
    return not unknown


def _check_ports(context: Context, assertion: ast.Assertion, process: Scope, specification: Scope) -> None:
    assert assertion.specification is not None
    hidden = {name.text for name in assertion.hidden}
    unspecified = [name for name in process.ports if name not in specification.ports and name not in hidden]
    if unspecified:
        context.refuse(
            UnspecifiedPort(
                assertion.specification.span,
                ports=tuple(unspecified),
                process=assertion.process.text,
                specification=assertion.specification.text,
                hidden=tuple(name.text for name in assertion.hidden),
                declared=process.ports[unspecified[0]].port.name.span,
            ),
            assertion,
        )
