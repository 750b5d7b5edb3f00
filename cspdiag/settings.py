"""Values given from outside the text: ``Tsh=10ms`` for a constant, ``pan.inertia=2e-3`` for an instance's parameter."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, islice
from typing import TYPE_CHECKING

from cspdiag.diagnostics.record import record
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.program import Program, Value


class SettingError(ValueError):
    """A setting names nothing that can be set, or its value does not fit; the message is one line."""


@record
class Overrides:
    """Settings as values: of constants by name, of parameters by the path of their instance."""

    constants: Mapping[str, Value]
    parameters: Mapping[str, Value]


NO_OVERRIDES = Overrides(constants={}, parameters={})


def split_setting(text: str) -> tuple[str, str]:
    """``NAME=VALUE`` as its two parts; SettingError without them."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise SettingError(f"a setting is NAME=VALUE, not {text!r}")
    return name.strip(), value.strip()


def parse_duration(text: str) -> int:
    """``20s``, ``1.5 ms`` in nanoseconds. Raises SettingError."""
    from cspdiag.model.evaluate import parse_value
    from cspdiag.model.types import TIME

    try:
        duration = parse_value(TIME, text)
    except ValueError as problem:
        raise SettingError(str(problem)) from None
    assert isinstance(duration, int)
    return duration


def parse_settings(program: Program, settings: Mapping[str, str]) -> Overrides:
    """The settings with their values read by the types of what they set.

    A dotted name is a parameter of an instance of an environment, or of a process by its path from an outermost process.
    Raises SettingError.
    """
    constants: dict[str, Value] = {}
    parameters: dict[str, Value] = {}
    for name, text in settings.items():
        if "." in name:
            parameters[name] = _value(program, name, text, _parameter(program, name))
        else:
            constants[name] = _value(program, name, text, _constant(program, name))
    return Overrides(constants=constants, parameters=parameters)


def _value(program: Program, name: str, text: str, declared: ast.Node) -> Value:
    from cspdiag.model.evaluate import parse_value

    try:
        return parse_value(program.types[declared], text)
    except ValueError as problem:
        raise SettingError(f"{name}: {problem}") from None


def _constant(program: Program, name: str) -> ast.Constant:
    constants = {known: item for known, item in program.definitions.items() if isinstance(item, ast.Constant)}
    if name not in constants:
        raise SettingError(f"there is no constant {name!r}{_suggestion(name, constants)}")
    return constants[name]


def _parameter(program: Program, path: str) -> ast.Parameter:
    *instances, name = path.split(".")
    candidates = [
        definition
        for definition in program.definitions.values()
        if isinstance(definition, ast.EnvironmentDefinition | ast.ProcessDefinition)
    ]
    for outermost in candidates:
        definition = _inside(program, outermost, instances)
        if definition is None:
            continue
        parameters = {parameter.name.text: parameter for parameter in definition.parameters}
        if name in parameters:
            return parameters[name]
    known = islice(chain.from_iterable(_paths(program, outermost) for outermost in candidates), _MOST_PATHS)
    help_ = _suggestion(path, known) or " (INSTANCE.PARAMETER, by the path from the outermost process)"
    raise SettingError(f"there is no parameter {path!r}{help_}")


_MOST_PATHS = 1000
"""A program may have more instances than anybody wants to wait for; a name that was meant is looked for among so many."""


def _paths(program: Program, outermost: ast.Node) -> Iterator[str]:
    """Paths of all parameters of instances, the outermost instances first."""
    pending: deque[tuple[str, ast.Node]] = deque([("", outermost)])
    while pending:
        prefix, definition = pending.popleft()
        for instance in _instances(definition):
            path = f"{prefix}{instance.name.text}"
            found = program.definitions.get(instance.definition.text)
            if isinstance(found, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
                yield from (f"{path}.{parameter.name.text}" for parameter in found.parameters)
                pending.append((f"{path}.", found))


def _inside(
    program: Program, outermost: ast.Node, path: Iterable[str]
) -> ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition | None:
    found: ast.Node | None = outermost
    for step in path:
        instance = next((item for item in _instances(found) if item.name.text == step.partition("[")[0]), None)
        found = program.definitions.get(instance.definition.text) if instance is not None else None
    if isinstance(found, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
        return found
    return None


def _instances(definition: ast.Node | None) -> Iterable[ast.Instance]:
    match definition:
        case ast.EnvironmentDefinition():
            pending: list[ast.Node] = list(definition.declarations)
        case ast.ProcessDefinition(communication=ast.Communication() as block):
            pending = list(block.declarations)
        case ast.SubmodelDefinition():
            pending = list(definition.items)
        case _:
            return
    while pending:
        item = pending.pop(0)
        if isinstance(item, ast.Instance):
            yield item
        elif isinstance(item, ast.RepeatedDeclarations):
            pending += item.declarations


def _suggestion(name: str, known: Iterable[str]) -> str:
    from cspdiag.model.spelling import Speller

    near = Speller().nearest(name, known)
    return f" (did you mean {near!r}?)" if near else ""
