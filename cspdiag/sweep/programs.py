"""Which programs a sweep needs, as one serves all values that make no difference but in numbers; and what makes two
programs the same: what they say, and the bodies that they use, but not their layout.
"""

from __future__ import annotations

import os
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Protocol, TypeAlias

from cspdiag.base.files.content import digest_of_file
from cspdiag.base.record import record
from cspdiag.codegen.c.interface.directives import included_in
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import Environment
from cspdiag.network.ir.walk import parts
from cspdiag.network.lower.external_bodies import files_of_bodies
from cspdiag.network.lower.promoted import with_parameters
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.sweep.axes import Grid

Identity: TypeAlias = tuple[tuple[str, object], ...]
"""Names of files with what is in them, in order."""


@record
class Programs:
    """The programs that a sweep needs, each with its settings, and which of them a run needs.

    ``axes`` are the positions of the axes on which that depends, with ``sizes`` values each; ``numbers`` has the number
    of the program for each combination of their values, where those of the last axis change fastest. ``structural``
    are those axes of the environment with values that need a program of their own.
    """

    axes: tuple[int, ...]
    sizes: tuple[int, ...]
    numbers: Sequence[int]
    settings: tuple[Mapping[str, str], ...]
    structural: tuple[int, ...]

    def number(self, positions: Sequence[int]) -> int:
        """The program of a run, given which value of each axis of the grid it has."""
        at = 0
        for axis, size in zip(self.axes, self.sizes, strict=True):
            at = at * size + positions[axis]
        return self.numbers[at]


class EnvironmentMaker(Protocol):
    """Makes the environment of a program with several settings."""

    def environments(
        self, compiled: Mapping[str, str], varied: Iterable[Mapping[str, str]]
    ) -> Iterator[Environment | None]:
        """The environment for each of the ``varied`` settings, together with the ``compiled`` ones; None if they give
        it errors.
        """


def programs_of(
    maker: EnvironmentMaker,
    grid: Grid,
    compiled: tuple[int, ...],
    varied: tuple[int, ...],
    on_planned: Callable[[int, int], object] | None = None,
) -> Programs:
    """The programs for the values of the axes ``compiled``, which are compiled in, and ``varied``, parameters of the
    environment that become parameters of the program.

    Sizes, the order of integration, and what faults may depend on the latter. So the environment is made for every
    combination of values: those with equal ones share a program. ``on_planned`` gets the number of
    combinations that are known after each, and that of all.
    """
    axes = (*compiled, *varied)
    sizes = tuple(len(grid.axes[at].values) for at in axes)
    total = prod(sizes)
    paths = [grid.axes[at].target.path for at in varied]
    numbers, settings = array("L"), list[Mapping[str, str]]()
    for fixed in _combinations(grid, compiled):
        known: dict[object, int] = {}
        inner = _combinations(grid, varied) if varied else iter([{}])
        made = maker.environments(fixed, _combinations(grid, varied)) if varied else iter([None])
        for own, environment in zip(inner, made, strict=True):
            key = object() if environment is None else _structure(environment, paths)
            if key not in known:
                known[key] = len(settings)
                settings.append({**fixed, **own})
            numbers.append(known[key])
            if on_planned is not None:
                on_planned(len(numbers), total)
    more = len(settings) > prod(sizes[: len(compiled)])
    structural = _structural(axes, sizes, numbers, len(compiled)) if more else ()
    return Programs(axes, sizes, numbers, tuple(settings), structural)


def _combinations(grid: Grid, axes: Sequence[int]) -> Iterator[dict[str, str]]:
    names = [grid.axes[at].name for at in axes]
    for values in product(*(grid.axes[at].values for at in axes)):
        yield {name: value.text for name, value in zip(names, values, strict=True)}


def _structure(environment: Environment, paths: Sequence[str]) -> object:
    """What is equal for two environments that differ in nothing but the values of these parameters."""
    same, added = with_parameters(environment, paths)
    # Zeros of both signs are equal, but have different quotients.
    zeros = tuple(
        repr(part.value)
        for part in parts(same)
        if isinstance(part, LiteralValue) and (part.value == 0 or isinstance(part.value, tuple))
    )
    return same, tuple((item.name, item.type) for item in added), zeros


def _structural(axes: Sequence[int], sizes: Sequence[int], numbers: Sequence[int], compiled: int) -> tuple[int, ...]:
    """The axes after the first ``compiled`` ones with two values of which the program differs, the others equal."""
    found, stride = [], len(numbers)
    for position, (at, size) in enumerate(zip(axes, sizes, strict=True)):
        stride //= size
        if position >= compiled and any(
            numbers[start] != numbers[start + stride]
            for start in range(len(numbers) - stride)
            if start // stride % size < size - 1
        ):
            found.append(at)
    return tuple(found)


def identity_of(trees: Iterable[ast.SourceTree]) -> Identity:
    """The identity of a program: what its texts say, and what the files of its bodies contain."""
    known = {tree.source.name: tree for tree in trees}
    bodies = {path for tree in known.values() for path in files_of_bodies(tree)}
    return (
        *((name, ast.meaning_of(tree)) for name, tree in sorted(known.items())),
        *((path, digest_of_file(path)) for path in sorted(_with_included(bodies))),
    )


def _with_included(paths: Iterable[str]) -> set[str]:
    """The paths, and those of files beside each that a file in C includes, directly or not."""
    found, pending = set[str](), list(paths)
    while pending:
        path = pending.pop()
        if path in found:
            continue
        found.add(path)
        if path.endswith((".c", ".h")) and os.path.isfile(path):
            beside = (os.path.join(os.path.dirname(path), name) for name in included_in(_text_of(path)))
            pending += [os.path.normpath(place) for place in beside if os.path.isfile(place)]
    return found


def _text_of(path: str) -> str:
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""
