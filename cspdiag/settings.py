"""Values given from outside the text: ``Tsh=10ms`` for a constant, ``pan.inertia=2e-3`` for an instance's parameter."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, islice
from typing import TYPE_CHECKING

from cspdiag.diagnostics.record import record
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.program import Program, Value
    from cspdiag.model.types import Type
    from cspdiag.network.setting_paths import Root, Step


class SettingError(ValueError):
    """A setting names nothing that can be set, or its value does not fit; the message is one line."""


@record
class Overrides:
    """Settings as values: of constants by name or by the path of a field, of parameters by the path of their instance."""

    constants: Mapping[str, Value]
    parameters: Mapping[str, Value]


NO_OVERRIDES = Overrides(constants={}, parameters={})


def split_settings(texts: Iterable[str]) -> dict[str, str]:
    """Values by name from texts ``NAME=VALUE``; SettingError for another text, and for a name with two values."""
    settings: dict[str, str] = {}
    for text in texts:
        name, value = split_setting(text)
        if settings.setdefault(name, value) != value:
            raise SettingError(f"{name} is set twice: to {settings[name]} and to {value}")
    return settings


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


def parse_settings(program: Program, settings: Mapping[str, str], roots: Sequence[Root]) -> Overrides:
    """The settings with their values read by the types of what they set.

    A name is that of a constant, with a path to a field or an element where the constant is a struct or an array; or a parameter of one
    of the ``roots``, or of an instance below one, by its path. The roots are what is compiled: outermost processes and environments.
    Raises SettingError.
    """
    constants: dict[str, Value] = {}
    parameters: dict[str, Value] = {}
    for name, text in settings.items():
        head = re.split(r"[.\[]", name, maxsplit=1)[0].strip()
        constant = program.definitions.get(head)
        if isinstance(constant, ast.Constant) and (head == name or _has_parts(program.types[constant])):
            path, known, found = "".join(name.split()), constants, _type_of(program, constant, name)
        else:
            path, parameter = _parameter(program, name, roots)
            known, found = parameters, program.types[parameter]
        if path in known:
            raise SettingError(f"{path} is set twice")
        known[path] = _value(name, text, found, is_constant=known is constants)
    return Overrides(constants=constants, parameters=parameters)


def _has_parts(type_: Type) -> bool:
    from cspdiag.model.types import ArrayType, StructType

    return isinstance(type_, ArrayType | StructType)


def _value(name: str, text: str, type_: Type, *, is_constant: bool) -> Value:
    from cspdiag.model.types import StructType
    from cspdiag.model.values import parse_value

    if isinstance(type_, StructType):
        fields = ", ".join(f"{name}.{field}" for field, _ in type_.fields)
        advice = (
            f"set its fields: {fields}" if is_constant else "make its argument a constant, and set the fields of that"
        )
        raise SettingError(f"{name}: {type_} is a struct; {advice}")
    try:
        return parse_value(type_, text)
    except ValueError as problem:
        raise SettingError(f"{name}: {problem}") from None


def _type_of(program: Program, constant: ast.Constant, name: str) -> Type:
    """The type of a constant or of the part of it that is named."""
    from cspdiag.model.values import NoPartError, part_of

    head = constant.name.text
    path = "".join(name.split())[len(head) :]
    try:
        return part_of(program.types[constant], path)[0]
    except NoPartError as problem:
        near = _suggested(path[len(problem.before) :].lstrip("."), problem.fields)
        meant = f"did you mean {head + problem.before + '.' + near!r}?" if near else problem
        raise SettingError(f"there is no constant {name!r} ({meant})") from None


def _parameter(program: Program, name: str, roots: Sequence[Root]) -> tuple[str, ast.Parameter]:
    """The path to a parameter as it is compared, and the parameter."""
    from cspdiag.network.setting_paths import parameter_at, steps_of

    steps = steps_of(name)
    if steps is None:
        raise SettingError(f"there is no parameter {name!r} (a path is INSTANCE.PARAMETER, such as cell[0].gain)")
    found: dict[Root, ast.Parameter] = {}
    deepest, reason = -1, ""
    for root in roots:
        end = parameter_at(program, root, steps)
        if isinstance(end, ast.Parameter):
            found[root] = end
        elif end.depth > deepest:
            deepest, reason = end.depth, end.reason
    if not found:
        what = "parameter" if len(steps) > 1 else "constant"
        help_ = reason or _elsewhere(program, steps) or _meant(program, steps, roots)
        raise SettingError(f"there is no {what} {name!r}{f' ({help_})' if help_ else ''}")
    _refuse_ambiguous(program, name, found)
    return ".".join(map(str, steps)), next(iter(found.values()))


def _elsewhere(program: Program, steps: tuple[Step, ...]) -> str:
    """That the path leads somewhere in an environment which was not chosen."""
    from cspdiag.network.setting_paths import parameter_at

    others = (item for item in program.definitions.values() if isinstance(item, ast.EnvironmentDefinition))
    for item in others:
        if len(steps) > 1 and isinstance(parameter_at(program, item, steps), ast.Parameter):
            return f"`{item.name.text}` has it, an environment that was not chosen"
    return ""


def _refuse_ambiguous(program: Program, name: str, found: Mapping[Root, ast.Parameter]) -> None:
    """One name for parameters of a process and of its environment, or of several types, would set what was not meant."""
    processes = [root for root in found if isinstance(root, ast.ProcessDefinition)]
    types = {program.types[parameter] for parameter in found.values()}
    if len(types) > 1 or 0 < len(processes) < len(found):
        places = " and ".join(f"`{root.name.text}`" for root in found)
        raise SettingError(f"{name!r} is a parameter in {places}; with different names each can be set")


_MOST_NAMED = 8

_MOST_PATHS = 1000
"""A program may have more instances than anybody wants to wait for; a name that was meant is looked for among so many."""


def _meant(program: Program, steps: tuple[Step, ...], roots: Sequence[Root]) -> str:
    """What to say of a path that leads nowhere: one that was probably meant, or what paths there are."""
    from cspdiag.network.setting_paths import paths_of

    known = list(islice(chain.from_iterable(paths_of(program, root) for root in roots), _MOST_PATHS))
    names = [step.name for step in steps]
    constants = [name for name, item in program.definitions.items() if isinstance(item, ast.Constant)]
    if len(steps) == 1:
        near = _suggested(names[0], constants)
        if near is not None:
            return f"did you mean {near!r}?"
    near_path = _near_path(steps, known)
    if near_path is not None:
        return f"did you mean {near_path!r}?"
    if len(steps) == 1:
        more = ", ..." if len(constants) > _MOST_NAMED else ""
        return (
            f"the constants are {', '.join(constants[:_MOST_NAMED])}{more}" if constants else "there are no constants"
        )
    inside = [path for path in known if [step.name for step in path[:-1]] == names[:-1]]
    if inside:
        owner = ".".join(map(str, steps[:-1]))
        return f"{owner} has the parameters {', '.join(path[-1].name for path in inside)}"
    where = " and ".join(f"`{root.name.text}`" for root in roots)
    return f"INSTANCE.PARAMETER, by the path inside {where}"


def _near_path(steps: tuple[Step, ...], known: Sequence[tuple[Step, ...]]) -> str | None:
    """The known path that ends as this one does, or that this one ends as, or that is spelled nearly so."""
    names = [step.name for step in steps]
    for path in known:
        own = [step.name for step in path]
        if own[-len(names) :] == names or (len(own) > 1 and names[-len(own) :] == own):
            return _indexed(path, steps)
    spelled: dict[str, tuple[Step, ...]] = {}
    for path in known:
        own = [step.name for step in path]
        spelled.setdefault(".".join(own), path)
        spelled.setdefault(".".join(own[-len(names) :]), path)
    near = _suggested(".".join(names), spelled)
    return None if near is None else _indexed(spelled[near], steps)


def _indexed(path: tuple[Step, ...], steps: tuple[Step, ...]) -> str:
    """A path, with the indexes of another that ends as it does where these are numbers."""
    from cspdiag.network.setting_paths import Step

    def indexed() -> Iterator[Step]:
        written = dict(zip(reversed(range(len(path))), reversed(steps), strict=False))
        for number, step in enumerate(path):
            own = written.get(number)
            fits = own is not None and len(own.indexes) == len(step.indexes) and all(map(str.isdecimal, own.indexes))
            yield Step(step.name, own.indexes) if own is not None and fits else step

    return ".".join(map(str, indexed()))


def _suggested(name: str, known: Iterable[str]) -> str | None:
    from cspdiag.diagnostics.spelling import Speller

    return Speller().nearest(name, known)
