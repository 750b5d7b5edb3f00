"""``check``: what is wrong with a program, and what it has."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeVar

from cspdiag.editing.view import View
from cspdiag.model.program import Program
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.ir.external import files_of_body
from cspdiag.network.lower.external_bodies import Owner
from cspdiag.network.submodels.inline import external_body
from cspdiag.studio.engine.data import Data, diagnostic_data, place_of
from cspdiag.studio.engine.values import about, fields, value_data
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in

MOST_PROCESSES = 2000
D = TypeVar("D", bound=ast.Definition)


def check(view: View) -> Data:
    """Everything that is wrong with a program, and its parts as far as they could be read."""
    found = view.diagnostics
    program = view.program
    top = _outermost(program)
    return {
        "diagnostics": [diagnostic_data(each) for each in found],
        "top": None if top is None else top.name.text,
        "environments": [_environment(program, each) for each in _own(program, ast.EnvironmentDefinition)],
        "processes": [] if top is None else list(_processes(program, top)),
        "definitions": [
            {"name": each.name.text, "place": place_of(each.span)} for each in _own(program, ast.ProcessDefinition)
        ],
        "parameters": list(parameters_of(program)),
        "assertions": [
            {"text": " ".join(each.span.text.split()), "place": place_of(each.span)}
            for each in program.main.items
            if isinstance(each, ast.Assertion)
        ],
        "bodies": _bodies(program),
    }


def _bodies(program: Program) -> list[Data]:
    """What is in other languages, each once, also in the files that are imported. It is named, not read."""
    found: dict[tuple[str, str], Data] = {}
    for definition in program.definitions.values():
        if isinstance(definition, Owner) and definition.external is not None:
            body = external_body(definition.external)
            data = {"language": body.language, "target": body.target, "files": list(files_of_body(body))}
            found.setdefault((body.language, body.target), data)
    return list(found.values())


def _own(program: Program, kind: type[D]) -> list[D]:
    return [item for item in program.main.items if isinstance(item, kind)]


def _outermost(program: Program) -> ast.ProcessDefinition | None:
    for environment in _own(program, ast.EnvironmentDefinition):
        found = program.definitions.get(environment.process.text)
        if isinstance(found, ast.ProcessDefinition):
            return found
    return Definitions(program).outermost()


def _environment(program: Program, environment: ast.EnvironmentDefinition) -> Data:
    definition = program.definitions.get(environment.process.text)
    scope = program.scopes.get(definition) if isinstance(definition, ast.ProcessDefinition) else None
    ports = [] if scope is None else [(name, symbol.declaration.direction) for name, symbol in scope.ports.items()]
    return {
        "name": environment.name.text,
        "process": environment.process.text,
        "place": place_of(environment.name.span),
        "inputs": [name for name, direction in ports if direction == "in"],
        "outputs": [name for name, direction in ports if direction == "out"],
        "drivers": list(_drivers(program, environment)),
    }


def _drivers(program: Program, environment: ast.EnvironmentDefinition) -> Iterator[Data]:
    """The drivers of an environment with the languages in which they are written; a device of cspdiag is Python."""
    for instance in instances_in(environment):
        driver = program.definitions.get(instance.definition.text)
        if isinstance(driver, ast.DriverDefinition) and driver.external is not None:
            yield {"name": driver.name.text, "language": external_body(driver.external).language}


def _processes(program: Program, top: ast.ProcessDefinition) -> Iterator[Data]:
    """The outermost process and the instances inside it, an array of them once; their paths are those of runs."""
    pending: list[tuple[ast.ProcessDefinition, str, Data, bool, tuple[ast.ProcessDefinition, ...]]]
    pending = [(top, top.name.text, place_of(top.name.span), False, (top,))]
    count = 0
    while pending and count < MOST_PROCESSES:
        definition, path, place, is_array, around = pending.pop(0)
        count += 1
        yield {"path": path, "name": definition.name.text, "place": place, "array": is_array}
        for instance in instances_in(definition):
            inner = program.definitions.get(instance.definition.text)
            if isinstance(inner, ast.ProcessDefinition) and inner not in around:
                own = f"{path}.{instance.name.text}", place_of(instance.span), instance.size is not None
                pending.append((inner, *own, (*around, inner)))


def parameters_of(program: Program) -> Iterator[Data]:
    """The parameters of the program, which may change while it runs, with the numbers that they consist of."""
    for constant, value in program.tunable.items():
        kind = program.types.get(constant)
        if constant.tunable and kind is not None:
            yield {
                "name": constant.name.text,
                **about(kind),
                "value": value_data(value, kind),
                "fields": fields(constant.name.text, kind, value),
                "doc": constant.doc,
                "place": place_of(constant.span),
            }
