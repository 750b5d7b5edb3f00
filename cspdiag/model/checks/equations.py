"""Checks that submodels have one equation for every output, local value, state and inner input."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.model.diagnostics.equations import (
    EquationForInput,
    MissingEquation,
    NotContinuous,
    RepeatedEquation,
    StateWithoutLaw,
    StateWithTwoLaws,
    UnconnectedInput,
)
from cspdiag.model.program import PortSymbol, Program
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import UNKNOWN, ArrayType, RealType, UnknownType
from cspdiag.syntax import ast


def check_equations(program: Program, report: Report) -> None:
    """Check that every submodel with equations defines each name exactly once."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.SubmodelDefinition) and definition.external is None:
            given = _check_targets(program, definition, report)
            _check_outputs(program, definition, given, report)
            _check_inner_inputs(program, definition, given, report)
            _check_states(program, definition, report)


def _check_targets(program: Program, definition: ast.SubmodelDefinition, report: Report) -> set[str]:
    """The names that have an equation (``y``, ``pid.error``), without indexes."""
    first: dict[str, ast.Equation] = {}
    given: set[str] = set()
    for item in definition.items:
        if isinstance(item, ast.Let):
            # Already reported as a clash with the output of the same name.
            given.add(item.name.text)
        if not isinstance(item, ast.Equation):
            continue
        target = item.target
        given.add(_name(target))
        if isinstance(program.bindings.get(target), PortSymbol):
            # Already reported as an equation for a single field of an output.
            given.add(target.name.text)
        if target in program.poisoned:
            continue
        member, symbol = program.members.get(target), program.bindings.get(target)
        port = member if isinstance(member, PortSymbol) else symbol
        expected = "in" if isinstance(member, PortSymbol) else "out"
        if isinstance(port, PortSymbol) and port.declaration.direction != expected:
            _refuse_target(program, item, port, report)
            continue
        text = "".join(target.span.text.split())
        earlier = first.setdefault(text, item)
        if earlier is not item:
            report.add(RepeatedEquation(target.span, name=text, first=earlier.target.span))
            program.poisoned.add(item)
    return given


def _name(target: ast.Reference) -> str:
    return target.name.text if target.member is None else f"{target.name.text}.{target.member.text}"


def _refuse_target(program: Program, equation: ast.Equation, port: PortSymbol, report: Report) -> None:
    target = equation.target
    if target.member is None:
        kind, advice = described(port), "use another name: `let name = ...`"
    else:
        kind = f"{described(port)} of an inner submodel"
        advice = "its own equations give its value; equations here are for its in ports"
    name, declared = target.span.text, declared_at(port)
    report.add(EquationForInput(target.span, name=name, kind=kind, advice=advice, declared=declared))
    program.poisoned.add(equation)


def _check_outputs(program: Program, definition: ast.SubmodelDefinition, given: set[str], report: Report) -> None:
    for name, port in program.scopes[definition].ports.items():
        if port.declaration.direction == "out" and name not in given:
            report.add(MissingEquation(port.port.span, name=name, owner=definition.name.text))
            program.poisoned.add(definition)


def _check_inner_inputs(program: Program, definition: ast.SubmodelDefinition, given: set[str], report: Report) -> None:
    for instance in definition.items:
        if not isinstance(instance, ast.Instance) or instance in program.poisoned:
            continue
        inner = program.bindings.get(instance.definition)
        scope = program.scopes.get(inner) if isinstance(inner, ast.SubmodelDefinition) else None
        missing = [
            port
            for name, port in (scope.ports if scope else {}).items()
            if port.declaration.direction == "in"
            and port.declaration.default is None
            and f"{instance.name.text}.{name}" not in given
        ]
        if missing:
            names = tuple(port.name for port in missing)
            declared = missing[0].port.span
            refused = UnconnectedInput(instance.name.span, names=names, instance=instance.name.text, declared=declared)
            report.add(refused)
            program.poisoned.add(instance)


def _check_states(program: Program, definition: ast.SubmodelDefinition, report: Report) -> None:
    laws: dict[ast.State, ast.Next | ast.Derivative] = {}
    for item in definition.items:
        if not isinstance(item, ast.Next | ast.Derivative):
            continue
        state = program.bindings.get(item.name)
        if not isinstance(state, ast.State):
            continue
        first = laws.setdefault(state, item)
        if first is not item:
            second, first_law = _law(item), _law(first)
            refused = StateWithTwoLaws(
                item.name.span, name=state.name.text, second=second, first=first.name.span, first_law=first_law
            )
            report.add(refused)
            program.poisoned.add(item)
        elif isinstance(item, ast.Derivative):
            _check_continuous(program, state, item, report)
    for item in definition.items:
        if isinstance(item, ast.State) and item not in laws and item not in program.poisoned:
            report.add(StateWithoutLaw(item.name.span, name=item.name.text))


def _law(item: ast.Next | ast.Derivative) -> str:
    return "a next value" if isinstance(item, ast.Next) else "a derivative"


def _check_continuous(program: Program, state: ast.State, item: ast.Derivative, report: Report) -> None:
    found = program.types.get(state, UNKNOWN)
    element = found
    while isinstance(element, ArrayType):
        element = element.element
    if not isinstance(element, RealType | UnknownType):
        report.add(NotContinuous(item.name.span, name=state.name.text, type=str(found), declared=state.name.span))
        program.poisoned.add(item)
