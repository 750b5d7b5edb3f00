"""Which constants of a program are sizes of many elements."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.model.program import Program
from cspdiag.model.types import IntType
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes

MANY = 200
"""Sizes up to this one are left as they are."""

FEW = 24
"""Many elements become at least that many, with the same remainder: a multiple of 2, 3, 4, 6, 8 and 12 stays one."""

MOST_TEXT = 200_000
"""Characters. A longer program is not one that is short because of its arrays."""


def fewer_elements(program: Program, least: int = 0) -> dict[str, int]:
    """The constants that are sizes of many elements, each with the size to be examined in its place; none if all of
    them are below ``least``.
    """
    large: dict[ast.Constant, int] = {}
    for constant, value in program.constants.items():
        is_whole = isinstance(constant.value, ast.Number) and isinstance(program.types.get(constant), IntType)
        if is_whole and isinstance(value, int) and value > MANY:
            large[constant] = value
    if (
        max(large.values(), default=0) <= max(MANY, least - 1)
        or sum(len(tree.source.text) for tree in program.trees) > MOST_TEXT
    ):
        return {}
    pending = [*_counts(program)]
    counting: set[ast.Node] = set()
    for expression in pending:
        found = {program.bindings.get(name) for name in names((expression,))}
        constants = {symbol for symbol in found if isinstance(symbol, ast.Constant)} - counting
        counting |= constants
        pending += (constant.value for constant in constants)
    return {constant.name.text: FEW + value % FEW for constant, value in large.items() if constant in counting}


def three_sizes(program: Program) -> tuple[str, tuple[int, int, int]] | None:
    """The constant that is the only size of many elements, with a small size, one that is larger by as many elements as
    leave the same remainder, and its own; None if there is no such constant.
    """
    found = fewer_elements(program)
    if len(found) != 1:
        return None
    ((name, few),) = found.items()
    (many,) = (value for constant, value in program.constants.items() if constant.name.text == name)
    assert isinstance(many, int)
    return name, (few, few + FEW, many)


def _counts(program: Program) -> Iterator[ast.Expression]:
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition):
            for part in nodes(definition):
                yield from counts_in(part)


def counts_in(part: ast.Node) -> tuple[ast.Expression, ...]:
    """The numbers of elements or repetitions that a node itself gives."""
    match part:
        case ast.Replicator(count=count):
            return (count,)
        case ast.Instance(size=size) if size is not None and not isinstance(size, ast.Replicator):
            return (size,)
        case ast.PortName(dimensions=dimensions):
            return dimensions
        case _:  # No other node has a count that may vary.
            return ()
