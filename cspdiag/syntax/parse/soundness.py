"""What of a file can be relied on after syntax errors, so that one run also shows what else is wrong."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base import Diagnostic
from cspdiag.base.record import replaced
from cspdiag.syntax import ast


def sound_part(tree: ast.SourceTree, errors: Iterable[Diagnostic]) -> ast.SourceTree:
    """The tree without the definitions in which an error was found.

    Where it was found at the very start of a definition, such as after a missing brace, the one before goes as well.
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
