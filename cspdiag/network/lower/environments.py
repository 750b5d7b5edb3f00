"""Lowers environments: all their submodels (plant, operator) become one system of equations; drivers stay separate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

from cspdiag.base import Report
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import PortSymbol, Program, Scope, Value
from cspdiag.network.diagnostics.environments import (
    EnvironmentStepNotPositive,
    IncompleteEnvironment,
    UnconnectedInputs,
    UnknownMissPolicy,
)
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.elaborate.environment_wiring import Member, Wiring, elements_of, wiring
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.ir.expressions import Expression, SignalValue
from cspdiag.network.ir.network import DriverInstance, Environment, ExternalPort, Port, SubmodelClass
from cspdiag.network.lower.setting_paths import refuse_missing
from cspdiag.network.submodels.draft import SECONDS, Draft
from cspdiag.network.submodels.inline import Inlining, external_body, nested
from cspdiag.network.submodels.signals import InlinedInto
from cspdiag.network.submodels.system import complete, evaluation_order
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes

MILLISECOND = 1_000_000


def check(program: Program, definition: ast.EnvironmentDefinition, report: Report) -> None:
    """Reports what is wrong with an environment: ports that are unconnected or connected twice, and algebraic loops
    through its submodels.
    """
    process = program.bindings.get(definition.process)
    if definition in program.poisoned or not isinstance(process, ast.ProcessDefinition):
        return
    own = Report()
    values = _process_values(program, process, definition, own, {})
    drawn = wiring(program, definition, values, own)
    doubtful = own.has_errors or any(item in program.poisoned for item in nodes(*definition.declarations))
    step = _step(program, definition, (), own)
    _miss_policy(definition, own)
    if not doubtful:
        # A reference with an error, or an element of an array whose size is not known, may be what seems to be missing.
        _refuse_gaps(program, definition, process, drawn, values, own)
    if not (doubtful or own.has_errors):
        is_known = len(values) == len(process.parameters)
        draft = Draft(owner=definition.name.span, sample=step, arguments={}, concrete=is_known, closed=True)
        _assemble(program, draft, drawn, _open_ports(program, process, values, own), own)
        evaluation_order(draft, own)
    for diagnostic in own.diagnostics:
        report.add(diagnostic)


def lower_environment(
    program: Program,
    definition: ast.EnvironmentDefinition,
    external_ports: tuple[ExternalPort, ...],
    overrides: Mapping[str, Value],
    report: Report,
) -> Environment | None:
    """The environment of a checked program; None if an error was reported.

    ``external_ports`` are those of its process; ``overrides`` are values of parameters by path: ``pan.inertia``,
    ``pan.friction.coulomb``. Raises NoSuchElementError for a path with an element that an array here does not have.
    """
    process = program.bindings.get(definition.process)
    if not isinstance(process, ast.ProcessDefinition):
        return None
    values = _process_values(program, process, definition, report, overrides)
    drawn = wiring(program, definition, values, report)
    step = _step(program, definition, external_ports, report)
    draft = Draft(owner=definition.name.span, sample=step, arguments={}, closed=True, overrides=overrides)
    system = _system(program, definition, drawn, external_ports, draft, report)
    drivers = tuple(
        _driver(program, member, drawn, overrides, report) for member in drawn.members.values() if member.is_driver
    )
    if report.has_errors:
        return None
    if overrides:
        refuse_missing(program, definition, overrides, (*drawn.members, *sorted(draft.names)))
    return Environment(
        name=definition.name.text,
        doc=definition.doc,
        span=definition.name.span,
        system=system,
        drivers=drivers,
        step=step,
        on_miss=_miss_policy(definition, report),
        places=tuple(
            (place.name.text, tuple(instance.text for instance in place.instances)) for place in definition.places
        ),
    )


def _process_values(
    program: Program,
    process: ast.ProcessDefinition,
    definition: ast.EnvironmentDefinition,
    report: Report,
    overrides: Mapping[str, Value],
) -> dict[ast.Node, Value]:
    """The values of the parameters of the process, as far as they have one."""
    given = dict(arguments_of(process.parameters, definition.arguments))
    values: dict[ast.Node, Value] = {}
    for parameter in process.parameters:
        expression = given.get(parameter, parameter.default)
        value = overrides.get(parameter.name.text)
        if value is None and expression is not None:
            value = evaluate(program, expression, values, report)
        if value is not None:
            values[parameter] = value
    return values


def _open_ports(
    program: Program, process: ast.ProcessDefinition, values: Mapping[ast.Node, Value], report: Report
) -> tuple[ExternalPort, ...]:
    """The ports of the process, as far as they are known without elaborating it."""
    scope = program.scopes.get(process, Scope())
    return tuple(
        ExternalPort(name=name, span=symbol.port.span, direction=symbol.declaration.direction, type=symbol.type)
        for symbol in scope.ports.values()
        for name in elements_of(program, symbol, values, report)
    )


def _step(
    program: Program, definition: ast.EnvironmentDefinition, ports: tuple[ExternalPort, ...], report: Report
) -> int:
    """The step of the grid in nanoseconds: the declared one, or else the greatest common divisor of the periods, or
    else a millisecond.
    """
    if definition.step is not None:
        step = evaluate(program, definition.step, {}, report)
        if isinstance(step, int) and step > 0:
            return step
        if isinstance(step, int):
            report.add(EnvironmentStepNotPositive(definition.step.span))
    return grid_of(ports)


def grid_of(ports: tuple[ExternalPort, ...]) -> int:
    """The step of an environment that does not declare one, in nanoseconds: the greatest common divisor of the periods
    of the ports, or else a millisecond.
    """
    return math.gcd(*(port.sampling.period for port in ports if port.sampling)) or MILLISECOND


def _miss_policy(definition: ast.EnvironmentDefinition, report: Report) -> Literal["timeout", "count"]:
    if definition.on_miss is None or definition.on_miss.text == "timeout":
        return "timeout"
    if definition.on_miss.text != "count":
        report.add(UnknownMissPolicy(definition.on_miss.span, definition.on_miss.text))
    return "count"


def _refuse_gaps(
    program: Program,
    definition: ast.EnvironmentDefinition,
    process: ast.ProcessDefinition,
    drawn: Wiring,
    values: Mapping[ast.Node, Value],
    report: Report,
) -> None:
    """Reports ports of the process, and inputs of members, that are not connected."""
    connected = {terminal.name for wire in drawn.wires for terminal in (wire.source, wire.sink)} | drawn.discarded

    def gaps(definition: ast.Node, prefix: str, around: Mapping[ast.Node, Value]) -> list[tuple[str, PortSymbol]]:
        found = []
        for symbol in program.scopes.get(definition, Scope()).ports.values():
            names = elements_of(program, symbol, around, report)
            missing = [name for name in names if prefix + name not in connected]
            if missing and symbol.declaration.default is None:
                found += [(name, symbol) for name in ([symbol.name] if len(missing) == len(names) else missing)]
        return found

    missing = gaps(process, "", values)
    if missing:
        ports = tuple((name, symbol.declaration.direction, symbol.port.span) for name, symbol in missing)
        report.add(IncompleteEnvironment(definition.name.span, definition.name.text, process.name.text, ports))
    for member in drawn.members.values():
        inner = {**member.values, **_argument_values(program, member, {}, report)}
        unconnected = [
            (name, symbol.port.span)
            for name, symbol in gaps(member.definition, f"{member.name}.", inner)
            if symbol.declaration.direction == "in"
        ]
        if unconnected:
            report.add(UnconnectedInputs(member.declaration.name.span, member.name, tuple(unconnected)))


def _argument_values(
    program: Program, member: Member, overrides: Mapping[str, Value], report: Report
) -> dict[ast.Node, Value]:
    """The values of the parameters of a member."""
    given = dict(arguments_of(member.definition.parameters, member.declaration.arguments))
    values: dict[ast.Node, Value] = {}
    for parameter in member.definition.parameters:
        value = overrides.get(f"{member.name}.{parameter.name.text}")
        expression = given.get(parameter)
        if value is None and expression is not None:
            value = evaluate(program, expression, member.values, report)
        elif value is None and parameter.default is not None:
            value = evaluate(program, parameter.default, values, report)
        if value is not None:
            values[parameter] = value
    return values


def _system(
    program: Program,
    definition: ast.EnvironmentDefinition,
    drawn: Wiring,
    external_ports: tuple[ExternalPort, ...],
    draft: Draft,
    report: Report,
) -> SubmodelClass | None:
    """All submodels and the relationships between them as one system; None if there are none, or an error
    was reported.
    """
    used = _assemble(program, draft, drawn, external_ports, report)
    if not draft.equations and not used:
        return None
    ports = tuple(opposite_port(port) for port in external_ports if port.name in used)
    name = definition.name.text
    system = SubmodelClass(name=name, definition=name, doc=definition.doc, span=definition.name.span, ports=ports)
    return complete(system, draft, report)


def opposite_port(port: ExternalPort) -> Port:
    """The port of an environment's system that an external port of the program is connected to."""
    direction: Literal["in", "out"] = "in" if port.direction == "out" else "out"
    return Port(name=port.name, doc=port.doc, span=port.span, direction=direction, type=port.type)


