"""Suggestions for names of settings that do not exist."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, islice

from cspdiag.base.spelling import Speller
from cspdiag.model.program import Program
from cspdiag.network.lower.setting_paths import Dead, PathStep, Root, parameter_at, paths_inside, paths_of, steps_of
from cspdiag.syntax import ast

_MOST_NAMED = 8

_MOST_PATHS = 1000
"""The number of paths among which a similar name is sought; a program may have too many to search them all."""


def no_parameter_either(program: Program, steps: tuple[PathStep, ...], roots: Sequence[Root]) -> str:
    """The addition to a message about an unknown constant whose name also is the beginning of a path: why that path
    does not name a parameter; empty if it begins no path.
    """
    ways = []
    for root in roots if steps else ():
        end = parameter_at(program, root, steps)
        if not isinstance(end, Dead) or not (end.depth or end.reason):
            continue
        owner = [step.name for step in steps[: end.depth]]
        inside = [path[-1].name for path in paths_of(program, root) if [step.name for step in path[:-1]] == owner]
        has = f"`{'.'.join(owner)}` has {'the parameters ' + ', '.join(inside) if inside else 'no parameters'}"
        ways.append(f"in `{root.name.text}` {end.reason or has}")
    return f" and no such parameter ({'; '.join(ways)})" if ways else ""


def unknown_name(program: Program, name: str, roots: Sequence[Root]) -> str:
    """The message about a name that neither a constant nor a parameter has."""
    steps = steps_of(name)
    if steps is None:
        return f"there is no parameter {name!r} (a path is INSTANCE.PARAMETER, such as cell[0].gain)"
    ends = (parameter_at(program, root, inner) for root in roots for inner in paths_inside(root, steps))
    dead = [end for end in ends if isinstance(end, Dead)]
    reason = max(dead, key=lambda end: (end.depth, bool(end.reason))).reason if dead else ""
    what = "parameter" if len(steps) > 1 else "constant"
    help_ = reason or _elsewhere(program, steps) or _meant(program, steps, roots)
    return f"there is no {what} {name!r}{f' ({help_})' if help_ else ''}"


def _elsewhere(program: Program, steps: tuple[PathStep, ...]) -> str:
    """A note that the path exists in an environment that was not chosen; empty if it does not."""
    others = (item for item in program.definitions.values() if isinstance(item, ast.EnvironmentDefinition))
    for item in others:
        if len(steps) > 1 and isinstance(parameter_at(program, item, steps), ast.Parameter):
            return f"`{item.name.text}` has it, an environment that was not chosen"
    return ""


def _meant(program: Program, steps: tuple[PathStep, ...], roots: Sequence[Root]) -> str:
    """The help for a path that does not exist: a path that was probably meant, or which paths exist."""
    known = list(islice(chain.from_iterable(paths_of(program, root) for root in roots), _MOST_PATHS))
    names = [step.name for step in steps]
    if len(steps) == 1 and _near_constant(program, names[0]) is not None:
        return meant_constant(program, names[0])
    near_path = _near_path(steps, known)
    if near_path is not None:
        return f"did you mean {near_path!r}?"
    if len(steps) == 1:
        return meant_constant(program, names[0])
    inside = [path for path in known if [step.name for step in path[:-1]] == names[:-1]]
    if inside:
        owner = ".".join(map(str, steps[:-1]))
        return f"{owner} has the parameters {', '.join(path[-1].name for path in inside)}"
    where = " and ".join(f"`{root.name.text}`" for root in roots)
    return f"INSTANCE.PARAMETER, by the path inside {where}"


def _near_constant(program: Program, name: str) -> str | None:
    return suggested(name, _constants(program))


def meant_constant(program: Program, name: str) -> str:
    """The help for a name that no constant has: the constant that was probably meant, or which constants exist."""
    near, constants = _near_constant(program, name), _constants(program)
    if near is not None:
        return f"did you mean {near!r}?"
    more = ", ..." if len(constants) > _MOST_NAMED else ""
    return f"the constants are {', '.join(constants[:_MOST_NAMED])}{more}" if constants else "there are no constants"


def _constants(program: Program) -> list[str]:
    return [name for name, item in program.definitions.items() if isinstance(item, ast.Constant)]


def _near_path(steps: tuple[PathStep, ...], known: Sequence[tuple[PathStep, ...]]) -> str | None:
    """The known path that ends like this one, or that this one ends with, or that is spelled similarly; None if there
    is none.
    """
    names = [step.name for step in steps]
    for path in known:
        own = [step.name for step in path]
        if own[-len(names) :] == names or (len(own) > 1 and names[-len(own) :] == own):
            return _indexed(path, steps)
    spelled: dict[str, tuple[PathStep, ...]] = {}
    for path in known:
        own = [step.name for step in path]
        spelled.setdefault(".".join(own), path)
        spelled.setdefault(".".join(own[-len(names) :]), path)
    near = suggested(".".join(names), spelled)
    return None if near is None else _indexed(spelled[near], steps)


def _indexed(path: tuple[PathStep, ...], steps: tuple[PathStep, ...]) -> str:
    """A path with the indexes of another one that ends with the same names, as far as these indexes are numbers."""

    def indexed() -> Iterator[PathStep]:
        written = dict(zip(reversed(range(len(path))), reversed(steps), strict=False))
        for number, step in enumerate(path):
            own = written.get(number)
            fits = own is not None and len(own.indexes) == len(step.indexes) and all(map(str.isdecimal, own.indexes))
            yield PathStep(step.name, own.indexes) if own is not None and fits else step

    return ".".join(map(str, indexed()))


def suggested(name: str, known: Iterable[str]) -> str | None:
    """The known name with the most similar spelling; None if none is similar."""
    return Speller().nearest(name, known)
