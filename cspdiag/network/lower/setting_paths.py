"""Paths to parameters of instances, as in settings: ``follow.law.kp``, ``philosopher[3].id``.

A path begins inside an outermost process or an environment. Everything here is decided from the text alone; the number
of elements of an array is known only when the program is elaborated.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.model.program import Program, Value
from cspdiag.model.symbols import described
from cspdiag.syntax import ast

Root: TypeAlias = ast.ProcessDefinition | ast.EnvironmentDefinition
_Parametrized: TypeAlias = ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition

_STEP = re.compile(r"(?P<name>[A-Za-z_][A-Za-z0-9_]*)(?P<indexes>(?:\[[^\[\].]*\])*)")


def in_root(root: Root, path: str) -> str:
    """The path of a parameter as a key for this root only, as other roots may have the same path."""
    return f"{root.name.text}:{path}"


def of_root(values: Mapping[str, Value], root: Root) -> dict[str, Value]:
    """The values for this root, by plain path: those for all roots, and those for this one only."""
    parted = ((path.rpartition(":"), value) for path, value in values.items())
    return {path: value for (owner, _, path), value in parted if owner in {"", root.name.text}}


class NoSuchElementError(LookupError):
    """A path below a root names an element that an array of instances does not have; the message is one line."""

    def __init__(self, root: Root, path: str, array: str, has: str) -> None:
        super().__init__(f"there is no parameter {path!r} (`{array}` has {has})")
        self.root, self.path, self.array, self.has = root, path, array, has

    def as_written(self, overrides: Collection[str]) -> NoSuchElementError:
        """The same error for the path with the name of the root, if it was written with it."""
        if in_root(self.root, self.path) not in overrides:
            return self
        name = self.root.name.text
        return NoSuchElementError(self.root, f"{name}.{self.path}", f"{name}.{self.array}", self.has)


@record
class PathStep:
    """A name on a path, with its indexes as written: ``cell[0][1]``."""

    name: str
    indexes: tuple[str, ...]

    def __str__(self) -> str:
        return self.name + "".join(f"[{index}]" for index in self.indexes)


@record
class Dead:
    """The end of a path that does not exist: after how many steps, and the reason if it is more than an
    unknown name.
    """

    depth: int
    reason: str = ""


def steps_of(path: str) -> tuple[PathStep, ...] | None:
    """The steps of a path, with indexes as plain numbers; None if it is not a path."""
    found = [_STEP.fullmatch(part.strip()) for part in path.split(".")]
    if not all(found):
        return None
    return tuple(
        PathStep(name=match["name"], indexes=tuple(map(_plain, re.findall(r"\[([^\]]*)\]", match["indexes"]))))
        for match in found
        if match is not None
    )


def _plain(index: str) -> str:
    index = index.strip()
    return str(int(index)) if index.isascii() and index.isdecimal() and len(index) < 20 else index


def parameter_at(program: Program, root: Root, steps: tuple[PathStep, ...]) -> ast.Parameter | Dead:
    """The parameter at the end of a path from a root, or the place where the path ends before that."""
    definition: ast.Node = root
    for depth, step in enumerate(steps[:-1]):
        found = next((item for item in _instances(definition) if item[0].name.text == step.name), None)
        if found is None:
            if _own_parameter(definition, step.name) is not None:
                return Dead(depth, f"{step.name!r} is a parameter, and is set as a whole")
            return Dead(depth)
        instance, dimensions = found
        wrong = _wrong_indexes(steps, depth, dimensions)
        if wrong:
            # Suggest only a path that exists.
            end = parameter_at(program, root, (*steps[:depth], _first_element(step, dimensions), *steps[depth + 1 :]))
            return end if isinstance(end, Dead) else Dead(depth, wrong)
        inside = program.definitions.get(instance.definition.text)
        if not isinstance(inside, _Parametrized):
            return Dead(depth)
        definition = inside
    last = steps[-1]
    parameter = _own_parameter(definition, last.name)
    if parameter is None:
        return Dead(len(steps) - 1, _other_kind(program, definition, steps))
    if last.indexes:
        return Dead(len(steps) - 1, f"{last.name!r} is a parameter, and is set as a whole")
    return parameter


def _other_kind(program: Program, definition: ast.Node, steps: tuple[PathStep, ...]) -> str:
    """A note that a path ends at something other than a parameter, and what can be set there; empty if the name is
    unknown.
    """
    scope = program.scopes.get(definition)
    named = None if scope is None else scope.ports.get(steps[-1].name) or scope.names.get(steps[-1].name)
    if named is None:
        return ""
    if isinstance(named, ast.Instance):
        return _whole_instance(program, definition, named, steps)
    around = ".".join(map(str, steps[:-1]))
    what = f"`{steps[-1].name}` is {described(named)}{f' of `{around}`' if around else ''}"
    return f"{what}; {_parameters_there(definition, around)}"


def _whole_instance(program: Program, definition: ast.Node, instance: ast.Instance, steps: tuple[PathStep, ...]) -> str:
    """A note that a path ends at an instance or an array of them, and what can be set there."""
    dimensions = next(found for declared, found in _instances(definition) if declared is instance)
    what, shown, element = described(instance), steps[-1], steps[-1]
    if not _names_element(element, dimensions):
        shown, element = PathStep(element.name, ()), _first_element(element, dimensions)
        what = f"an array of instances of `{instance.definition.text}`" if dimensions else what
    path, around = (".".join(map(str, (*steps[:-1], last))) for last in (shown, element))
    inside = program.definitions.get(instance.definition.text)
    return f"`{path}` is {what}; {_parameters_there(inside, around)}"


def _parameters_there(definition: ast.Node | None, around: str) -> str:
    own = definition.parameters if isinstance(definition, _Parametrized) else ()
    names = ", ".join(f"{around}.{parameter.name.text}" if around else parameter.name.text for parameter in own)
    return f"parameters there: {names or 'none'}"


def refuse_missing(program: Program, root: Root, paths: Iterable[str], instances: Iterable[str]) -> None:
    """Raises NoSuchElementError for a path with an element that an array below a root does not have.

    ``instances`` are the paths of all instances below the root, with the indexes of elements.
    """
    known = dict.fromkeys(instances)
    for path in paths:
        steps = steps_of(path)
        if steps is None or not isinstance(parameter_at(program, root, steps), ast.Parameter):
            continue
        for depth in range(1, len(steps)):
            instance = ".".join(map(str, steps[:depth]))
            if instance not in known:
                array = ".".join(map(str, (*steps[: depth - 1], PathStep(steps[depth - 1].name, ()))))
                elements = [name for name in known if name.startswith(f"{array}[") and "." not in name[len(array) :]]
                has = f"{elements[0]} to {elements[-1]}" if len(elements) > 1 else (elements or ["no element"])[0]
                raise NoSuchElementError(root, path, array, has)


def _own_parameter(definition: ast.Node, name: str) -> ast.Parameter | None:
    if not isinstance(definition, _Parametrized):
        return None
    return next((parameter for parameter in definition.parameters if parameter.name.text == name), None)


def _wrong_indexes(steps: tuple[PathStep, ...], depth: int, dimensions: int) -> str:
    step = steps[depth]
    if _names_element(step, dimensions):
        return ""
    whole = ".".join(map(str, (*steps[:depth], _first_element(step, dimensions), *steps[depth + 1 :])))
    if not dimensions:
        return f"{step.name!r} is a single instance, not an array: {whole!r}"
    if not step.indexes:
        return f"{step.name!r} is an array of instances, each with its own: {whole!r}"
    if len(step.indexes) != dimensions:
        return f"an element of {step.name!r} has {dimensions} {'index' if dimensions == 1 else 'indexes'}: {whole!r}"
    return f"the elements of {step.name!r} are numbered: {whole!r}"


def _names_element(step: PathStep, dimensions: int) -> bool:
    """Whether a step has as many indexes as an instance needs, and all are numbers."""
    return len(step.indexes) == dimensions and all(index.isascii() and index.isdecimal() for index in step.indexes)


def _first_element(step: PathStep, dimensions: int) -> PathStep:
    return PathStep(step.name, ("0",) * dimensions)


def paths_of(program: Program, root: Root) -> Iterator[tuple[PathStep, ...]]:
    """The paths to all parameters of instances, the outermost instances first; for an array those of its
    first element.
    """
    pending: deque[tuple[tuple[PathStep, ...], ast.Node]] = deque([((), root)])
    while pending:
        prefix, definition = pending.popleft()
        if isinstance(definition, _Parametrized):
            yield from ((*prefix, PathStep(parameter.name.text, ())) for parameter in definition.parameters)
        for instance, dimensions in _instances(definition):
            found = program.definitions.get(instance.definition.text)
            if isinstance(found, _Parametrized):
                pending.append(((*prefix, PathStep(instance.name.text, ("0",) * dimensions)), found))


def _instances(definition: ast.Node) -> Iterator[tuple[ast.Instance, int]]:
    """The instances declared in a definition, each with the number of indexes that it takes."""
    match definition:
        case ast.EnvironmentDefinition():
            yield from _declared(definition.declarations, 0)
        case ast.ProcessDefinition(communication=ast.Communication() as block):
            yield from _declared(block.declarations, 0)
        case ast.SubmodelDefinition():
            yield from _declared(definition.items, 0)
        case _:  # No other definition declares instances.
            pass


def _declared(items: Iterable[ast.Node], depth: int) -> Iterator[tuple[ast.Instance, int]]:
    for item in items:
        if isinstance(item, ast.Instance):
            yield item, depth + (item.size is not None)
        elif isinstance(item, ast.RepeatedDeclarations):
            yield from _declared(item.declarations, depth + 1)


def paths_inside(root: Root, steps: tuple[PathStep, ...]) -> tuple[tuple[PathStep, ...], ...]:
    """The paths below a root that a path may mean: the path itself, and if it begins with the name of the root, the
    rest.
    """
    return (steps, steps[1:]) if len(steps) > 1 and str(steps[0]) == root.name.text else (steps,)