def _assemble(
    program: Program, draft: Draft, drawn: Wiring, external_ports: tuple[ExternalPort, ...], report: Report
) -> set[str]:
    """Adds all submodels and relationships to the draft; returns the ports of the program that they use."""
    submodels = [member for member in drawn.members.values() if not member.is_driver]
    inner = {member.name: _inlined(program, draft, member, report) for member in submodels}
    types = {port.name: port.type for port in external_ports}
    for name, inlining in inner.items():
        for _, key, kind in (*inlining.ports("in"), *inlining.ports("out")):
            types[key] = kind
        draft.kept.update(key for _, key, _ in inlining.ports("out"))
        inlining.run()
        draft.names.add(name)
    used: set[str] = set()
    for wire in drawn.wires:
        ends = (wire.source, wire.sink)
        if any(end.member and end.member not in inner for end in ends) or wire.sink.name not in types:
            continue
        source = SignalValue(type=types.get(wire.source.name, SECONDS), name=wire.source.name, span=wire.span)
        draft.equation(wire.sink.name, source, wire.span, kind=types[wire.sink.name])
        used.update(end.port for end in ends if not end.member)
    for name, inlining in inner.items():
        inlining.close(name)
    return used


def _inlined(program: Program, draft: Draft, member: Member, report: Report) -> Inlining:
    definition = member.definition
    assert isinstance(definition, ast.SubmodelDefinition)
    context = LoweringContext(values=member.values)
    arguments: dict[ast.Parameter, Expression] = {
        parameter: lower_expression(program, argument, context)
        for parameter, argument in arguments_of(definition.parameters, member.declaration.arguments)
    }
    surroundings = InlinedInto(path=(), environment=True)
    return nested(program, draft, definition, report, surroundings, member.name, arguments)


def _driver(
    program: Program, member: Member, drawn: Wiring, overrides: Mapping[str, Value], report: Report
) -> DriverInstance:
    definition = member.definition
    assert isinstance(definition, ast.DriverDefinition)
    assert definition.external is not None
    values = _argument_values(program, member, overrides, report)
    connections = []
    given = [parameter for parameter in definition.parameters if parameter in values]
    for wire in drawn.wires:
        for own, other in ((wire.source, wire.sink), (wire.sink, wire.source)):
            if own.member == member.name:
                connections.append((own.port, other.port))
    ports: dict[str, list[str]] = {"in": [], "out": []}
    for symbol in program.scopes.get(definition, Scope()).ports.values():
        ports[symbol.declaration.direction] += elements_of(program, symbol, {**member.values, **values}, report)
    return DriverInstance(
        name=member.name,
        doc=member.declaration.doc or definition.doc,
        span=member.declaration.name.span,
        definition=definition.name.text,
        external=external_body(definition.external),
        arguments=tuple((parameter.name.text, values[parameter]) for parameter in given),
        argument_types=tuple(program.types[parameter] for parameter in given),
        connections=tuple(connections),
        outputs=tuple(ports["out"]),
        inputs=tuple(ports["in"]),
    )
