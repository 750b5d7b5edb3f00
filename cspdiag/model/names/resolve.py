"""From syntax trees to a program: the meaning of every name, and the type of every declaration and expression."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from cspdiag.base import Report
from cspdiag.model.context import Context, Surroundings
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.assertions import resolve_assertion
from cspdiag.model.names.communications import resolve_declarations
from cspdiag.model.names.compositions import resolve_composition
from cspdiag.model.names.definitions import collect, resolve_constants_and_types
from cspdiag.model.names.equations import resolve_submodel
from cspdiag.model.names.headers import WithPorts, resolve_header
from cspdiag.model.names.instances import bind_definition, resolve_arguments
from cspdiag.model.names.recursion import refuse_recursion
from cspdiag.model.names.scopes import definition_text
from cspdiag.model.program import Program, Scope, Value
from cspdiag.model.types import TIME
from cspdiag.syntax import ast


def resolve(trees: Sequence[ast.SourceTree], overrides: Mapping[str, Value], report: Report) -> Program:
    """Resolve a program given by its trees, the main file's first.

    ``overrides`` replaces the values of constants by name; a string is parsed by ``parse_value``, which raises
    ValueError.
    """
    program = Program(main=trees[0], trees=tuple(trees), overrides=dict(overrides))
    context = Context(program, report, incomplete=report.has_errors)
    collect(context)
    resolve_constants_and_types(context)
    definitions = [
        item for tree in program.trees for item in tree.items if not isinstance(item, ast.Import | ast.Assertion)
    ]
    for definition in definitions:
        if isinstance(definition, WithPorts):
            resolve_header(context, definition)
    for definition in definitions:
        match definition:
            case ast.ProcessDefinition():
                _resolve_process(context, definition)
            case ast.SubmodelDefinition():
                resolve_submodel(context, definition)
            case ast.EnvironmentDefinition():
                _resolve_environment(context, definition)
            case (
                ast.Constant() | ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition()
                | ast.ExceptionDefinition() | ast.DriverDefinition()
            ):  # fmt: skip
                pass
            case _:
                assert_never(definition)
    refuse_recursion(context)
    for assertion in program.assertions:
        resolve_assertion(context, assertion)
    return program


def _resolve_process(context: Context, definition: ast.ProcessDefinition) -> None:
    scope = context.program.scopes[definition]
    typer = Typer(context, Surroundings(place="process", owner=definition, scope=scope, replicators={}))
    if definition.communication is not None:
        kinds = (ast.ProcessDefinition, ast.SubmodelDefinition)
        declarations = definition.communication.declarations
        resolve_declarations(typer, declarations, definition_text(definition), kinds, "a process or a submodel")
    if definition.composition is not None:
        resolve_composition(typer, definition.composition)


def _resolve_environment(context: Context, definition: ast.EnvironmentDefinition) -> None:
    """Resolve an environment. Its scope includes the ports of the process, which relationships use by name."""
    scope = context.program.scopes[definition] = Scope()
    surroundings = Surroundings(place="environment", owner=definition, scope=scope, replicators={})
    typer = Typer(context, surroundings)
    process = bind_definition(typer, definition.process, (ast.ProcessDefinition,), "a process")
    if isinstance(process, ast.ProcessDefinition):
        example = f"environment {definition.name.text} for {definition.process.text}"
        resolve_arguments(typer, process, definition.arguments, definition, definition.process, example)
        scope.ports.update(context.program.scopes[process].ports)
        scope.names.update(scope.ports)
    else:
        context.program.poisoned.add(definition)
        scope.incomplete = True
        for argument in definition.arguments:
            typer.before_running().infer(argument.value)
    if definition.step is not None:
        typer.constant(definition.step, TIME, Purpose(what="the step of an environment"))
    kinds = (ast.SubmodelDefinition, ast.DriverDefinition)
    where = definition_text(definition)
    resolve_declarations(typer, definition.declarations, where, kinds, "a submodel or a driver")
