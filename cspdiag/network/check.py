"""Everything that is wrong with the processes, submodels and environments of a program, for ``check``."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from cspdiag.base import Report
from cspdiag.model.program import Program, Value
from cspdiag.model.remembered import ALWAYS, Checks
from cspdiag.network.analyse import Analysis
from cspdiag.network.checks.fixed_values import check_fixed_values
from cspdiag.network.checks.places import check_places
from cspdiag.network.checks.release import check_release
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.elaborate.definitions_to_shapes import parameter_value
from cspdiag.network.elaborate.environment_wiring import wiring
from cspdiag.network.infer.contexts import Surroundings
from cspdiag.network.lower import environments, external_bodies
from cspdiag.network.occurrences import tunable_parameters, values_by_name
from cspdiag.network.submodels import classes as submodels
from cspdiag.syntax import ast


def check(program: Program, report: Report, checks: Checks = ALWAYS) -> Analysis:
    """Reports everything that is wrong with the processes, submodels and environments of a program; ``checks`` makes
    those of single definitions.

    Returns the analysis, which lowering can use again.
    """
    check_fixed_values(program, report, checks)
    analysis = analysed(program, report)
    check_release(program, analysis.inside_out(), report)
    submodels.check(program, report, analysis.law_samples(), analysis.laws, checks)
    external_bodies.check(program, report)
    for environment in environments_of(program):
        checks.result("environment", environment, "", partial(environments.check, program, environment), report)
        if environment.places and not report.has_errors:
            _check_places(program, analysis, environment, report)
    return analysis


def _check_places(program: Program, analysis: Analysis, environment: ast.EnvironmentDefinition, report: Report) -> None:
    process = process_of(program, environment)
    assert process is not None
    values = arguments_of_outermost(analysis, process, environment.arguments, {})
    root = analysis.known_root(process, values_by_name(values))
    if root is not None:
        shape, placed = root
        drawn = wiring(program, environment, values, Report())
        check_places(environment, placed, analysis.requested[shape], drawn, report)


def analysed(program: Program, report: Report) -> Analysis:
    """The analysis of the processes of a program; reports what is wrong with them.

    The process of each environment is analysed with its arguments; every other process that is not instantiated is
    analysed by itself.
    """
    analysis = Analysis(program, report)
    main = set(program.main.items)
    environment_of: set[ast.ProcessDefinition] = set()
    for environment in environments_of(program):
        process = process_of(program, environment)
        if process is not None and process not in analysis.definitions.recursive:
            environment_of.add(process)
            values = arguments_of_outermost(analysis, process, environment.arguments, {})
            analysis.add_root(process, environment.arguments, values_by_name(values), {})
    for definition in analysis.definitions.roots():
        if definition not in environment_of:
            values = arguments_of_outermost(analysis, definition, (), {})
            surroundings: Surroundings = "environment" if definition in main else "unknown"
            if definition in main and analysis.definitions.is_specification(definition):
                surroundings = "specification"
            analysis.add_root(definition, (), values_by_name(values), {}, surroundings)
    analysis.run()
    return analysis


def environments_of(program: Program) -> list[ast.EnvironmentDefinition]:
    """The environments of a program and the files it imports, in text order."""
    return [d for d in program.definitions.values() if isinstance(d, ast.EnvironmentDefinition)]


def process_of(program: Program, environment: ast.EnvironmentDefinition) -> ast.ProcessDefinition | None:
    """The process that an environment is for; None if there is an error in its name."""
    found = program.bindings.get(environment.process)
    return found if isinstance(found, ast.ProcessDefinition) else None


def arguments_of_outermost(
    analysis: Analysis,
    process: ast.ProcessDefinition,
    arguments: tuple[ast.Argument, ...],
    overrides: Mapping[str, Value],
) -> dict[ast.Node, Value]:
    """The values of the parameters of an outermost process, as far as they have one."""
    given = dict(arguments_of(process.parameters, arguments))
    tunable = tunable_parameters(analysis.program, process.parameters, arguments, overrides)
    found: dict[ast.Node, Value] = {}
    for parameter in process.parameters:
        if parameter.name.text in tunable:
            continue
        value = overrides.get(parameter.name.text)
        expression = given.get(parameter, parameter.default)
        if value is None and expression is not None:
            value = parameter_value(analysis.elaboration, parameter, expression, found)
        if value is not None:
            found[parameter] = value
    return found
