"""Values given from outside the text: ``Tsh=10ms`` for a constant, ``pan.inertia=2e-3`` for an instance's parameter."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record, replaced
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Label
    from cspdiag.model.program import Program, Value
    from cspdiag.model.types import Type
    from cspdiag.network.lower.setting_paths import PathStep, Root


class SettingError(CspdiagError, ValueError):
    """A setting names nothing that can be set, or its value does not fit; the message is one line."""


class WrittenNumber(str):
    """A number, not a text, that was given as a value: in the unit of what it sets, a time in seconds."""

    __slots__ = ()


@record
class Overrides:
    """Settings as values: of constants by name or by the path of a field, of parameters by the path of their instance.
    ``places`` are where the things that were set are declared: an error in a program with settings shows them.
    """

    constants: Mapping[str, Value]
    parameters: Mapping[str, Value]
    places: tuple[Label, ...] = ()


NO_OVERRIDES = Overrides(constants={}, parameters={})

CONSTANT = "const"
"""Prefixed to the name of a constant, as in ``const.T``, it excludes parameters; no instance can have this name."""


def split_settings(texts: Iterable[str]) -> dict[str, str]:
    """Values by name from texts ``NAME=VALUE``; raises SettingError for a text of another form, and for a name with two
    values.
    """
    settings: dict[str, str] = {}
    for text in texts:
        name, value = split_setting(text)
        if settings.setdefault(name, value) != value:
            raise SettingError(f"{name} is set twice: to {settings[name]} and to {value}")
    return settings


def split_setting(text: str) -> tuple[str, str]:
    """``NAME=VALUE`` as its two parts. Raises SettingError if they are missing."""
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise SettingError(f"a setting is NAME=VALUE, not {text!r}")
    return name.strip(), value.strip()


def parse_duration(text: str) -> int:
    """A duration such as ``20s`` or ``1.5 ms`` in nanoseconds. Raises SettingError."""
    from cspdiag.model.constants.evaluate import parse_value
    from cspdiag.model.types import TIME

    try:
        duration = parse_value(TIME, text)
    except ValueError as problem:
        raise SettingError(str(problem)) from None
    assert isinstance(duration, int)
    return duration


def parse_time_limit(text: str) -> int:
    """How long a run lasts at most, in nanoseconds. Raises SettingError, also for a negative time."""
    limit = parse_duration(text)
    if limit < 0:
        raise SettingError(f"a run cannot last {text}: write a positive duration, such as 20s or 500ms")
    return limit


_Place: TypeAlias = "tuple[str | int, ...]"
"""An owner, the name of its item, and the positions of a part within that; the place of a whole is a prefix of the
place of its part.
"""


@record
class Target:
    """What a name can mean: a constant, a part of one, or a parameter by its path below some roots."""

    path: str
    item: ast.Constant | ast.Parameter
    type: Type
    positions: tuple[int, ...] = ()
    """Where a part of a constant is within it."""
    roots: tuple[Root, ...] = ()
    is_qualified: bool = False

    @property
    def places(self) -> tuple[_Place, ...]:
        """What is set, independent of how it is written."""
        return tuple(
            (owner, self.path if self.roots else self.item.name.text, *self.positions) for owner in self.owners
        )

    @property
    def owners(self) -> tuple[str, ...]:
        """Prefixes of the path with which the name means this and nothing else."""
        return tuple(root.name.text for root in self.roots) or (CONSTANT,)

    @property
    def described(self) -> str:
        """How to write it, and where it is declared."""
        span = self.item.name.span
        kind = "parameter" if self.roots else "constant"
        return f"{self.owners[0]}.{self.path} (the {kind} in {span.file}:{span.line})"


def parse_settings(program: Program, settings: Mapping[str, str], roots: Sequence[Root]) -> Overrides:
    """The settings, with values parsed by the types of what they set. A name is that of a constant, with a path to a
    field or an element where the constant is a struct or an array; or a parameter of one of the ``roots``, or of an
    instance below one, by its path. The roots are what is compiled: outermost processes and environments. ``const.T``
    is the constant, ``Main.T`` the parameter of the root `Main`, where ``T`` alone could be either. Raises
    SettingError.
    """
    from cspdiag.base.diagnostic import Label
    from cspdiag.network.lower.setting_paths import in_root

    constants: dict[str, Value] = {}
    parameters: dict[str, Value] = {}
    places: list[Label] = []
    known = _Known()
    for name, text in settings.items():
        target = target_of(program, name, roots)
        known.add(name, target)
        value = value_of(name, text, target.type, is_constant=not target.roots)
        if not target.roots:
            constants[target.path] = value
        elif target.is_qualified:
            parameters[in_root(target.roots[0], target.path)] = value
        else:
            parameters[target.path] = value
        places.append(Label(target.item.name.span, f"set from outside: {name}={text}"))
    return Overrides(constants=constants, parameters=parameters, places=tuple(places))


def constant_setting(program: Program, name: str, text: str) -> tuple[ast.Constant, tuple[int, ...], Value]:
    """A constant or parameter of the program, the positions of the part of it that a name means, and the value for that
    part. Raises SettingError.
    """
    constant, path = _constant(program, name)
    if constant is None:
        known = [one.name.text for one in program.tunable if one.tunable]
        listed = f"the parameters are {', '.join(known)}" if known else "there are none"
        raise SettingError(f"there is no parameter {name!r} of the program ({listed})")
    target = _constant_target(program, constant, path.removeprefix(f"{CONSTANT}."), name)
    return constant, target.positions, value_of(name, text, target.type, is_constant=True)


class _Known:
    """What has been set so far, by the names as written."""

    def __init__(self) -> None:
        self._set: dict[_Place, str] = {}
        self._around: dict[_Place, str] = {}
        """Everything that has a part that is set, by the name of one such part."""

    def add(self, name: str, target: Target) -> None:
        """Add a target. Raises SettingError if it, a part of it, or something that it is a part of is already set."""
        for place in target.places:
            if place in self._set:
                raise SettingError(f"{target.path} is set twice: as {self._set[place]} and as {name}")
            around = [place[:length] for length in range(2, len(place))]
            whole = next((self._set[beginning] for beginning in around if beginning in self._set), None)
            if whole is not None:
                raise _both_set(name, whole)
            if place in self._around:
                raise _both_set(self._around[place], name)
            self._set[place] = name
            self._around.update(dict.fromkeys(around, name))


def _both_set(part: str, whole: str) -> SettingError:
    return SettingError(f"{part} is set twice: by itself and as a part of {whole}")


def target_of(program: Program, name: str, roots: Sequence[Root]) -> Target:
    """The one thing that a name means. Raises SettingError if it means nothing or several things."""
    from cspdiag.network.lower.meant_settings import meant_constant, no_parameter_either, unknown_name
    from cspdiag.network.lower.setting_paths import steps_of

    constant, path = _constant(program, name)
    if path.startswith(f"{CONSTANT}."):
        if constant is None:
            raise SettingError(f"there is no constant {name!r} ({meant_constant(program, path[len(CONSTANT) + 1 :])})")
        return _constant_target(program, constant, path.removeprefix(f"{CONSTANT}."), name)
    steps = steps_of(name)
    found = [] if steps is None else _parameters(program, steps, roots)
    if constant is not None and (not found or _leads_somewhere(program, constant, path)):
        try:
            found.insert(0, _constant_target(program, constant, path, name))
        except SettingError as problem:
            raise SettingError(f"{problem}{no_parameter_either(program, steps or (), roots)}") from None
    if not found:
        raise SettingError(unknown_name(program, name, roots))
    if len(found) == 1:
        return found[0]
    if _is_one(found):
        return replaced(found[0], roots=tuple(root for target in found for root in target.roots))
    ways = ", ".join(target.described for target in found)
    raise SettingError(f"{name!r} means more than one thing; write the one that is meant: {ways}")


def _is_one(found: Sequence[Target]) -> bool:
    """Whether a name sets the same thing in several roots: a parameter of one type, in processes or in environments."""
    return (
        len({(target.type, target.is_qualified) for target in found}) == 1
        and len({tuple(map(type, target.roots)) for target in found}) == 1
    )


def _constant(program: Program, name: str) -> tuple[ast.Constant | None, str]:
    """The constant that a name begins with, if the name can mean it or a part of it; and the name without spaces."""
    path = "".join(name.split())
    head = re.split(r"[.\[]", path.removeprefix(f"{CONSTANT}."), maxsplit=1)[0]
    constant = program.definitions.get(head)
    if isinstance(constant, ast.Constant) and (path.endswith(head) or _has_parts(program.types[constant])):
        return constant, path
    return None, path


def _constant_target(program: Program, constant: ast.Constant, path: str, name: str) -> Target:
    type_, positions = _part(program, constant, path, name)
    return Target(path=path, item=constant, type=type_, positions=positions)


def _has_parts(type_: Type) -> bool:
    from cspdiag.model.types import ArrayType, StructType

    return isinstance(type_, ArrayType | StructType)


def value_of(name: str, text: str, type_: Type, *, is_constant: bool) -> Value:
    """The value that a text has for what a name sets, of this type. Raises SettingError."""
    from cspdiag.model.constants.values import parse_value
    from cspdiag.model.types import IntType, StructType, TimeType

    if isinstance(text, WrittenNumber) and isinstance(type_, TimeType):
        text = f"{text} s"
    if isinstance(text, WrittenNumber) and isinstance(type_, IntType):
        text = _without_fraction(text)
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


def _without_fraction(number: WrittenNumber) -> str:
    """A whole number as the language writes integers: many functions of Python and numpy return 2.0."""
    is_whole = not number.lstrip("-").isdecimal() and float(number).is_integer()
    return str(int(float(number))) if is_whole else number


def _leads_somewhere(program: Program, constant: ast.Constant, path: str) -> bool:
    from cspdiag.model.constants.values import NoPartError, part_of

    try:
        part_of(program.types[constant], path[len(constant.name.text) :])
    except NoPartError:
        return False
    return True


def _part(program: Program, constant: ast.Constant, path: str, name: str) -> tuple[Type, tuple[int, ...]]:
    """The type of a constant or of the part of it that is named, and the positions of that part."""
    from cspdiag.model.constants.values import NoPartError, part_of
    from cspdiag.network.lower.meant_settings import suggested

    head = constant.name.text
    part = path[len(head) :]
    try:
        return part_of(program.types[constant], part)
    except NoPartError as problem:
        near = suggested(part[len(problem.before) :].lstrip("."), problem.fields)
        meant = f"did you mean {head + problem.before + '.' + near!r}?" if near else problem
        what = "parameter" if constant.tunable else "constant"
        raise SettingError(f"there is no {what} {name!r} ({meant})") from None


def _parameters(program: Program, steps: tuple[PathStep, ...], roots: Sequence[Root]) -> list[Target]:
    """The parameters that a path can mean: inside each of the roots, or after the name of one."""
    from cspdiag.network.lower.setting_paths import parameter_at, paths_inside

    found = []
    for root in roots:
        for inner in paths_inside(root, steps):
            end = parameter_at(program, root, inner)
            if isinstance(end, ast.Parameter):
                path = ".".join(map(str, inner))
                kind = program.types[end]
                found.append(Target(path, end, kind, roots=(root,), is_qualified=inner is not steps))
    return found
