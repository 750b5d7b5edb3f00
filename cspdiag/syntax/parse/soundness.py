"""The part of a file without syntax errors, in which further mistakes can be reported."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base import Diagnostic
from cspdiag.base.record import replaced
from cspdiag.syntax import ast


def part_without_errors(tree: ast.SourceTree, errors: Iterable[Diagnostic]) -> ast.SourceTree:
    """The tree without the definitions that have errors.

    If an error is at the very beginning of a definition, such as after a missing brace, the previous one is removed
    as well.
    """
    places = [error.span.start for error in errors if error.span.source is tree.source]
    if not places:
        return tree
    broken: set[int] = set()
    for place in places:
        before = [position for position, item in enumerate(tree.items) if item.span.start <= place]
        broken.update(before[-1:])
        if before and tree.items[before[-1]].span.start == place:
            broken.update(before[-2:])
    items = tuple(item for position, item in enumerate(tree.items) if position not in broken)
    return replaced(tree, items=items)
